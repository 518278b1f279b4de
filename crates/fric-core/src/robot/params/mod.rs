//! Parameters of a robot, valid by construction.
//!
//! Options are plain data with defaults, as a program or a robot file states them; [`CableParams::new`] and [`RobotParams::new`] check them once.
//! Nothing after that check can fail. All types are `Copy` and free of allocation.

mod cable;
mod cable_options;

use nalgebra::{Matrix3, Vector3};

use self::cable::check_point;
use crate::effects::Effect;
use crate::effects::time_delay::{self, delay_range_s};
use crate::robot::error::{ParamError, ParamProblem, check};
use crate::robot::known_reference::KnownReference;
use crate::signals::SignalLimits;
use crate::signals::doubt::Trust;

pub use cable::CableParams;
pub(crate) use cable::{Geometry, Wrap};
pub use cable_options::{
    CableOptions, FrictionOptions, GeometryOptions, MAX_PULLEYS, Presliding, PulleyOptions, ValidatedRange,
};

/// Options of the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlatformOptions {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass, platform frame, m.
    pub center_of_mass_m: [f64; 3],
    /// Inertia tensor about the centre of mass, platform axes, kg m²: xx, xy, xz, yy, yz, zz. The products xy, xz, yz are entries of the tensor, as in
    /// ROS and URDF: xy = −∫ x·y dm.
    pub inertia_kg_m2: [f64; 6],
    /// Gravity, base frame, m/s².
    pub gravity_m_per_s2: [f64; 3],
}

impl Default for PlatformOptions {
    /// Returns a platform without mass, with standard gravity downwards.
    fn default() -> Self {
        Self {
            mass_kg: 0.0,
            center_of_mass_m: [0.0; 3],
            inertia_kg_m2: [0.0; 6],
            gravity_m_per_s2: [0.0, 0.0, -9.80665],
        }
    }
}

/// Limits beyond which a signal counts as faulty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorOptions {
    /// Number of cycles with a bit-identical sensor value, during which the cable has moved 1 mm away, after which the sensor counts as frozen; 0 for
    /// never.
    pub frozen_cycles: u32,
    /// Greatest change of length in one cycle, m.
    pub length_jump_m: f64,
    /// Amplitude of the noise of measured lengths, m: changes within it do not count as motion. 0 for set points.
    pub length_noise_m: f64,
    /// Greatest change of a sensor force in one cycle, N; beyond it the sensor has jumped. `None` derives it from the cable's presliding stiffness σ
    /// and a twentieth of `length_jump_m`. A change within 5 % of the force + 0.1 N at the platform is no jump in either case, and without σ there
    /// are none.
    pub sensor_jump_n: Option<f64>,
}

impl MonitorOptions {
    /// Returns the defaults: 100 cycles; the distance that 10 m/s cover in a cycle; no noise; jumps from each cable's own stiffness.
    #[must_use]
    pub fn for_cycle(cycle_s: f64) -> Self {
        Self { frozen_cycles: 100, length_jump_m: 10.0 * cycle_s, length_noise_m: 0.0, sensor_jump_n: None }
    }

    /// Returns the limits for the signal checks.
    #[must_use]
    pub fn limits(&self) -> SignalLimits {
        let Self { frozen_cycles, length_jump_m, length_noise_m, sensor_jump_n: _ } = *self;
        let frozen_cycles = if frozen_cycles == 0 { f64::INFINITY } else { f64::from(frozen_cycles) };
        SignalLimits { frozen_cycles, length_jump_m, length_noise_m }
    }
}

/// Maximum number of cables in a robot file.
pub const MOST_CABLES: usize = 64;

/// Checks that the noise of the lengths leaves some motion.
fn check_length_noise(monitor: &MonitorOptions) -> Result<f64, ParamError> {
    let length_noise_m = check("length_noise_m", monitor.length_noise_m, 0.0, 0.1)?;
    if length_noise_m >= monitor.length_jump_m {
        let reason = "is not less than `length_jump_m`: every change would be noise or a jump, none of them motion";
        return Err(ParamError::conflict("length_noise_m", reason));
    }
    Ok(length_noise_m)
}

impl PlatformOptions {
    /// Whether the inertia tensor can be that of a body: about no axis is its moment negative, by Sylvester's criterion but for rounding.
    #[must_use]
    pub fn is_inertia_of_a_body(&self) -> bool {
        let [xx, xy, xz, yy, yz, zz] = self.inertia_kg_m2;
        let trace = xx + yy + zz;
        let rounding = 1e-12 * trace * trace;
        let minors = [xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz];
        xx.min(yy).min(zz) >= 0.0
            && minors.iter().all(|minor| *minor >= -rounding)
            && self.inertia_tensor_kg_m2().determinant() >= -rounding * trace
    }

