//! The identification run of \[P\], section III C, as a stream of set points for a real robot.
//!
//! A controller follows it while the log for the identification is recorded. The run equals the simulated one ([`Trajectory::identification`]), in a
//! chosen box and within chosen limits. Each cycle contains pose, velocity and acceleration of the platform, length and speed of each cable by
//! inverse kinematics (\[P\] 1), and forces within bounds that hold the platform against gravity and inertia (`A^T f + w = 0`, \[P\] 2). Lengths are
//! measured from the entry into the last pulley; elasticity and sag of the cables are neglected.
//!
//! Cables without geometry, on a test bench, get the same movements as changes of their length around 1 m, without forces. If only some cables have
//! geometry there is a platform, but no forces, because the pull of the others is unknown.
//!
//! The input is checked at set-up. A position that cannot be reached or held is reported when its cycle comes. Memory does not depend on the length
//! of the run.

mod design;
mod error;
mod hold;
mod loads;
mod options;

use fric_core::CableParams;
use fric_core::robot::file::{CableTable, RobotFile};
use nalgebra::Vector3;

use crate::simulate::mechanics::motion::Motion;
use crate::simulate::mechanics::platform::Platform;
use crate::simulate::mechanics::tension::TensionLevel;
use crate::simulate::mechanics::workspace::{Workspace, direction_in};
use crate::trajectory::{Phase, Piece, SetPoint, Trajectory, WorkBox};
use hold::Hold;
use loads::Loads;

pub use crate::simulate::mechanics::motion::CableMotion;
pub use design::{Aim, Experiment, Forecast, Goal, KnownParameter, LEAST_SCORE, Question, STANDARD_DURATION_S, design};
pub use error::ExcitationError;
pub use options::ExcitationOptions;

/// Maximum duration of a run, s.
pub const LONGEST_S: f64 = 3600.0;

/// A run in progress: the identification run, or a designed one.
#[derive(Clone, Debug)]
pub struct Excitation {
    cycle_s: f64,
    total_cycles: u64,
    done_cycles: u64,
    work_box: Option<WorkBox>,
    motion: Motion,
    names: Vec<String>,
    cables: Vec<CableParams>,
    hold: Option<Hold>,
    loads: Loads,
    motions: Vec<CableMotion>,
    /// Expected force of each cable at the platform, N, as far as it is known.
    expected_n: Vec<f64>,
}

/// The set points of one cycle.
#[derive(Clone, Copy, Debug)]
pub struct ExcitedCycle<'a> {
    /// Time since the start, s.
    pub time_s: f64,
    /// The purpose of the movement.
    pub phase: Phase,
    /// Set point of the platform, if there is one.
    pub platform: Option<SetPoint>,
    /// Length and speed of the cables, in the robot's order.
    pub cables: &'a [CableMotion],
    /// Cable forces at the platform, N; present if all cables are attached to it, or if the run sets the load of a test bench.
    pub tensions_n: Option<&'a [f64]>,
    /// The same; if the run does not set them, the expected forces.
    pub(crate) expected_n: &'a [f64],
}

impl Excitation {
    /// Sets up the identification run.
    ///
    /// # Errors
    /// Returns an [`ExcitationError`] for an option that is out of range or meaningless for this robot, a run that takes too long, and a robot
    /// without a position where all its cables can run.
    pub fn new(robot: &RobotFile, options: &ExcitationOptions) -> Result<Self, ExcitationError> {
        Self::of(robot, options, None)
    }

    /// Sets up a run of pieces that lasts `duration_s`, or longer if the pieces take longer. With `max_tension_n` it also sets the load of a test
    /// bench.
    pub(crate) fn of_pieces(
        robot: &RobotFile,
        options: &ExcitationOptions,
        pieces: &[Piece],
        duration_s: f64,
    ) -> Result<Self, ExcitationError> {
        Self::of(robot, options, Some((pieces, duration_s)))
    }

