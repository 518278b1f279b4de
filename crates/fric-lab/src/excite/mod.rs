//! The identification run of \[P\], section III C, as set points for a real robot, as a stream.
//!
//! For: a controller that follows it while the log is recorded which identification needs. The run is the one that the
//! simulation runs ([`Trajectory::identification`]), in a box and within limits as wanted. For each cycle there are pose, velocity
//! and acceleration of the platform, length and speed of each cable by the inverse kinematics (\[P\] 1), and forces within
//! bounds that hold the platform against gravity and inertia (`A^T f + w = 0`, \[P\] 2). Lengths are those from the entry into
//! the last pulley; elastic or sagging cables are not accounted for.
//!
//! Cables without geometry, on a test bench, get the same movements as a change of their length about 1 m, without
//! forces. Where only some cables have geometry there is a platform, but no forces: what the others pull is not known.
//!
//! Input is checked at set-up; a place that cannot be reached or held shows when its turn comes. Memory does not depend
//! on the length of the run.

mod error;
mod hold;
mod options;

use fric_core::CableParams;
use fric_core::robot::file::{CableTable, RobotFile};
use nalgebra::Vector3;

use crate::simulate::motion::Motion;
use crate::simulate::platform::Platform;
use crate::simulate::tension::TensionLevel;
use crate::simulate::workspace::{Workspace, direction_in};
use crate::trajectory::{Phase, SetPoint, Trajectory, WorkBox};
use hold::Hold;

pub use crate::simulate::motion::CableMotion;
pub use error::ExcitationError;
pub use options::ExcitationOptions;

/// The longest run, s.
pub const LONGEST_S: f64 = 3600.0;

/// An identification run in progress.
#[derive(Debug)]
pub struct Excitation {
    cycle_s: f64,
    total_cycles: u64,
    done_cycles: u64,
    work_box: Option<WorkBox>,
    motion: Motion,
    names: Vec<String>,
    cables: Vec<CableParams>,
    hold: Option<Hold>,
    motions: Vec<CableMotion>,
}

/// What is to be done in one cycle.
#[derive(Clone, Copy, Debug)]
pub struct ExcitedCycle<'a> {
    /// Time since the start, s.
    pub time_s: f64,
    /// What the movement is for.
    pub phase: Phase,
    /// Set point of the platform, where there is one.
    pub platform: Option<SetPoint>,
    /// Length and speed of the cables in the robot's order.
    pub cables: &'a [CableMotion],
    /// Forces of the cables at the platform, N, where all are attached to it.
    pub tensions_n: Option<&'a [f64]>,
}

