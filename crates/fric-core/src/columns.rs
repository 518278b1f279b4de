//! Parameters and state of all cables, one column a quantity, so that four cables load as one.
//!
//! Private to the crate: the structure-of-arrays behind [`Compensator`](crate::Compensator).

use crate::cable::{CableModel, Pulley, Pulleys};
use crate::effects::stribeck::Stribeck;
use crate::effects::time_delay::{Delay, DelayLine};
use crate::lanes::{Lanes, LanesMask};
use crate::pulley::wrap_factor;
use crate::robot::{CableParams, MAX_PULLEYS, Presliding, Wrap};
use crate::scalar::Scalar;
use crate::swivel::Swivel;

/// Places of pulleys: a sensor in line with the cable takes one of its own.
pub const PLACES: usize = MAX_PULLEYS + 1;

/// Far beyond every tension ratio, and its inverse still a normal number.
const NO_SLIP: f64 = 1e200;
/// Stands for "no presliding": motion of a picometre reverses any friction.
const NO_PRESLIDING_N_PER_M: f64 = 1e15;

/// Parameters that do not change while running.
#[derive(Clone, Copy, Debug)]
pub struct ParamColumns<const CABLES: usize> {
    mu: [f64; CABLES],
    sigma_n_per_m: [f64; CABLES],
    offset_n: [f64; CABLES],
    sensor_cos: [f64; CABLES],
    frictionless_gain: [f64; CABLES],
    lumped: [f64; CABLES],
    stribeck_ratio: [f64; CABLES],
    stribeck_velocity_m_per_s: [f64; CABLES],
    wrap_factor: [[f64; CABLES]; PLACES],
    viscous_n_s_per_m: [[f64; CABLES]; PLACES],
    traction_ratio: [[f64; CABLES]; PLACES],
    /// 1 where the pulley at the last place follows the pose.
    follows_pose: [f64; CABLES],
    pub traction_mu: [f64; CABLES],
    pub least_force_n: [f64; CABLES],
    pub greatest_force_n: [f64; CABLES],
    pub greatest_speed_m_per_s: [f64; CABLES],
    pub delay: [Delay; CABLES],
    entry_m: [[f64; CABLES]; 3],
    axis: [[f64; CABLES]; 3],
    radius_m: [f64; CABLES],
    platform_m: [[f64; CABLES]; 3],
    has_geometry: [f64; CABLES],
    /// Where each pulley of a cable stands; [`PLACES`] for those that it does not have.
    pub pulley_place: [[usize; MAX_PULLEYS]; CABLES],
}

impl<const CABLES: usize> ParamColumns<CABLES> {
    /// Columns of cables that are not there: no friction, no geometry.
    pub const EMPTY: Self = Self {
        mu: [0.0; CABLES],
        sigma_n_per_m: [1.0; CABLES],
        offset_n: [0.0; CABLES],
        sensor_cos: [0.0; CABLES],
        frictionless_gain: [1.0; CABLES],
        lumped: [0.0; CABLES],
        stribeck_ratio: [0.0; CABLES],
        stribeck_velocity_m_per_s: [1.0; CABLES],
        wrap_factor: [[0.0; CABLES]; PLACES],
        viscous_n_s_per_m: [[0.0; CABLES]; PLACES],
        traction_ratio: [[NO_SLIP; CABLES]; PLACES],
        follows_pose: [0.0; CABLES],
        traction_mu: [0.0; CABLES],
        least_force_n: [-f64::MAX; CABLES],
        greatest_force_n: [f64::MAX; CABLES],
        greatest_speed_m_per_s: [f64::MAX; CABLES],
        delay: [Delay { cycles: 0, fraction: 0.0 }; CABLES],
        entry_m: [[0.0; CABLES]; 3],
        axis: [[0.0; CABLES], [0.0; CABLES], [1.0; CABLES]],
        radius_m: [0.0; CABLES],
        platform_m: [[0.0; CABLES]; 3],
        has_geometry: [0.0; CABLES],
        pulley_place: [[PLACES; MAX_PULLEYS]; CABLES],
    };
}

