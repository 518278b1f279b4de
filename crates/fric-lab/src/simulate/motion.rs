//! How each cable moves: with the platform, or by itself on a test bench, and a little in standstill.
//!
//! Of a cable on the platform the length is the inverse kinematics' and its rate `dl/dt = −u·(v + ω × R b)`, u from the
//! platform to where the cable leaves its pulley: the wrap adds nothing, for the free cable is tangent to the pulley. A
//! cable without geometry runs the same movements as a change of its length. Each winch adds the small movements of the
//! cable force control that \[P\], section III C, describes for standstill.

use fric_core::CableParams;
use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;

use super::waves::Waves;
use crate::trajectory::{Limits, SetPoint, Trajectory, WorkBox};

/// Micro motion of a winch: amplitudes in m and frequencies in Hz.
const MICRO: [(f64, f64); 3] = [(10e-6, 0.35), (6e-6, 0.9), (4e-6, 2.1)];
/// Length of a cable without geometry in the middle of its run, m.
const BENCH_LENGTH_M: f64 = 1.0;
/// Half of the longest movement of a cable without geometry, m.
const BENCH_HALF_M: f64 = 0.2;
/// Speeds this long before and after give the acceleration between, s: short beside every ramp of a run.
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
    /// Of the platform, where any cable is attached to it.
    platform: Option<Trajectory>,
    /// Of cables without geometry, the length as x.
    bench: Trajectory,
}

/// How one cable follows them.
#[derive(Clone, Debug)]
pub struct Winch {
    params: CableParams,
    micro: Waves,
}

impl Motion {
    /// Where the length of a cable without geometry runs, as x.
    pub const BENCH: WorkBox = WorkBox {
        center_m: Vector3::new(BENCH_LENGTH_M, 0.0, 0.0),
        half_edges_m: Vector3::new(BENCH_HALF_M, 0.0, 0.0),
        direction: Vector3::new(1.0, 0.0, 0.0),
    };

    /// The platform on a run, cables without geometry on the identification run.
    pub fn new(platform: Option<Trajectory>, limits: &Limits) -> Self {
        Self::of(platform, Trajectory::identification(&Self::BENCH, limits))
    }

    /// The platform on one run, cables without geometry on another, with the length as x.
    pub fn of(platform: Option<Trajectory>, bench: Trajectory) -> Self {
        Self { platform, bench }
    }

    /// The run that sets the duration.
    pub fn trajectory(&self) -> &Trajectory {
        self.platform.as_ref().unwrap_or(&self.bench)
    }

    /// Set point of the platform, where there is one.
    pub fn platform(&self, time_s: f64) -> Option<SetPoint> {
        Some(self.platform.as_ref()?.at(time_s))
    }

    /// A cable's motion at a time at which the platform is at `platform`; `None` where it cannot leave its last pulley.
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

    /// The cable's motion with the small movements, see [`Motion::of_cable`].
    pub fn motion(&self, motion: &Motion, platform: Option<&SetPoint>, time_s: f64) -> Option<CableMotion> {
        let coarse = motion.of_cable(&self.params, platform, time_s)?;
        Some(CableMotion {
            length_m: coarse.length_m + self.micro.value(time_s),
            speed_m_per_s: coarse.speed_m_per_s + self.micro.rate(time_s),
        })
    }

    /// Its second derivative, m/s²; 0 where the cable cannot leave its last pulley.
    pub fn acceleration_m_per_s2(&self, motion: &Motion, time_s: f64) -> f64 {
        let speed_m_per_s = |time_s| Some(self.motion(motion, motion.platform(time_s).as_ref(), time_s)?.speed_m_per_s);
        let [before, after] = [time_s - APART_S, time_s + APART_S].map(speed_m_per_s);
        before.zip(after).map_or(0.0, |(before, after)| (after - before) / (2.0 * APART_S))
    }

    /// cos of the wrap that follows the pose; 1, no wrap, where none does.
    pub fn pose_cos(&self, platform: Option<&SetPoint>) -> f64 {
        let wrap_rad = platform.and_then(|set_point| self.params.pose_wrap_rad(&set_point.pose()));
        wrap_rad.map_or(1.0, libm::cos)
    }
}

/// Play between winch and cable: the cable stays where it is until the winch has turned through it.
#[derive(Clone, Debug)]
pub struct Play {
    half_m: f64,
    cable_m: Option<f64>,
}

impl Play {
    /// With the winch in the middle of its play at the start.
    pub fn new(play_m: f64) -> Self {
        Self { half_m: 0.5 * play_m, cable_m: None }
    }

    /// The cable's motion behind the winch's.
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
