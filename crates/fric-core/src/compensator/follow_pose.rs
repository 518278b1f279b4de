//! The part of a cycle that follows the pose of the platform: wrap of the last pulley, direction and moment arm of the cables.

use super::Compensator;
use crate::friction::places::NO_SLIP;
use crate::numbers::lanes::Block;
use crate::platform::{self, Pose};
use crate::pulley::traction_ratio;
use crate::scalar::Mask;
use crate::swivel;
use nalgebra::Matrix3;

impl<const CABLES: usize> Compensator<CABLES> {
    /// Computes wrap, direction and moment arm of a block's cables at a pose; a cable whose attachment is out of reach keeps the last ones. Returns the
    /// lanes of such cables.
    #[inline(never)]
    pub(super) fn follow_pose<T: Block>(&mut self, first: usize, pose: &Pose, rotation: &Matrix3<f64>) -> u32 {
        let block = first / T::COUNT;
        // Says once what each access to a column would have to ask.
        if block >= CABLES.div_ceil(T::COUNT) {
            return 0;
        }
        let (attachment_m, [ax, ay, az]) = platform::attachment::<T>(pose, rotation, self.params.platform_m(block));
        let exit = swivel::exit(&self.params.swivel(block), attachment_m);
        let with_geometry = self.params.with_geometry::<T>(block);
        let moves = exit.reachable.and(with_geometry);
        let [ux, uy, uz] = exit.direction;
        let moment_arm_m = [ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux];
        let columns = &mut self.state.columns;
        let all_move = T::all(moves);
        let keep = |column: &mut [f64; CABLES], value: T| {
            let value = if all_move { value } else { T::select(moves, value, T::load(column, block)) };
            value.store(column, block);
        };
        for (column, value) in columns.direction.iter_mut().zip(exit.direction) {
            keep(column, value);
        }
        for (column, value) in columns.moment_arm_m.iter_mut().zip(moment_arm_m) {
            keep(column, value);
        }
        keep(&mut columns.pose_wrap_factor, exit.wrap_factor);
        if !self.state.directions_known {
            keep(&mut columns.direction_known, T::splat(1.0));
        }
        if self.features.traction {
            let traction_mu = T::load(&self.params.traction_mu, block);
            let [cos, sin] = exit.cos_sin_wrap;
            // Only robots with a slip limit need an angle and an exponential per cable.
            let ratio = T::from_lanes(|lane| {
                traction_ratio(traction_mu.lane(lane), swivel::wrap_rad([cos.lane(lane), sin.lane(lane)]))
            });
            let ratio = T::select(T::splat(0.0).lt(traction_mu), ratio, T::splat(NO_SLIP));
            keep(&mut columns.pose_traction_ratio, ratio);
        }
        T::bits(with_geometry.and(exit.reachable.not()))
    }

    /// Returns which cables of a block are affected by a cycle without a pose: those whose wrap follows it and, after the first wrench, all cables that
    /// contribute to it.
    #[inline(always)]
    pub(super) fn misses_pose<T: Block>(&self, block: usize) -> T::Mask {
        let stale_wrench = T::mask(self.state.gravity.is_some());
        self.params.follows_pose::<T>(block).or(stale_wrench.and(self.params.with_geometry::<T>(block)))
    }
}