    fn of(
        robot: &RobotFile,
        options: &ExcitationOptions,
        pieces: Option<(&[Piece], f64)>,
    ) -> Result<Self, ExcitationError> {
        options.check()?;
        let params = robot.params();
        let tables = &robot.options().cable;
        let platform = Platform::new(&params);
        let is_bench = platform.cable_count() == 0;
        let loose = tables.iter().zip(params.cables()).find(|(_, params)| !params.has_geometry());
        if let Some(((table, _), key)) = loose.zip(options.about_platform()) {
            // A box is meaningful if at least one cable is attached; bounds are meaningful if all are, or if the run sets the load of a bench.
            let states_load = is_bench && pieces.is_some() && key != "box_m";
            if !states_load && (key != "box_m" || is_bench) {
                return Err(ExcitationError::NeedsPlatform { key, cable: table.name.clone() });
            }
        }
        let level = if is_bench {
            TensionLevel::of_bench(platform.weight_n(), tables)
        } else {
            TensionLevel::of_platform(&platform, tables)
        };
        let loads = Loads::new(&level, options, params.known_reference(), loose.is_none())?;
        let work_box = match options.box_m {
            _ if is_bench => None,
            Some(corners_m) => Some(stated_box(&platform, corners_m, tables, params.cables())?),
            None => Some(Workspace::find(&platform, &level)?.work_box),
        };
        let limits = options.limits(params.known_reference().filter(|_| is_bench).as_ref());
        let run = |work_box: &WorkBox| match pieces {
            Some((pieces, duration_s)) => Trajectory::designed(work_box, &limits, pieces, duration_s),
            None => Trajectory::identification(work_box, &limits),
        };
        let motion = Motion::of(work_box.as_ref().map(run), run(&Motion::BENCH));
        let duration_s = motion.trajectory().duration_s();
        if duration_s > LONGEST_S {
            return Err(ExcitationError::TooLong { duration_s, longest_s: LONGEST_S });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked: at most 10¹⁰")]
        let total_cycles = libm::ceil(duration_s / params.cycle_s()) as u64;
        Ok(Self {
            cycle_s: params.cycle_s(),
            total_cycles,
            done_cycles: 0,
            work_box,
            motion,
            names: tables.iter().map(|table| table.name.clone()).collect(),
            cables: params.cables().to_vec(),
            hold: loose.is_none().then(|| Hold::new(platform, loads.least_n(), options.max_tension_n)),
            loads,
            motions: vec![CableMotion { length_m: 0.0, speed_m_per_s: 0.0 }; tables.len()],
            expected_n: vec![0.0; tables.len()],
        })
    }

    /// Returns the number of cycles.
    #[must_use]
    pub fn total_cycles(&self) -> u64 {
        self.total_cycles
    }

    /// Returns the run; for cables without a platform, with the length as x.
    #[must_use]
    pub fn trajectory(&self) -> &Trajectory {
        self.motion.trajectory()
    }

    /// Returns the box of the platform, if there is one.
    #[must_use]
    pub fn work_box(&self) -> Option<&WorkBox> {
        self.work_box.as_ref()
    }

    /// Returns the least and the greatest allowed force, N, if all cables hold a platform or the run sets the load of a test bench.
    #[must_use]
    pub fn tension_bounds_n(&self) -> Option<(f64, Option<f64>)> {
        self.hold.as_ref().map(Hold::bounds_n).or(self.loads.of_bench_n())
    }

    /// Returns a warning if the cables of a run without a platform may belong to one.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        let count = self.names.len();
        (self.work_box.is_none() && count > 1).then(|| {
            format!(
                "the robot file gives no `base_m` and `platform_m`: the run moves all {count} cables alike, as on a test bench; if they \
                 hold a platform, do not drive it: add both to each cable, and the run moves the platform"
            )
        })
    }

    /// Returns the wanted force of each cable, N, in a run that states it.
    pub(crate) fn stated_load_n(&self, time_s: f64) -> Option<f64> {
        self.motion.trajectory().load_share_at(time_s).and_then(|share| self.loads.stated_n(share))
    }

    /// Returns the movements of the run.
    pub(crate) fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Whether the run can change the cable tensions.
    pub(crate) fn states_loads(&self) -> bool {
        self.loads.stated_n(0.5).is_some()
    }

    /// Returns the next cycle; `None` after the last. The following call overwrites the borrowed data.
    ///
    /// # Errors
    /// Returns [`ExcitationError::Unreachable`] or [`ExcitationError::NotHeld`] with position, time and cable.
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
        let stated_n = self.stated_load_n(time_s);
        let is_stated = if let (Some(hold), Some(set_point)) = (&mut self.hold, &platform) {
            let wanted_n = stated_n.unwrap_or(self.loads.usual_n());
            let forces_n = hold.forces_n(set_point, wanted_n, time_s, phase, &self.names)?;
            self.expected_n.copy_from_slice(forces_n);
            true
        } else {
            let acceleration_m_per_s2 = self.motion.trajectory().at(time_s).acceleration_m_per_s2.x;
            self.expected_n.fill(stated_n.unwrap_or_else(|| self.loads.expected_n(acceleration_m_per_s2)));
            stated_n.is_some()
        };
        let expected_n = self.expected_n.as_slice();
        let tensions_n = is_stated.then_some(expected_n);
        Ok(Some(ExcitedCycle { time_s, phase, platform, cables: &self.motions, tensions_n, expected_n }))
    }
}

/// Returns a box given by its corners, with the direction of the small movements.
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