impl<const CABLES: usize> ParamColumns<CABLES> {
    /// Enters a cable of a robot with `place_count` places a cable.
    ///
    /// The pulleys stand from the first place on, but one that follows the pose at the last: there it is for all cables,
    /// and places without a pulley lie before it.
    pub fn set(&mut self, cable: usize, params: &CableParams, cycle_s: f64, place_count: usize) {
        let states = match params.presliding {
            Presliding::PerPulley => params.pulley_count,
            Presliding::Lumped => 1,
        };
        #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
        let sigma_n_per_m = params.friction.sigma_n_per_m.unwrap_or(NO_PRESLIDING_N_PER_M) / states as f64;
        let sensor_cos = params.sensor_wrap_rad.map_or(0.0, libm::cos);
        let first_place = usize::from(params.sensor_wrap_rad.is_none());
        put(&mut self.mu, cable, params.friction.mu);
        put(&mut self.sigma_n_per_m, cable, sigma_n_per_m);
        put(&mut self.offset_n, cable, params.friction.offset_n);
        put(&mut self.sensor_cos, cable, sensor_cos);
        put(&mut self.frictionless_gain, cable, 1.0 / (1.0 - sensor_cos));
        put(&mut self.lumped, cable, f64::from(params.presliding == Presliding::Lumped));
        put(&mut self.stribeck_ratio, cable, params.effects.stribeck.ratio);
        put(&mut self.stribeck_velocity_m_per_s, cable, params.effects.stribeck.velocity_m_per_s);
        put(&mut self.traction_mu, cable, params.traction_mu.unwrap_or(0.0));
        put(&mut self.least_force_n, cable, params.validated.force_n[0]);
        put(&mut self.greatest_force_n, cable, params.validated.force_n[1]);
        put(&mut self.greatest_speed_m_per_s, cable, params.validated.speed_m_per_s);
        put(&mut self.delay, cable, Delay::from_cycles(params.effects.delay_s / cycle_s));
        let places = self.wrap_factor.iter_mut().zip(&mut self.viscous_n_s_per_m).zip(&mut self.traction_ratio);
        let wraps = params.wraps.iter().take(params.pulley_count);
        let mut pulley_place = [PLACES; MAX_PULLEYS];
        let rows = places.enumerate().skip(first_place).zip(wraps).zip(&mut pulley_place);
        for (((place, ((factors, viscous), ratios)), wrap), stands_at) in rows {
            *stands_at = if *wrap == Wrap::Pose { place_count - 1 } else { place };
            match *wrap {
                Wrap::Fixed { wrap_rad } => {
                    put(viscous, cable, params.friction.viscous_n_s_per_m);
                    put(factors, cable, wrap_factor(wrap_rad));
                    if let Some(traction_mu) = params.traction_mu {
                        put(ratios, cable, libm::exp(traction_mu * wrap_rad));
                    }
                }
                Wrap::Pose => put(&mut self.follows_pose, cable, 1.0),
            }
        }
        put(&mut self.pulley_place, cable, pulley_place);
        if let Some(viscous) = self.viscous_n_s_per_m.get_mut(place_count - 1).filter(|_| params.needs_pose()) {
            put(viscous, cable, params.friction.viscous_n_s_per_m);
        }
        if let Some(geometry) = &params.geometry {
            let points = [
                (&mut self.entry_m, geometry.base_m),
                (&mut self.axis, geometry.axis),
                (&mut self.platform_m, geometry.platform_m),
            ];
            for (columns, point) in points {
                for (column, coordinate) in columns.iter_mut().zip(point.iter()) {
                    put(column, cable, *coordinate);
                }
            }
            put(&mut self.radius_m, cable, geometry.radius_m);
            put(&mut self.has_geometry, cable, 1.0);
        }
    }

    /// Parameters of the cables of a block.
    #[inline(always)]
    pub fn model(&self, block: usize) -> CableModel<Lanes> {
        CableModel {
            mu: Lanes::load(&self.mu, block),
            sigma_n_per_m: Lanes::load(&self.sigma_n_per_m, block),
            offset_n: Lanes::load(&self.offset_n, block),
            sensor_cos: Lanes::load(&self.sensor_cos, block),
            frictionless_gain: Lanes::load(&self.frictionless_gain, block),
            lumped: Lanes::splat(0.0).lt(Lanes::load(&self.lumped, block)),
            stribeck: Stribeck {
                ratio: Lanes::load(&self.stribeck_ratio, block),
                velocity_m_per_s: Lanes::load(&self.stribeck_velocity_m_per_s, block),
            },
        }
    }

    /// Last pulleys of a block.
    #[inline(always)]
    pub fn swivel(&self, block: usize) -> Swivel<Lanes> {
        Swivel {
            entry_m: self.entry_m.each_ref().map(|column| Lanes::load(column, block)),
            axis: self.axis.each_ref().map(|column| Lanes::load(column, block)),
            radius_m: Lanes::load(&self.radius_m, block),
        }
    }

    /// Attachment points of a block in the platform frame, m.
    #[inline(always)]
    pub fn platform_m(&self, block: usize) -> [Lanes; 3] {
        self.platform_m.each_ref().map(|column| Lanes::load(column, block))
    }

    /// Which cables of a block have an attachment.
    #[inline(always)]
    pub fn with_geometry(&self, block: usize) -> LanesMask {
        Lanes::splat(0.0).lt(Lanes::load(&self.has_geometry, block))
    }

    /// Where the last pulley's wrap follows the pose, in a block.
    #[inline(always)]
    pub fn follows_pose(&self, block: usize) -> LanesMask {
        Lanes::splat(0.0).lt(Lanes::load(&self.follows_pose, block))
    }
}

