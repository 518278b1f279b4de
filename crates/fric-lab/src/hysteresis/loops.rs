//! The hysteresis loops: the wrench over the position along an axis, back and forth.

use super::pass::Components;
use crate::axis::CartesianAxis;

/// Number of bins over the range to both sides of the position.
const BINS: usize = 40;

/// The wrench component along an axis over the position, in bin means.
#[derive(Clone, Debug, PartialEq)]
pub struct HysteresisLoop {
    /// The axis.
    pub axis: CartesianAxis,
    /// Bin centres relative to the position, m, or rad about an axis.
    pub at: Vec<f64>,
    /// Backward and forward: from frictionless and from compensated forces, N or N m, minus the log's external wrench if it is known; NaN where the
    /// platform was not.
    pub directions: [Vec<[f64; 2]>; 2],
}

/// Sums over the position in the order of samples.
#[derive(Debug)]
pub(super) struct LoopSums {
    reach_m: f64,
    tolerance_m: f64,
    /// Backward and forward: count, without compensation, with compensation.
    bins: [Vec<[f64; 3]>; 2],
    /// Direction (1 forward, −1 backward, 0 before it moves) and the furthest position since.
    heading: Option<(f64, f64)>,
}

impl LoopSums {
    pub fn new(reach_m: f64, tolerance_m: f64) -> Self {
        Self { reach_m, tolerance_m, bins: [vec![[0.0; 3]; BINS], vec![[0.0; 3]; BINS]], heading: None }
    }

    /// Adds a sample; `components` is `None` if the platform is not on the axis or the wrench is unknown.
    pub fn add(&mut self, along_m: f64, components: Option<&Components>) {
        let Some(components) = components else {
            self.heading = None;
            return;
        };
        let (mut sign, furthest_m) = self.heading.unwrap_or((0.0, along_m));
        if sign == 0.0 {
            // A platform at rest has no direction yet.
            let moved_m = along_m - furthest_m;
            if moved_m.abs() <= self.tolerance_m {
                self.heading = Some((0.0, furthest_m));
                return;
            }
            sign = moved_m.signum();
        }
        let onward_m = sign * (along_m - furthest_m);
        let is_back = onward_m < -self.tolerance_m;
        let sign = if is_back { -sign } else { sign };
        self.heading = Some((sign, if is_back || onward_m > 0.0 { along_m } else { furthest_m }));
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let place = (along_m / self.reach_m + 1.0) * 0.5 * BINS as f64;
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        if !(0.0..BINS as f64).contains(&place) {
            return;
        }
        let applied = if components.applied.is_finite() { components.applied } else { 0.0 };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to BINS")]
        if let Some([count, without, with]) = self.bins[usize::from(sign > 0.0)].get_mut(place as usize) {
            *count += 1.0;
            *without += components.without - applied;
            *with += components.with - applied;
        }
    }

    /// Returns the loop. `lever_m` converts an angle to a distance; 1 along an axis.
    pub fn finish(&self, axis: CartesianAxis, lever_m: f64) -> HysteresisLoop {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let middle = |place: usize| ((place as f64 + 0.5) / BINS as f64 * 2.0 - 1.0) * self.reach_m / lever_m;
        let mean = |[count, without, with]: &[f64; 3]| [without / count, with / count];
        HysteresisLoop {
            axis,
            at: (0..BINS).map(middle).collect(),
            directions: self.bins.each_ref().map(|bins| bins.iter().map(mean).collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A friction of 2 against the motion: 1 less forward, 1 more backward, around a slope.
    #[test]
    fn a_loop_is_as_wide_as_what_it_is_of() {
        let mut sums = LoopSums::new(1.0, 0.01);
        let there = (0..=2000).map(|step| -1.0 + f64::from(step) * 1e-3);
        for (along_m, sign) in there.clone().map(|at| (at, 1.0)).chain(there.map(|at| (-at, -1.0))) {
            let without = 3.0 * along_m + 5.0 - sign;
            sums.add(along_m, Some(&Components { without, with: without + sign, applied: 5.0 }));
        }
        let of = sums.finish(CartesianAxis::X, 1.0);
        for place in 2..BINS - 2 {
            let [back, forward] = [of.directions[0][place], of.directions[1][place]];
            assert!((back[0] - forward[0] - 2.0).abs() < 0.02, "{place} {back:?} {forward:?}");
            assert!((back[1] - forward[1]).abs() < 0.02 && (back[1] - 3.0 * of.at[place]).abs() < 0.02);
        }
    }
}
