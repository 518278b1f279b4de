//! The motion of each cable: with the platform or alone on a test bench, plus small motion at standstill.
//!
//! The length of a cable on the platform comes from the inverse kinematics. Its rate is `dl/dt = −u·(v + ω × R b)`, with u from the platform to the
//! point where the cable leaves its pulley; the wrap adds nothing, because the free cable is tangent to the pulley. A cable without geometry runs the
//! same movements as changes of its length. Each winch adds the small movements of the cable force control that \[P\], section III C, describes for
//! standstill.

use fric_core::CableParams;
use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;

use super::waves::Waves;
use crate::trajectory::{Limits, SetPoint, Trajectory, WorkBox};

/// Micro motion of a winch: amplitudes in m and frequencies in Hz.
const MICRO: [(f64, f64); 3] = [(10e-6, 0.35), (6e-6, 0.9), (4e-6, 2.1)];
/// Length of a cable without geometry at the middle of its run, m.
const BENCH_LENGTH_M: f64 = 1.0;
/// Half the longest movement of a cable without geometry, m.
const BENCH_HALF_M: f64 = 0.2;
/// Time difference for the acceleration by central differences, s; short compared with every ramp of a run.
const APART_S: f64 = 1e-5;

/// Length of a cable and its rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableMotion {
    /// Length, m.
    pub length_m: f64,
    /// Its rate, m/s, positive paying out.
    pub speed_m_per_s: f64,
}

/// The movements of a robot.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Movement of the platform, if any cable is attached to it.
    platform: Option<Trajectory>,
    /// Movement of cables without geometry, with the length as x.
    bench: Trajectory,
}

/// The winch of one cable.
#[derive(Clone, Debug)]
pub struct Winch {
    params: CableParams,
    micro: Waves,
}

impl Motion {
    /// The box of a cable without geometry, with the length as x.
    pub const BENCH: WorkBox = WorkBox {
        center_m: Vector3::new(BENCH_LENGTH_M, 0.0, 0.0),
        half_edges_m: Vector3::new(BENCH_HALF_M, 0.0, 0.0),
        direction: Vector3::new(1.0, 0.0, 0.0),
    };

    /// Creates the motion of the platform on a run, with cables without geometry on the identification run.
    pub fn new(platform: Option<Trajectory>, limits: &Limits) -> Self {
        Self::of(platform, Trajectory::identification(&Self::BENCH, limits))
    }

    /// Creates the motion of the platform on one run, and of cables without geometry on another, with the length as x.
    pub fn of(platform: Option<Trajectory>, bench: Trajectory) -> Self {
        Self { platform, bench }
    }

    /// Returns the run that determines the duration.
    pub fn trajectory(&self) -> &Trajectory {
        self.platform.as_ref().unwrap_or(&self.bench)
    }

    /// Returns the set point of the platform, if there is one.
    pub fn platform(&self, time_s: f64) -> Option<SetPoint> {
        Some(self.platform.as_ref()?.at(time_s))
    }

    /// Returns a cable's motion at a time when the platform is at `platform`; `None` if the cable cannot leave its last pulley.
    pub fn of_cable(&self, cable: &CableParams, platform: Option<&SetPoint>, time_s: f64) -> Option<CableMotion> {
        let Some((set_point, platform_m)) = platform.zip(cable.platform_m()) else {
            let set_point = self.bench.at(time_s);
            return Some(CableMotion { length_m: set_point.position_m.x, speed_m_per_s: set_point.velocity_m_per_s.x });
        };
        let (pose, arm_m) = (set_point.pose(), set_point.orientation * platform_m);
        let velocity_m_per_s = set_point.velocity_m_per_s + set_point.angular_velocity_rad_per_s.cross(&arm_m);
        Some(CableMotion {
            length_m: cable.length_m(&pose)?,
            speed_m_per_s: -cable.direction(&pose)?.dot(&velocity_m_per_s),
        })
    }
}

impl Winch {
    pub fn new(params: &CableParams, random: &mut ChaCha8Rng) -> Self {
        Self { params: *params, micro: Waves::new(&MICRO, random) }
    }

    /// Returns the cable's motion including the small movements; see [`Motion::of_cable`].
    pub fn motion(&self, motion: &Motion, platform: Option<&SetPoint>, time_s: f64) -> Option<CableMotion> {
        let coarse = motion.of_cable(&self.params, platform, time_s)?;
        Some(CableMotion {
            length_m: coarse.length_m + self.micro.value(time_s),
            speed_m_per_s: coarse.speed_m_per_s + self.micro.rate(time_s),
        })
    }

    /// Returns the second derivative of the length, m/s²; 0 if the cable cannot leave its last pulley.
    pub fn acceleration_m_per_s2(&self, motion: &Motion, time_s: f64) -> f64 {
        let speed_m_per_s = |time_s| Some(self.motion(motion, motion.platform(time_s).as_ref(), time_s)?.speed_m_per_s);
        let [before, after] = [time_s - APART_S, time_s + APART_S].map(speed_m_per_s);
        before.zip(after).map_or(0.0, |(before, after)| (after - before) / (2.0 * APART_S))
    }

    /// Returns the cosine of the wrap that follows the pose; 1 (no wrap) if none does.
    pub fn pose_cos(&self, platform: Option<&SetPoint>) -> f64 {
        let wrap_rad = platform.and_then(|set_point| self.params.pose_wrap_rad(&set_point.pose()));
        wrap_rad.map_or(1.0, libm::cos)
    }
}

/// Play between winch and cable: the cable does not move until the winch has turned through it.
#[derive(Clone, Debug)]
pub struct Play {
    half_m: f64,
    cable_m: Option<f64>,
}

impl Play {
    /// Creates a play with the winch in its middle.
    pub fn new(play_m: f64) -> Self {
        Self { half_m: 0.5 * play_m, cable_m: None }
    }

    /// Returns the cable's motion for a motion of the winch.
    pub fn follow(&mut self, winch: CableMotion) -> CableMotion {
        if self.half_m <= 0.0 {
            return winch;
        }
        let before_m = self.cable_m.unwrap_or(winch.length_m);
        let length_m = before_m.clamp(winch.length_m - self.half_m, winch.length_m + self.half_m);
        self.cable_m = Some(length_m);
        let is_driven = (length_m - before_m) * winch.speed_m_per_s > 0.0;
        CableMotion { length_m, speed_m_per_s: if is_driven { winch.speed_m_per_s } else { 0.0 } }
    }
}
