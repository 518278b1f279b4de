//! The chain of a cable's pulleys in one cycle, in the two forms of presliding.
//!
//! Symbols and sign convention are those of [`pulley`].

use crate::bearing::Bearing;
use crate::cable::{Cable, CableModel, Features};
use crate::effects::cable_elasticity;
use crate::pulley;
use crate::scalar::{Mask, Scalar};

/// What the chain is computed from.
#[derive(Clone, Copy, Debug)]
pub struct Chain<'a, T: Scalar> {
    pub model: &'a CableModel<T>,
    pub features: Features,
    pub bearing: Bearing<T>,
    /// Sensor force, N.
    pub sensor_force_n: T,
    /// Displacement of the cable at the winch, m.
    pub displacement_m: T,
    /// What the stretch of the whole cable adds to it, m.
    pub stretch_m: T,
}

impl<T: Scalar> Chain<'_, T> {
    /// `per_pulley`: one Dahl state on each bearing; its normal force includes the friction it has stored.
    ///
    /// With the stored Coulomb friction `f_j`: `F_1 = (F_s − c(f_1 + F_pv v))/(1 − c)` (\[P\] 11), then
    /// `F_j = F_{j−1} + f_j + F_pv v`. In steady sliding this is \[P\] 10. Gives the tension behind the last pulley, and slip.
    #[inline(always)]
    pub fn per_pulley(&self, release: T::Mask, cable: &mut impl Cable<T>) -> (T, T::Mask) {
        let Self { model, features, bearing, sensor_force_n, .. } = *self;
        let mut tension_n = T::splat(0.0);
        let mut slip = T::Mask::NONE;
        for place in 0..cable.count() {
            let pulley = cable.pulley(place);
            let stored_n = cable.pulley_friction_n(place);
            let viscous_n = bearing.viscous_n(&pulley, place, cable);
            let sensed = |friction_n: T| {
                (sensor_force_n - (friction_n + viscous_n).scale(model.sensor_cos)).scale(model.frictionless_gain)
            };
            let tensions = if place == 0 {
                let behind_n = sensed(stored_n);
                (behind_n - stored_n - viscous_n, behind_n)
            } else {
                (tension_n, tension_n + stored_n + viscous_n)
            };
            let displacement_m = self.displacement_at(place, cable);
            let drag_n = bearing.drag_n(place, cable);
            let mut friction_n = bearing.move_pulley(&pulley, (stored_n, tensions), displacement_m, drag_n);
            let mut behind_n = if place == 0 { sensed(friction_n) } else { tension_n + friction_n + viscous_n };
            if features.traction {
                let traction_ratio = cable.traction_ratio(place);
                let before_n = if place == 0 { behind_n - friction_n - viscous_n } else { tension_n };
                let (limited_n, slips) = pulley::limit_traction(before_n, behind_n, traction_ratio);
                let (held_before_n, held_n) = if place == 0 {
                    let unlimited = (before_n, behind_n);
                    pulley::slipping_sensor(sensor_force_n, model.sensor_cos, unlimited, traction_ratio)
                } else {
                    (before_n, limited_n)
                };
                behind_n = T::select(slips, held_n, behind_n);
                friction_n = T::select(slips, held_n - held_before_n - viscous_n, friction_n);
                slip = slip.or(slips);
            }
            cable.set_pulley_friction_n(place, friction_n.keep(release.not()));
            tension_n = behind_n;
        }
        (tension_n, slip)
    }

    /// Displacement of the cable at a pulley, m.
    #[inline(always)]
    fn displacement_at(&self, place: usize, cable: &impl Cable<T>) -> T {
        if self.features.acting.has(cable_elasticity::ACTS) {
            self.displacement_m + self.stretch_m.scale(cable.stretch_ratio(place))
        } else {
            self.displacement_m
        }
    }

    /// Displacement of the cable over all its pulleys, m: their mean.
    #[inline(always)]
    fn mean_displacement(&self, cable: &impl Cable<T>) -> T {
        if !self.features.acting.has(cable_elasticity::ACTS) {
            return self.displacement_m;
        }
        let zero = T::splat(0.0);
        let (ratios, pulleys) = (0..cable.count()).fold((zero, zero), |(ratios, pulleys), place| {
            (ratios + cable.stretch_ratio(place), pulleys + cable.present(place))
        });
        self.displacement_m + self.stretch_m.scale(ratios / pulleys.max(T::splat(1.0)))
    }

    /// `lumped`: one Dahl state for the whole cable on the macroscopic Coulomb friction, as the paper has it. Gives the tension
    /// behind the last pulley, the friction stored, and slip.
    #[inline(always)]
    pub fn lumped(&self, cable: &impl Cable<T>) -> (T, T, T::Mask) {
        let Self { model, features, bearing, sensor_force_n, .. } = *self;
        let zero = T::splat(0.0);
        let displacement_m = self.mean_displacement(cable);
        let direction = displacement_m.sign();
        let frictionless_n = sensor_force_n.scale(model.frictionless_gain);
        let mut slip = T::Mask::NONE;
        let mut coulomb_n = zero;
        let mut viscous_n = zero;
        for place in 0..cable.count() {
            let pulley = cable.pulley(place);
            let added_n = bearing.viscous_n(&pulley, place, cable);
            let drag_n = bearing.drag_n(place, cable).map(|drag_n| drag_n.scale(direction));
            let resisting_n = drag_n.map_or(added_n, |drag_n| added_n + drag_n);
            if place == 0 {
                let (mu, gain, viscous_gain) =
                    self.sensor_pulley(pulley.wrap_factor, direction, frictionless_n, resisting_n);
                coulomb_n = sensor_force_n * gain;
                if let Some(drag_n) = drag_n {
                    coulomb_n = coulomb_n + drag_n * viscous_gain;
                }
                viscous_n = added_n * viscous_gain;
                if features.traction {
                    let traction_ratio = cable.traction_ratio(place);
                    // [P] 10 the other way round: the tension on the winch side from the one behind.
                    let (inverse_gain, inverse_viscous) = pulley::sliding_gains(-direction, mu, pulley.wrap_factor);
                    let behind_n = coulomb_n + viscous_n;
                    let before_n = behind_n * inverse_gain - resisting_n * inverse_viscous;
                    let (_, slips) = pulley::limit_traction(before_n, behind_n, traction_ratio);
                    let tensions = (before_n, behind_n);
                    let (_, held_n) =
                        pulley::slipping_sensor(sensor_force_n, model.sensor_cos, tensions, traction_ratio);
                    coulomb_n = T::select(slips, held_n - viscous_n, coulomb_n);
                    slip = slips;
                }
                continue;
            }
            let before_n = coulomb_n + viscous_n;
            let (gain, viscous_gain) = self.guide_pulley(pulley.wrap_factor, direction, before_n, resisting_n);
            let mut next_coulomb_n = coulomb_n * gain;
            if let Some(drag_n) = drag_n {
                next_coulomb_n = next_coulomb_n + drag_n * viscous_gain;
            }
            let next_viscous_n = viscous_n * gain + added_n * viscous_gain;
            if features.traction {
                let traction_ratio = cable.traction_ratio(place);
                let behind_n = next_coulomb_n + next_viscous_n;
                let (limited_n, slips) = pulley::limit_traction(before_n, behind_n, traction_ratio);
                slip = slip.or(slips);
                // The slip limit holds the sum; what it takes away is Coulomb friction.
                coulomb_n = T::select(slips, limited_n - next_viscous_n, next_coulomb_n);
                viscous_n = next_viscous_n;
            } else {
                coulomb_n = next_coulomb_n;
                viscous_n = next_viscous_n;
            }
        }
        let sliding_n = coulomb_n - frictionless_n;
        // Sliding this way leads to `sliding_n`, whose sign is not the motion's where a sensor pulley of less than 90°
        // outweighs the others: its friction lowers the tension behind it.
        let distance_m = displacement_m.abs();
        let toward_m = T::select(sliding_n.lt(zero), -distance_m, distance_m);
        let moved_n = bearing.preslide(cable.lumped_friction_n(), sliding_n.abs(), toward_m);
        (frictionless_n + moved_n + viscous_n, moved_n, slip)
    }

    /// μ, gain and viscous share of the sensor pulley in steady sliding ([`pulley::sensor_gains`]).
    ///
    /// Where μ depends on the load it is first that of the frictionless tension, then that of the tensions which this gives.
    #[inline(always)]
    fn sensor_pulley(&self, wrap_factor: T, direction: T, frictionless_n: T, resisting_n: T) -> (T, T, T) {
        let gains = |tensions| {
            let mu = self.bearing.mu_at(wrap_factor, tensions, direction);
            let (gain, viscous_gain) = pulley::sensor_gains(direction, mu, wrap_factor, self.model.sensor_cos);
            (mu, gain, viscous_gain)
        };
        let mut sliding = gains((frictionless_n, frictionless_n));
        if self.bearing.depends_on_load() {
            for _ in 0..LOAD_STEPS {
                let (mu, gain, viscous_gain) = sliding;
                let (inverse_gain, inverse_viscous) = pulley::sliding_gains(-direction, mu, wrap_factor);
                let behind_n = self.sensor_force_n * gain + resisting_n * viscous_gain;
                sliding = gains((behind_n * inverse_gain - resisting_n * inverse_viscous, behind_n));
            }
        }
        sliding
    }

    /// Gain and viscous share of another pulley in steady sliding ([`pulley::sliding_gains`]), μ likewise.
    #[inline(always)]
    fn guide_pulley(&self, wrap_factor: T, direction: T, before_n: T, resisting_n: T) -> (T, T) {
        let gains = |tensions| {
            let mu = self.bearing.mu_at(wrap_factor, tensions, direction);
            pulley::sliding_gains(direction, mu, wrap_factor)
        };
        let mut sliding = gains((before_n, before_n));
        if self.bearing.depends_on_load() {
            for _ in 0..LOAD_STEPS {
                let (gain, viscous_gain) = sliding;
                sliding = gains((before_n, before_n * gain + resisting_n * viscous_gain));
            }
        }
        sliding
    }
}

/// How often μ and the load that it depends on are worked out from each other; each time the error becomes smaller by some `μ/2`.
const LOAD_STEPS: usize = 2;
