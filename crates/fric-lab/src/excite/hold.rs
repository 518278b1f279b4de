//! Checks whether the cables hold the platform within force bounds, and computes the forces.

use nalgebra::{Vector3, Vector6};

use super::error::ExcitationError;
use crate::simulate::mechanics::distribution::Distribution;
use crate::simulate::mechanics::platform::Platform;
use crate::trajectory::{Phase, SetPoint};

/// The platform with bounds for the forces of its cables.
#[derive(Clone, Debug)]
pub struct Hold {
    platform: Platform,
    distribution: Distribution,
    least_n: f64,
    greatest_n: Option<f64>,
    columns: Vec<Vector6<f64>>,
    forces_n: Vec<f64>,
}

impl Hold {
    /// Creates the check. Without `greatest_n` there is no upper bound.
    pub fn new(platform: Platform, least_n: f64, greatest_n: Option<f64>) -> Self {
        Self {
            distribution: Distribution::new(platform.arm_m(), least_n),
            least_n,
            greatest_n,
            columns: Vec::with_capacity(platform.cable_count()),
            forces_n: vec![0.0; platform.cable_count()],
            platform,
        }
    }

    /// Returns the least and the greatest allowed force, N.
    pub fn bounds_n(&self) -> (f64, Option<f64>) {
        (self.least_n, self.greatest_n)
    }

    /// Returns the cable forces at a set point, N, as near to `wanted_n` as possible.
    pub fn forces_n(
        &mut self,
        set_point: &SetPoint,
        wanted_n: f64,
        time_s: f64,
        phase: Phase,
        names: &[String],
    ) -> Result<&[f64], ExcitationError> {
        let pose = set_point.pose();
        // The caller has checked the kinematics, so every cable leaves its pulley.
        self.platform.structure(&pose, &mut self.columns);
        let wrench = self.platform.wrench_at(set_point);
        if self.holds(&wrench, wanted_n) {
            return Ok(&self.forces_n);
        }
        let worst =
            self.worst(&wrench, wanted_n).and_then(|(cable, force_n)| Some((names.get(cable)?.clone(), force_n)));
        let at_rest = self.platform.outside_wrench(&set_point.orientation, &Vector3::zeros());
        Err(ExcitationError::NotHeld {
            least_n: self.least_n,
            greatest_n: self.greatest_n,
            position_m: pose.position_m.into(),
            time_s,
            phase,
            worst,
            holds_at_rest: self.holds(&at_rest, wanted_n),
        })
    }

    /// Whether forces within the bounds exist under a wrench; if so, `forces_n` holds them.
    fn holds(&mut self, wrench: &Vector6<f64>, wanted_n: f64) -> bool {
        let bounds_n = [self.least_n, self.greatest_n.unwrap_or(f64::INFINITY)];
        self.forces_n.fill(wanted_n);
        self.distribution.solve_within(&self.columns, wrench, bounds_n, &mut self.forces_n)
    }

    /// Returns the cable that is furthest out of bounds with the forces nearest to the wanted ones, and its force, N; `None` if no forces of either
    /// sign hold the platform.
    fn worst(&mut self, wrench: &Vector6<f64>, wanted_n: f64) -> Option<(usize, f64)> {
        self.forces_n.fill(wanted_n);
        let unbounded = [f64::NEG_INFINITY, f64::INFINITY];
        if !self.distribution.solve_within(&self.columns, wrench, unbounded, &mut self.forces_n) {
            return None;
        }
        let greatest_n = self.greatest_n.unwrap_or(f64::INFINITY);
        let beyond_n = |force_n: f64| (self.least_n - force_n).max(force_n - greatest_n);
        let all = self.forces_n.iter().copied().enumerate();
        all.max_by(|(_, one_n), (_, other_n)| beyond_n(*one_n).total_cmp(&beyond_n(*other_n)))
    }
}
