//! The chain of a cable's pulleys in one cycle, for both forms of presliding.
//!
//! Symbols and sign convention are those of [`pulley`].

use crate::cable::{Cable, CableModel, Features};
use crate::effects::cable_elasticity;
use crate::friction::bearing::Bearing;
use crate::pulley;
use crate::scalar::{Mask, Scalar};

/// The inputs of the chain.
#[derive(Clone, Copy, Debug)]
pub struct Chain<'a, T: Scalar> {
    pub model: &'a CableModel<T>,
    pub features: Features,
    pub bearing: Bearing<T>,
    /// Sensor force, N.
    pub sensor_force_n: T,
    /// Displacement of the cable at the winch, m.
    pub displacement_m: T,
    /// Additional displacement due to the stretch of the whole cable, m.
    pub stretch_m: T,
}

impl<T: Scalar> Chain<'_, T> {
    /// `per_pulley`: one Dahl state per bearing, whose normal force includes the stored friction.
    ///
    /// With the stored Coulomb friction `f_j`: `F_1 = (F_s − c(f_1 + F_pv v))/(1 − c)` (\[P\] 11), then `F_j = F_{j−1} + f_j + F_pv v`. In steady
    /// sliding this is \[P\] 10. Returns the tension behind the last pulley, the stored magnitudes, and whether the cable slips.
    #[inline(always)]
    pub fn per_pulley(&self, release: T::Mask, cable: &mut impl Cable<T>) -> (T, T, T::Mask) {
        let Self { model, features, bearing, sensor_force_n, .. } = self;
        let sensor_force_n = *sensor_force_n;
        let (mut tension_n, mut sum_n) = (T::splat(0.0), T::splat(0.0));
        let mut slip = T::Mask::NONE;
        for place in 0..cable.count() {
            let stored_n = cable.pulley_friction_n(place);
            let viscous_n = bearing.viscous_n(place, cable);
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
            let mut friction_n = bearing.move_pulley(place, (stored_n, tensions), displacement_m, cable);
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
            let friction_n = friction_n.keep(release.not());
            cable.set_pulley_friction_n(place, friction_n);
            sum_n = sum_n + friction_n.abs();
            tension_n = behind_n;
        }
        (tension_n, sum_n, slip)
    }

    /// Returns the displacement of the cable at a pulley, m.
    #[inline(always)]
    fn displacement_at(&self, place: usize, cable: &impl Cable<T>) -> T {
        if self.features.acting.has(cable_elasticity::ACTS) {
            self.displacement_m + self.stretch_m.scale(cable.stretch_ratio(place))
        } else {
            self.displacement_m
        }
    }

    /// Returns the mean displacement of the cable over all its pulleys, m.
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

    /// `lumped`: one Dahl state for the whole cable on the macroscopic Coulomb friction, as in the paper. Returns the tension behind the last pulley,
    /// the stored friction, and whether the cable slips.
    #[inline(always)]
    pub fn lumped(&self, cable: &impl Cable<T>) -> (T, T, T::Mask) {
        let Self { model, features, bearing, sensor_force_n, .. } = self;
        let sensor_force_n = *sensor_force_n;
        let (zero, one, two) = (T::splat(0.0), T::splat(1.0), T::splat(2.0));
        let displacement_m = self.mean_displacement(cable);
        let direction = bearing.direction(displacement_m, cable.lumped_friction_n(), cable);
        let frictionless_n = sensor_force_n.scale(model.frictionless_gain);
        let mut slip = T::Mask::NONE;
        // Coulomb and viscous part of the tension have a common divisor, so the whole cable needs one division. Only terms that depend on the tension
        // at each pulley divide there, and they leave these numbers unchanged: the bits of a cable must not depend on what another cable needs.
        let needs_tensions = features.traction || bearing.depends_on_load();
        let (mut coulomb_n, mut viscous_n, mut divisor) = (zero, zero, one);
        for place in 0..cable.count() {
            let wrap_factor = cable.wrap_factor(place);
            let added_n = bearing.viscous_n(place, cable);
            let drag_n = if bearing.drags() { Bearing::drag_n(place, cable).scale(direction) } else { zero };
            let resisting_n = if bearing.drags() { added_n + drag_n } else { added_n };
            let tension_n = |coulomb_n: T, viscous_n: T, divisor: T| (coulomb_n + viscous_n) / divisor;
            let before_n = if needs_tensions { tension_n(coulomb_n, viscous_n, divisor) } else { frictionless_n };
            let mu = if place == 0 {
                let around_n = |mu: T, resisting_n: T| {
                    let (gain, viscous_gain) = pulley::sensor_gains(direction, mu, wrap_factor, model.sensor_cos);
                    let behind_n = sensor_force_n * gain + resisting_n * viscous_gain;
                    (before_sensor_n(behind_n, (mu, wrap_factor), direction, resisting_n), behind_n)
                };
                self.sliding_mu((place, direction, resisting_n), around_n, cable)
            } else {
                let around_n = |mu: T, resisting_n: T| {
                    let (gain, viscous_gain) = pulley::sliding_gains(direction, mu, wrap_factor);
                    (before_n, before_n * gain + resisting_n * viscous_gain)
                };
                self.sliding_mu((place, direction, resisting_n), around_n, cable)
            };
            let coupling = mu.scale(direction).scale(wrap_factor);
            let (plus, minus) = (two + coupling, two - coupling);
            // The factor on a resisting force ([`pulley::sensor_gains`], [`pulley::sliding_gains`]).
            let share = if place == 0 { -(two.scale(model.sensor_cos)) } else { divisor.scale(two) };
            if place == 0 {
                coulomb_n = sensor_force_n * plus;
                divisor = plus - minus.scale(model.sensor_cos);
            } else {
                coulomb_n = coulomb_n * plus;
                viscous_n = viscous_n * plus;
                divisor = divisor * minus;
            }
            viscous_n = viscous_n + added_n * share;
            if bearing.drags() {
                coulomb_n = coulomb_n + drag_n * share;
            }
            if features.traction {
                let traction_ratio = cable.traction_ratio(place);
                let behind_n = tension_n(coulomb_n, viscous_n, divisor);
                let (held_n, slips) = if place == 0 {
                    let before_n = before_sensor_n(behind_n, (mu, wrap_factor), direction, resisting_n);
                    let (_, slips) = pulley::limit_traction(before_n, behind_n, traction_ratio);
                    let tensions = (before_n, behind_n);
                    let (_, held_n) =
                        pulley::slipping_sensor(sensor_force_n, model.sensor_cos, tensions, traction_ratio);
                    (held_n, slips)
                } else {
                    pulley::limit_traction(before_n, behind_n, traction_ratio)
                };
                // The slip limit applies to the sum; what it removes is Coulomb friction.
                coulomb_n = T::select(slips, held_n * divisor - viscous_n, coulomb_n);
                slip = slip.or(slips);
            }
        }
        let inverse = one / divisor;
        let viscous_n = viscous_n * inverse;
        let sliding_n = coulomb_n * inverse - frictionless_n;
        // Sliding in this direction leads to `sliding_n`. Its sign differs from that of the motion if a sensor pulley of less than 90° outweighs the
        // others, because its friction lowers the tension behind it.
        let distance_m = displacement_m.abs();
        let toward_m = T::select(sliding_n.lt(zero), -distance_m, distance_m);
        let moved_n = bearing.preslide(cable.lumped_friction_n(), sliding_n.abs(), toward_m, cable);
        (frictionless_n + moved_n + viscous_n, moved_n, slip)
    }

    /// Returns μ of the pulley at a position in steady sliding, `f = μ·F_N`. `around_n` returns the tensions before and behind it for a μ and for the force
    /// that resists besides.
    ///
    /// If μ depends on the load, so do the tensions on μ. Newton's method solves the two: each step solves the pulley for a bearing whose friction is the
    /// tangent to the law, [`Bearing::tangent`]. It starts at the side from which it converges without passing the solution
    /// ([`Bearing::first_mu`]), and ends with μ at the last load. So μ never exceeds its bound, and with an exponent below 1 friction that adds to the
    /// load is never too great.
    #[inline(always)]
    fn sliding_mu(
        &self,
        (place, direction, resisting_n): (usize, T, T),
        around_n: impl Fn(T, T) -> (T, T),
        cable: &impl Cable<T>,
    ) -> T {
        let bearing = &self.bearing;
        let zero = T::splat(0.0);
        if !bearing.depends_on_load() {
            return bearing.mu_at(place, (zero, zero), direction, cable);
        }
        let mut tensions = around_n(bearing.first_mu(cable), resisting_n);
        let mut mu = bearing.mu_at(place, tensions, direction, cable);
        for _ in 0..NEWTON_STEPS {
            let (slope, constant_n) = bearing.tangent(place, mu, tensions, cable);
            tensions = around_n(slope, resisting_n + constant_n.scale(direction));
            mu = bearing.mu_at(place, tensions, direction, cable);
        }
        mu
    }
}

/// Steps of Newton's method between μ and the load that it depends on. With one, friction at next to no load can be wrong by half of the tension; with
/// three, by nothing that matters, but a cycle would compute one power more per pulley.
const NEWTON_STEPS: usize = 2;

/// Returns the tension on the winch side of a sliding pulley from the one behind it, N: \[P\] 10 inverted.
#[inline(always)]
fn before_sensor_n<T: Scalar>(behind_n: T, (mu, wrap_factor): (T, T), direction: T, resisting_n: T) -> T {
    let (inverse_gain, inverse_viscous) = pulley::sliding_gains(-direction, mu, wrap_factor);
    behind_n * inverse_gain - resisting_n * inverse_viscous
}
