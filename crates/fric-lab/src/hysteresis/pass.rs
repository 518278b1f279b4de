//! Passes across a position along one axis, with the wrench at the position itself.
//!
//! A pass starts at half the movement's reach on one side and ends at half the reach on the other, without reversal. Its value is that of a straight
//! line at the position, fitted by least squares to the samples in a window around it; an uneven distribution of samples does not bias it. With fewer
//! than four samples in the window, the value is interpolated between the two samples around the position.

/// A pass starts and ends at least this fraction of the reach away, so that inertia and presliding are over.
const MARGIN_SHARE: f64 = 0.5;
/// Half width of the window, as a fraction of the reach.
const WINDOW_SHARE: f64 = 0.1;

/// The averaged quantities: wrench components along the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Components {
    /// From frictionless forces.
    pub without: f64,
    /// From compensated forces.
    pub with: f64,
    /// Applied wrench; NaN if the log does not contain it.
    pub applied: f64,
}

/// One pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Whether it is in the direction of the axis.
    pub is_forward: bool,
    /// The components at the position.
    pub components: Components,
}

/// Finds the passes along one axis in a sequence of samples.
#[derive(Debug)]
pub struct PassFinder {
    reach_m: f64,
    tolerance_m: f64,
    /// The pass in progress.
    current: Option<Current>,
    last: Option<(f64, Components)>,
}

#[derive(Debug)]
struct Current {
    /// 1 in the direction of the axis, −1 against it.
    sign: f64,
    furthest_m: f64,
    line: Line,
    between: Option<Components>,
}

impl PassFinder {
    /// Creates a finder for movements with this reach to either side. Motion within the tolerance is no reversal.
    pub fn new(reach_m: f64, tolerance_m: f64) -> Self {
        Self { reach_m, tolerance_m, current: None, last: None }
    }

    /// Adds a sample at a distance along the axis from the position, and returns the pass that it completes, if any.
    ///
    /// `components` is `None` if the platform is not on the axis or the wrench is unknown.
    pub fn add(&mut self, along_m: f64, components: Option<Components>) -> Option<Pass> {
        let Some(components) = components else {
            self.current = None;
            self.last = None;
            return None;
        };
        let last = self.last.replace((along_m, components));
        let margin_m = MARGIN_SHARE * self.reach_m;
        let mut completed = None;
        if let Some(current) = &mut self.current {
            let onward_m = along_m * current.sign;
            if let Some((last_m, last)) = last.filter(|(last_m, _)| last_m * current.sign < 0.0 && onward_m >= 0.0) {
                current.between = Some(last.towards(&components, last_m / (last_m - along_m)));
            }
            if along_m.abs() <= WINDOW_SHARE * self.reach_m {
                current.line.add(along_m, &components);
            }
            current.furthest_m = current.furthest_m.max(onward_m);
            if onward_m >= margin_m {
                let at = current.between.map(|between| current.line.at_zero().unwrap_or(between));
                completed = at.map(|components| Pass { is_forward: current.sign > 0.0, components });
                self.current = None;
            } else if onward_m < current.furthest_m - self.tolerance_m {
                self.current = None;
            }
        }
        if along_m.abs() >= margin_m {
            let sign = -along_m.signum();
            self.current = Some(Current { sign, furthest_m: -along_m.abs(), line: Line::default(), between: None });
        }
        completed
    }
}

impl Components {
    fn map2(&self, other: &Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            without: combine(self.without, other.without),
            with: combine(self.with, other.with),
            applied: combine(self.applied, other.applied),
        }
    }

    fn towards(&self, other: &Self, ratio: f64) -> Self {
        self.map2(other, |one, other| one + (other - one) * ratio)
    }
}

const NOTHING: Components = Components { without: 0.0, with: 0.0, applied: 0.0 };

/// A straight line through samples, from running sums.
#[derive(Debug)]
struct Line {
    count: f64,
    mean_m: f64,
    squares_m2: f64,
    mean: Components,
    products: Components,
}

impl Default for Line {
    fn default() -> Self {
        Self { count: 0.0, mean_m: 0.0, squares_m2: 0.0, mean: NOTHING, products: NOTHING }
    }
}

impl Line {
    /// With fewer samples the value is interpolated.
    const LEAST_SAMPLES: f64 = 4.0;

    fn add(&mut self, along_m: f64, components: &Components) {
        self.count += 1.0;
        let before_m = along_m - self.mean_m;
        self.mean_m += before_m / self.count;
        self.squares_m2 += before_m * (along_m - self.mean_m);
        let count = self.count;
        self.mean = self.mean.map2(components, |mean, value| mean + (value - mean) / count);
        let deviation = components.map2(&self.mean, |value, mean| before_m * (value - mean));
        self.products = self.products.map2(&deviation, |sum, product| sum + product);
    }

    /// Returns the value of the line at the position; `None` with too few samples, or all at one place.
    fn at_zero(&self) -> Option<Components> {
        if self.count < Self::LEAST_SAMPLES || self.squares_m2 <= 0.0 {
            return None;
        }
        let (mean_m, squares_m2) = (self.mean_m, self.squares_m2);
        Some(self.mean.map2(&self.products, |mean, products| mean - products / squares_m2 * mean_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(along_m: f64) -> Components {
        Components { without: 3.0 + 2.0 * along_m, with: -1.0, applied: f64::NAN }
    }

    fn passes(ways_m: impl IntoIterator<Item = f64>) -> Vec<Pass> {
        let mut finder = PassFinder::new(1.0, 0.01);
        ways_m.into_iter().filter_map(|along_m| finder.add(along_m, Some(at(along_m)))).collect()
    }

    #[test]
    fn a_pass_is_valued_at_the_position() {
        let there = (0..=200).map(|step| f64::from(step) * 0.01 - 1.0);
        let back = (0..=7).map(|step| 1.0 - f64::from(step) * 0.29);
        let found = passes(there.chain(back));
        assert_eq!(found.iter().map(|pass| pass.is_forward).collect::<Vec<_>>(), [true, false]);
        for pass in found {
            assert!((pass.components.without - 3.0).abs() < 1e-12 && (pass.components.with + 1.0).abs() < 1e-12);
            assert!(pass.components.applied.is_nan());
        }
    }

    #[test]
    fn what_turns_back_or_starts_within_is_no_pass() {
        let turned = [-1.0, -0.4, 0.1, 0.2, -0.1, 0.3, 0.8];
        assert!(passes(turned).is_empty());
        assert!(passes([0.0, 0.2, 0.8]).is_empty());
        assert!(passes([-0.4, 0.2, 0.8]).is_empty());
        // Noise is no reversal.
        assert_eq!(passes([-1.0, -0.4, 0.1, 0.095, 0.3, 0.8]).len(), 1);
    }

    #[test]
    fn a_gap_in_the_wrench_breaks_the_pass() {
        let mut finder = PassFinder::new(1.0, 0.01);
        assert_eq!(finder.add(-1.0, Some(at(-1.0))), None);
        assert_eq!(finder.add(-0.2, None), None);
        assert_eq!(finder.add(0.9, Some(at(0.9))), None);
    }
}
