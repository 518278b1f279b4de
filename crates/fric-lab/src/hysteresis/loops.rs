//! The loops of which a hysteresis is the width: the wrench on the way along an axis, there and back.

use super::pass::Components;
use crate::axis::CartesianAxis;

/// Bins over the way to either side of the position together.
const BINS: usize = 40;

/// The component of the wrench along an axis over the way, in means of bins.
#[derive(Clone, Debug, PartialEq)]
pub struct HysteresisLoop {
    /// The axis.
    pub axis: CartesianAxis,
    /// Middles of the bins from the position, m, or rad about an axis.
    pub at: Vec<f64>,
    /// Back and forwards: from frictionless and from compensated forces, N or N m, less the log's outside wrench where that is known; NaN
    /// where the platform was not.
    pub directions: [Vec<[f64; 2]>; 2],
}

/// Sums over the way, as it comes.
#[derive(Debug)]
pub(super) struct LoopSums {
    reach_m: f64,
    tolerance_m: f64,
    /// Back and forwards: count, without, with.
    bins: [Vec<[f64; 3]>; 2],
    /// 1 forwards, −1 back, 0 before it moves, and the furthest way since.
    heading: Option<(f64, f64)>,
}

impl LoopSums {
    pub fn new(reach_m: f64, tolerance_m: f64) -> Self {
        Self { reach_m, tolerance_m, bins: [vec![[0.0; 3]; BINS], vec![[0.0; 3]; BINS]], heading: None }
    }

    /// Takes in a sample; `None` where the platform is not on the axis, or the wrench not known.
    pub fn add(&mut self, along_m: f64, components: Option<&Components>) {
        let Some(components) = components else {
            self.heading = None;
            return;
        };
        let (mut sign, furthest_m) = self.heading.unwrap_or((0.0, along_m));
        if sign == 0.0 {
            // A platform at rest goes in no direction yet.
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

    /// The loop; `lever_m` is the way of an angle of 1 rad, 1 along an axis.
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

    /// Friction of 2 against the way: 1 less on the way there, 1 more on the way back, about a slope.
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