impl Excitation {
    /// Sets the run up.
    ///
    /// # Errors
    /// [`ExcitationError`] for an option out of range or without meaning for this robot, a run that takes too long, and a
    /// robot without a place where all its cables can run.
    pub fn new(robot: &RobotFile, options: &ExcitationOptions) -> Result<Self, ExcitationError> {
        options.check()?;
        let params = robot.params();
        let tables = &robot.options().cable;
        let platform = Platform::new(&params);
        let loose = tables.iter().zip(params.cables()).find(|(_, params)| !params.has_geometry());
        if let Some(((table, _), key)) = loose.zip(options.about_platform()) {
            // A box is of use as soon as one cable is attached, bounds only if all are.
            if key != "box_m" || platform.cable_count() == 0 {
                return Err(ExcitationError::NeedsPlatform { key, cable: table.name.clone() });
            }
        }
        let level = TensionLevel::of_platform(&platform, tables);
        let work_box = match options.box_m {
            _ if platform.cable_count() == 0 => None,
            Some(corners_m) => Some(stated_box(&platform, corners_m, tables, params.cables())?),
            None => Some(Workspace::find(&platform, &level)?.work_box),
        };
        let limits = options.limits();
        let run = work_box.as_ref().map(|work_box| Trajectory::identification(work_box, &limits));
        let motion = Motion::new(run, &limits);
        let duration_s = motion.trajectory().duration_s();
        if duration_s > LONGEST_S {
            return Err(ExcitationError::TooLong { duration_s, longest_s: LONGEST_S });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked: at most 10¹⁰")]
        let total_cycles = libm::ceil(duration_s / params.cycle_s()) as u64;
        let least_n = options.min_tension_n.unwrap_or_else(|| {
            options.max_tension_n.map_or(level.least_n, |greatest_n| level.least_n.min(0.5 * greatest_n))
        });
        Ok(Self {
            cycle_s: params.cycle_s(),
            total_cycles,
            done_cycles: 0,
            work_box,
            motion,
            names: tables.iter().map(|table| table.name.clone()).collect(),
            cables: params.cables().to_vec(),
            hold: loose.is_none().then(|| Hold::new(platform, least_n, options.max_tension_n, level.mean_n)),
            motions: vec![CableMotion { length_m: 0.0, speed_m_per_s: 0.0 }; tables.len()],
        })
    }

    /// How many cycles there are.
    #[must_use]
    pub fn total_cycles(&self) -> u64 {
        self.total_cycles
    }

    /// The run; for cables without a platform with the length as x.
    #[must_use]
    pub fn trajectory(&self) -> &Trajectory {
        self.motion.trajectory()
    }

    /// Where the platform runs, where there is one.
    #[must_use]
    pub fn work_box(&self) -> Option<&WorkBox> {
        self.work_box.as_ref()
    }

    /// Least and greatest force allowed, N, where all cables hold a platform.
    #[must_use]
    pub fn tension_bounds_n(&self) -> Option<(f64, Option<f64>)> {
        self.hold.as_ref().map(Hold::bounds_n)
    }

    /// The next cycle; `None` after the last. What it lends is overwritten by the following one.
    ///
    /// # Errors
    /// [`ExcitationError::Unreachable`] and [`ExcitationError::NotHeld`] say where, when and which cable.
    ///
    /// ```
    /// use fric_core::robot::file::RobotFile;
    /// use fric_lab::excite::{Excitation, ExcitationOptions};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let text = r#"
    ///     format = "fric-robot/1"
    ///     name = "bench"
    ///     cycle_s = 0.001
    ///     [[cable]]
    ///     name = "winch"
    ///     pulleys = [{ wrap_deg = 180.0, sensor = true }]
    /// "#;
    /// let options = ExcitationOptions { max_speed_m_per_s: Some(0.2), ..ExcitationOptions::default() };
    /// let mut run = Excitation::new(&RobotFile::parse(text, "example")?, &options)?;
    /// while let Some(cycle) = run.next_cycle()? {
    ///     assert!(cycle.cables[0].speed_m_per_s.abs() <= 0.2 + 1e-12);
    /// }
    /// # Ok(())
    /// # }
    /// ```
    pub fn next_cycle(&mut self) -> Result<Option<ExcitedCycle<'_>>, ExcitationError> {
        if self.done_cycles >= self.total_cycles {
            return Ok(None);
        }
        #[expect(clippy::cast_precision_loss, reason = "checked: at most 10¹⁰")]
        let time_s = self.done_cycles as f64 * self.cycle_s;
        self.done_cycles += 1;
        let platform = self.motion.platform(time_s);
        let Some(phase) = self.motion.trajectory().phase_at(time_s) else { return Ok(None) };
        for ((cable, motion), name) in self.cables.iter().zip(&mut self.motions).zip(&self.names) {
            *motion = self.motion.of_cable(cable, platform.as_ref(), time_s).ok_or_else(|| {
                let position_m = platform.map_or([0.0; 3], |set_point| set_point.position_m.into());
                ExcitationError::Unreachable { cable: name.clone(), position_m }
            })?;
        }
        let tensions_n = match (&mut self.hold, &platform) {
            (Some(hold), Some(set_point)) => Some(hold.forces_n(set_point, time_s, phase, &self.names)?),
            _ => None,
        };
        Ok(Some(ExcitedCycle { time_s, phase, platform, cables: &self.motions, tensions_n }))
    }
}

/// A box given by its corners, with the direction of the small movements.
fn stated_box(
    platform: &Platform,
    corners_m: [[f64; 3]; 2],
    tables: &[CableTable],
    params: &[CableParams],
) -> Result<WorkBox, ExcitationError> {
    let [least_m, greatest_m] = corners_m.map(Vector3::from);
    let (center_m, half_edges_m) = ((least_m + greatest_m) * 0.5, (greatest_m - least_m) * 0.5);
    let direction = direction_in(platform, center_m, &half_edges_m).ok_or_else(|| {
        let is_stuck =
            |params: &CableParams| params.has_geometry() && params.direction(&Platform::pose(center_m)).is_none();
        let stuck = tables.iter().zip(params).find(|(_, params)| is_stuck(params));
        let cable = stuck.map(|(table, _)| table.name.clone()).unwrap_or_default();
        ExcitationError::Unreachable { cable, position_m: center_m.into() }
    })?;
    Ok(WorkBox { center_m, half_edges_m, direction })
}