    fn inertia_tensor_kg_m2(&self) -> Matrix3<f64> {
        let [xx, xy, xz, yy, yz, zz] = self.inertia_kg_m2;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    fn check_inertia(&self) -> Result<Matrix3<f64>, ParamError> {
        const MOST_KG_M2: f64 = 1e9;
        for (number, least) in
            self.inertia_kg_m2.into_iter().zip([0.0, -MOST_KG_M2, -MOST_KG_M2, 0.0, -MOST_KG_M2, 0.0])
        {
            check("inertia_kg_m2", number, least, MOST_KG_M2)?;
        }
        if self.is_inertia_of_a_body() {
            return Ok(self.inertia_tensor_kg_m2());
        }
        let reason =
            "is no tensor of a body, for about some axis its moment is negative; the order is [xx, xy, xz, yy, yz, zz]";
        Err(ParamError::conflict("inertia_kg_m2", reason))
    }
}

/// A checked robot, from which a [`Compensator`](crate::Compensator) is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotParams<'a> {
    pub(crate) cycle_s: f64,
    pub(crate) mass_kg: f64,
    pub(crate) center_of_mass_m: Vector3<f64>,
    pub(crate) inertia_kg_m2: Matrix3<f64>,
    pub(crate) gravity_m_per_s2: Vector3<f64>,
    pub(crate) monitor: MonitorOptions,
    pub(crate) known_reference: Option<KnownReference>,
    pub(crate) cables: &'a [CableParams],
}

impl<'a> RobotParams<'a> {
    /// Checks a robot; `cycle_s` is the cycle time.
    ///
    /// # Errors
    /// Returns a [`ParamError`] with the first parameter that is not finite or out of range.
    pub fn new(
        cycle_s: f64,
        platform: &PlatformOptions,
        monitor: MonitorOptions,
        cables: &'a [CableParams],
    ) -> Result<Self, ParamError> {
        if cables.is_empty() {
            let problem = ParamProblem::Count { count: 0, min: 1, max: MOST_CABLES };
            return Err(ParamError { key: "cable", pulley: None, effect: None, problem });
        }
        check("cycle_s", cycle_s, 1e-6, 10.0)?;
        let length_jump_m = check("length_jump_m", monitor.length_jump_m, 1e-9, 1e3)?;
        let length_noise_m = check_length_noise(&monitor)?;
        if let Some(sensor_jump_n) = monitor.sensor_jump_n {
            check("sensor_jump_n", sensor_jump_n, 1e-6, 1e10)?;
        }
        let (earliest_s, latest_s) = delay_range_s(cycle_s);
        for cable in cables {
            check("delay_s", cable.values()[time_delay::DELAY], earliest_s, latest_s)
                .map_err(|error| error.of_effect(Effect::TimeDelay))?;
        }
        Ok(Self {
            cycle_s,
            mass_kg: check("mass_kg", platform.mass_kg, 0.0, 1e6)?,
            center_of_mass_m: check_point("center_of_mass_m", platform.center_of_mass_m)?,
            inertia_kg_m2: platform.check_inertia()?,
            gravity_m_per_s2: check_point("gravity_m_per_s2", platform.gravity_m_per_s2)?,
            monitor: MonitorOptions { length_jump_m, length_noise_m, ..monitor },
            known_reference: None,
            cables,
        })
    }

    /// Returns the same robot with known cable forces at the platform, which the cycle does not use.
    #[must_use]
    pub fn with_known_reference(self, known_reference: Option<KnownReference>) -> Self {
        Self { known_reference, ..self }
    }

    /// Returns the same robot with this noise on its lengths, m ([`MonitorOptions::length_noise_m`]).
    ///
    /// # Errors
    /// Returns a [`ParamError`] if that is out of range, or not below the greatest change of length.
    pub fn with_length_noise_m(self, length_noise_m: f64) -> Result<Self, ParamError> {
        let monitor = MonitorOptions { length_noise_m, ..self.monitor };
        check_length_noise(&monitor)?;
        Ok(Self { monitor, ..self })
    }

    /// Returns of each cable the change of its sensor force in a cycle beyond which the sensor has jumped, N, besides 5 % of the force + 0.1 N at the
    /// platform ([`MonitorOptions::sensor_jump_n`]); beyond all forces where nothing counts as a jump.
    pub fn sensor_jumps_n(&self) -> impl Iterator<Item = f64> + 'a {
        let (monitor, cycle_s) = (self.monitor, self.cycle_s);
        let trust = move |cable| Trust::new(cable, monitor.sensor_jump_n, monitor.length_jump_m, cycle_s);
        self.cables.iter().map(move |cable| trust(cable).sensor_jump_n)
    }

    /// Returns the cable forces at the platform that are known rather than measured.
    #[must_use]
    pub fn known_reference(&self) -> Option<KnownReference> {
        self.known_reference
    }

    /// Returns the cycle time, s.
    #[must_use]
    pub fn cycle_s(&self) -> f64 {
        self.cycle_s
    }

    /// Returns the mass of the platform, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Returns the centre of mass of the platform, platform frame, m.
    #[must_use]
    pub fn center_of_mass_m(&self) -> Vector3<f64> {
        self.center_of_mass_m
    }

    /// Returns the inertia tensor of the platform about its centre of mass, platform axes, kg m². The cycle does not use it: the wrench that it returns
    /// includes the inertia.
    #[must_use]
    pub fn inertia_kg_m2(&self) -> Matrix3<f64> {
        self.inertia_kg_m2
    }

    /// Returns gravity, base frame, m/s².
    #[must_use]
    pub fn gravity_m_per_s2(&self) -> Vector3<f64> {
        self.gravity_m_per_s2
    }

    /// Returns the limits beyond which a signal counts as faulty.
    #[must_use]
    pub fn monitor(&self) -> &MonitorOptions {
        &self.monitor
    }

    /// Returns the cables in order.
    #[must_use]
    pub fn cables(&self) -> &'a [CableParams] {
        self.cables
    }
}
