//! The compensator: parameters and state of all cables, and one cycle of them.
//!
//! Every cycle it computes the forces at the platform and the wrench from the signals at the winches, in bounded time, without allocation and without
//! panic, for any input. It reads no clock, file or bus. Non-finite input is flagged ([`CableStatus`]) and never affects another cable. Size: about
//! 1 kB per cable, and 1 kB more per cable for the delay lines.

#[cfg(feature = "alloc")]
pub(crate) mod any;
pub(crate) mod columns;
pub(crate) mod cycle;
#[cfg(feature = "alloc")]
pub(crate) mod exchange;
mod follow_pose;
mod review;
mod step;
mod takeover;
pub(crate) mod tunable;

use crate::cable::Features;
use crate::compensator::columns::{ParamColumns, StateColumns};
use crate::effects::time_delay;
use crate::friction::places::{PLACES, Places};
use crate::parameters::ParameterRow;
use crate::platform::Wrench;
use crate::robot::{MAX_PULLEYS, ParamError, ParamProblem, RobotParams, ValidatedRange};
use crate::signals::doubt::Trust;
use crate::signals::{BEFORE_FIRST, SignalLimits};
use crate::words::{Words, words_of};
use nalgebra::{SMatrix, Vector3};

/// Friction compensation of a robot with at most `CABLES` cables; the crate's first page has an example.
#[derive(Clone, Debug)]
pub struct Compensator<const CABLES: usize> {
    params: ParamColumns<CABLES>,
    state: State<CABLES>,
    features: Features,
    any_geometry: bool,
    all_geometry: bool,
    any_validated: bool,
    cable_count: usize,
    place_count: usize,
    limits: SignalLimits,
    cycle_s: f64,
    gravity_n: Vector3<f64>,
    center_of_mass_m: Vector3<f64>,
}

/// The state from one cycle to the next, see [`Compensator::snapshot`].
#[derive(Clone, Copy, Debug, PartialEq)]
struct State<const CABLES: usize> {
    columns: StateColumns<CABLES>,
    /// Whether every cable has an attachment and a known direction, so that there is a wrench.
    directions_known: bool,
    /// Wrench of gravity at the last pose; `None` until all directions are known.
    gravity: Option<Wrench>,
    /// Number of this cycle, counted from the first, and of the previous one.
    cycle: f64,
    last_cycle: f64,
    /// Whether the sensor or the stored friction of any cable is doubtful, so that all are reviewed.
    doubtful: bool,
}

words_of!(State<const CABLES> { columns, directions_known, gravity, cycle, last_cycle, doubtful });

/// The state of a [`Compensator`] at one moment, for [`Compensator::restore`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot<const CABLES: usize>(State<CABLES>);

impl<const CABLES: usize> Words for Snapshot<CABLES> {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        self.0.each_word(show);
    }
}

impl<const CABLES: usize> Compensator<CABLES> {
    const START: State<CABLES> = State {
        columns: StateColumns::START,
        directions_known: false,
        gravity: None,
        cycle: BEFORE_FIRST,
        last_cycle: BEFORE_FIRST,
        doubtful: true,
    };

    /// Creates a compensator from checked parameters.
    ///
    /// # Errors
    /// [`ParamError`] if the robot has more than `CABLES` cables.
    pub fn new(robot: &RobotParams<'_>) -> Result<Self, ParamError> {
        let cable_count = robot.cables.len();
        if cable_count > CABLES {
            let problem = ParamProblem::Count { count: cable_count, min: 1, max: CABLES };
            return Err(ParamError { key: "cable", pulley: None, effect: None, problem });
        }
        let mut params = ParamColumns::EMPTY;
        let mut features = Features::default();
        let mut place_count = 1;
        for cable in robot.cables {
            let values = cable.values();
            let is_active = |row: &ParameterRow, place: usize| values[place].to_bits() != row.neutral.to_bits();
            let leads = values[time_delay::DELAY] < 0.0;
            features = features.with(cable).with_lead(leads).and_acting(is_active);
            place_count = place_count.max(Places::needed(cable));
        }
        for (place, cable) in robot.cables.iter().enumerate() {
            let trust = Trust::new(cable, robot.monitor.sensor_jump_n, robot.monitor.length_jump_m, robot.cycle_s);
            params.set(place, cable, &trust, robot.cycle_s, place_count);
        }
        Ok(Self {
            params,
            state: Self::START,
            features,
            any_geometry: robot.cables.iter().any(|cable| cable.geometry.is_some()),
            all_geometry: robot.cables.iter().all(|cable| cable.geometry.is_some()),
            any_validated: robot.cables.iter().any(|cable| cable.validated != ValidatedRange::ANY),
            cable_count,
            place_count,
            limits: robot.monitor.limits(),
            cycle_s: robot.cycle_s,
            gravity_n: robot.gravity_m_per_s2 * robot.mass_kg,
            center_of_mass_m: robot.center_of_mass_m,
        })
    }

    /// Returns the number of cables of the robot.
    #[must_use]
    pub fn cable_count(&self) -> usize {
        self.cable_count
    }

    /// Resets the state to that after set-up: at rest, no stored friction, no pose.
    pub fn reset(&mut self) {
        self.state = Self::START;
    }

    /// Returns a copy of the whole state.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<CABLES> {
        Snapshot(self.state)
    }

    /// Restores the state of a snapshot, which must be of a robot with the same cables, pulleys, presliding and effects; this is not checked, because it
    /// cannot fail in the loop.
    pub fn restore(&mut self, snapshot: &Snapshot<CABLES>) {
        self.state = snapshot.0;
    }

    /// Returns what gives the state of a cable its meaning, see [`ParamColumns::structure_word`].
    #[cfg(feature = "alloc")]
    pub(crate) fn structure_word(&self, cable: usize) -> u64 {
        self.params.structure_word(cable)
    }

    /// Returns the friction stored at each pulley of a cable, counted from the winch, N.
    ///
    /// This is the Coulomb part, without viscous friction. It is 0 with `lumped` presliding, which has no state per pulley, for entries beyond the
    /// cable's pulleys, and for cables that the robot does not have.
    #[must_use]
    pub fn pulley_friction_n(&self, cable: usize) -> [f64; MAX_PULLEYS] {
        let places = self.params.pulley_place.get(cable).copied().unwrap_or([PLACES; MAX_PULLEYS]);
        let columns = &self.state.columns.pulley_friction_n;
        places.map(|place| columns.get(place).and_then(|column| column.get(cable)).copied().unwrap_or(0.0))
    }

    /// Returns the structure matrix `A^T` of the last cycle with a pose, force rows first; columns beyond the robot's cables are zero. `None` before the
    /// first pose, and for a robot with a cable without attachment.
    #[must_use]
    pub fn structure_matrix(&self) -> Option<SMatrix<f64, 6, CABLES>> {
        self.state.gravity?;
        let columns = &self.state.columns;
        let entry = |row: usize, cable: usize| {
            let column = if row < 3 { columns.direction.get(row) } else { columns.moment_arm_m.get(row - 3) };
            column.and_then(|column| column.get(cable)).copied().unwrap_or(0.0)
        };
        Some(SMatrix::from_fn(entry))
    }
}