/// What a cycle leaves for the next one. Plain numbers: copying it is the snapshot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateColumns<const CABLES: usize> {
    /// Last good sensor force, N.
    pub sensor_force_n: [f64; CABLES],
    /// Cycles since it has changed.
    pub frozen_count: [f64; CABLES],
    /// Last finite length, m; NaN before the first.
    pub length_m: [f64; CABLES],
    /// How far the cable has moved since the sensor has changed last, m.
    pub frozen_travel_m: [f64; CABLES],
    /// Last good friction in all, N.
    pub friction_n: [f64; CABLES],
    /// Dahl state of the `lumped` form, N.
    pub lumped_friction_n: [f64; CABLES],
    /// Dahl states of the `per_pulley` form, N.
    pub pulley_friction_n: [[f64; CABLES]; PLACES],
    /// Wrap factor and traction ratio of the pulley that follows the pose.
    pub pose_wrap_factor: [f64; CABLES],
    pub pose_traction_ratio: [f64; CABLES],
    /// 1 once a pose has let the cable leave its last pulley.
    pub direction_known: [f64; CABLES],
    /// Columns of the structure matrix.
    pub direction: [[f64; CABLES]; 3],
    pub moment_arm_m: [[f64; CABLES]; 3],
    pub delayed_displacement_m: [DelayLine; CABLES],
    pub delayed_speed_m_per_s: [DelayLine; CABLES],
}

impl<const CABLES: usize> StateColumns<CABLES> {
    /// At rest, nothing stored, no pose yet: the wrap that follows it taken as 90°.
    pub const START: Self = Self {
        sensor_force_n: [0.0; CABLES],
        frozen_count: [0.0; CABLES],
        length_m: [f64::NAN; CABLES],
        frozen_travel_m: [0.0; CABLES],
        friction_n: [0.0; CABLES],
        lumped_friction_n: [0.0; CABLES],
        pulley_friction_n: [[0.0; CABLES]; PLACES],
        pose_wrap_factor: [core::f64::consts::SQRT_2; CABLES],
        pose_traction_ratio: [NO_SLIP; CABLES],
        direction_known: [0.0; CABLES],
        direction: [[0.0; CABLES]; 3],
        moment_arm_m: [[0.0; CABLES]; 3],
        delayed_displacement_m: [DelayLine::EMPTY; CABLES],
        delayed_speed_m_per_s: [DelayLine::EMPTY; CABLES],
    };
}

/// The pulleys of a block with their stored friction.
pub struct PulleyColumns<'a, const CABLES: usize> {
    pub params: &'a ParamColumns<CABLES>,
    pub pulley_friction_n: &'a mut [[f64; CABLES]; PLACES],
    pub pose_wrap_factor: &'a [f64; CABLES],
    pub pose_traction_ratio: &'a [f64; CABLES],
    pub block: usize,
    pub count: usize,
}

impl<'a, const CABLES: usize> PulleyColumns<'a, CABLES> {
    #[inline(always)]
    pub fn new(
        params: &'a ParamColumns<CABLES>,
        state: &'a mut StateColumns<CABLES>,
        block: usize,
        count: usize,
    ) -> Self {
        Self {
            pose_wrap_factor: &state.pose_wrap_factor,
            pose_traction_ratio: &state.pose_traction_ratio,
            params,
            pulley_friction_n: &mut state.pulley_friction_n,
            block,
            count,
        }
    }
}

impl<const CABLES: usize> PulleyColumns<'_, CABLES> {
    #[inline(always)]
    fn column(&self, columns: &[[f64; CABLES]; PLACES], place: usize) -> Lanes {
        columns.get(place).map_or(Lanes::splat(0.0), |column| Lanes::load(column, self.block))
    }

    /// What the pose gives at the last place of cables that follow it, else what is fixed.
    #[inline(always)]
    fn posed(&self, place: usize, by_pose: &[f64; CABLES], fixed: &[[f64; CABLES]; PLACES]) -> Lanes {
        let fixed = self.column(fixed, place);
        if place + 1 < self.count {
            return fixed;
        }
        Lanes::select(self.params.follows_pose(self.block), Lanes::load(by_pose, self.block), fixed)
    }
}

impl<const CABLES: usize> Pulleys<Lanes> for PulleyColumns<'_, CABLES> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }
    #[inline(always)]
    fn pulley(&self, place: usize) -> Pulley<Lanes> {
        Pulley {
            wrap_factor: self.posed(place, self.pose_wrap_factor, &self.params.wrap_factor),
            viscous_n_s_per_m: self.column(&self.params.viscous_n_s_per_m, place),
        }
    }
    #[inline(always)]
    fn traction_ratio(&self, place: usize) -> Lanes {
        self.posed(place, self.pose_traction_ratio, &self.params.traction_ratio)
    }
    #[inline(always)]
    fn friction_n(&self, place: usize) -> Lanes {
        self.column(self.pulley_friction_n, place)
    }
    #[inline(always)]
    fn set_friction_n(&mut self, place: usize, friction_n: Lanes) {
        if let Some(column) = self.pulley_friction_n.get_mut(place) {
            friction_n.store(column, self.block);
        }
    }
}

/// `column[place] = value`, nothing where the place does not exist.
fn put<V, const COUNT: usize>(column: &mut [V; COUNT], place: usize, value: V) {
    if let Some(entry) = column.get_mut(place) {
        *entry = value;
    }
}
