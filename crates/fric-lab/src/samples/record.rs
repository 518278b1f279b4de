//! The data of a log for an identification: the signals of each cable as the cycle uses them, sample by sample.
//!
//! A log is conditioned once ([`fric_core::signals`]) and then evaluated many times. Memory: 80 bytes per sample and cable plus 8 per sample; a fit
//! to the wrench needs 48 more per cable and 150 for the platform. [`SampleStore`](super::store::SampleStore) holds rows that do not fit into memory.

use std::ops::Range;
use std::sync::Arc;

use fric_core::effects::{UNKNOWN, sensor_offset};
use fric_core::parameters::OFFSET;
use fric_core::robot::RobotParams;
use fric_core::signals::{BEFORE_FIRST, Conditioned, RawSignals, SignalLimits, SignalState, condition, next_cycle};
use fric_core::{CableInput, Pose, PoseWrap, Sample, Wrench};
use nalgebra::Vector6;

use super::cable::CableRecord;
use crate::clock::Clock;

/// The reference that a fit compares the model with; it decides what is kept of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// Cable forces measured at the platform (\[P\] 18).
    #[default]
    Forces,
    /// The external wrench on the platform: measured, or else computed from the platform's mass.
    Wrench,
}

impl Reference {
    /// All references.
    pub const ALL: [Self; 2] = [Self::Forces, Self::Wrench];

    /// Returns the name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forces => "forces",
            Self::Wrench => "wrench",
        }
    }
}

/// A zero that may differ from log to log, because the sensors are tared anew for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogZero {
    /// That of the force at the platform, `offset_n`.
    Platform,
    /// That of the force sensor, `sensor_offset.offset_n`.
    Sensor,
}

impl LogZero {
    /// All zeros.
    pub const ALL: [Self; 2] = [Self::Platform, Self::Sensor];

    /// Returns the index of its parameter in [`Values`](fric_core::parameters::Values).
    #[must_use]
    pub const fn place(self) -> usize {
        match self {
            Self::Platform => OFFSET,
            Self::Sensor => sensor_offset::OFFSET,
        }
    }

    /// Returns the derivative of a force with respect to the zero, from its derivatives behind those with respect to free parameters.
    #[inline]
    pub(crate) fn lever(self, behind_free: &[f64]) -> f64 {
        match self {
            Self::Platform => 1.0,
            Self::Sensor => behind_free.first().copied().unwrap_or(0.0),
        }
    }
}

/// How a fit treats a zero that each log has of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PerLog {
    pub zero: LogZero,
    /// Whether each log's zero has a column of its own in the Jacobian, instead of being eliminated.
    pub in_columns: bool,
}

/// One cycle of one cable.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Signals as the friction model uses them; the length is NaN before the first one.
    pub signals: Conditioned<f64>,
    /// Wrap of the pulley that follows the pose.
    pub pose_wrap: PoseWrap,
    /// Whether a cable that needs a pose has no usable one.
    pub pose_fault: bool,
    /// Cycles since the first one of its log.
    pub cycle: f64,
}

/// Count of the plain numbers of a row with its reference.
pub(crate) const ROW_WIDTH: usize = 9;

impl Row {
    /// Returns the row as plain numbers with the same bits, together with the reference and another fact about its cycle: eight numbers, and one with a
    /// bit for each fact.
    pub(crate) fn to_numbers(self, reference_n: f64, fact: bool) -> [f64; ROW_WIDTH] {
        let Self { signals, pose_wrap, pose_fault, cycle } = self;
        let Conditioned {
            sensor_force_n,
            displacement_m,
            speed_m_per_s,
            length_m,
            sensor_finite,
            frozen,
            jump,
            motion_finite,
        } = signals;
        let PoseWrap { wrap_factor, traction_ratio } = pose_wrap;
        let facts = [sensor_finite, frozen, jump, motion_finite, pose_fault, fact];
        let bits = facts.iter().rev().fold(0_u8, |bits, fact| 2 * bits + u8::from(*fact));
        let signals = [sensor_force_n, displacement_m, speed_m_per_s, length_m];
        let [force, displacement, speed, length] = signals;
        [force, displacement, speed, length, wrap_factor, traction_ratio, reference_n, cycle, f64::from(bits)]
    }

    /// Restores a row, the reference and the other fact from the plain numbers.
    pub(crate) fn from_numbers(numbers: &[f64; ROW_WIDTH]) -> (Self, f64, bool) {
        let [
            sensor_force_n,
            displacement_m,
            speed_m_per_s,
            length_m,
            wrap_factor,
            traction_ratio,
            reference_n,
            cycle,
            bits,
        ] = *numbers;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "six bits")]
        let bits = bits as u8;
        let [sensor_finite, frozen, jump, motion_finite, pose_fault, fact] =
            [0, 1, 2, 3, 4, 5].map(|bit| bits >> bit & 1 == 1);
        let signals = Conditioned {
            sensor_force_n,
            displacement_m,
            speed_m_per_s,
            length_m,
            sensor_finite,
            frozen,
            jump,
            motion_finite,
        };
        let pose_wrap = PoseWrap { wrap_factor, traction_ratio };
        (Self { signals, pose_wrap, pose_fault, cycle }, reference_n, fact)
    }

    /// Whether a fit can use the cycle: no fault of sensor, motion or pose, and tension on the cable.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        !self.signals.hold() && !self.pose_fault && self.signals.sensor_force_n > 0.0
    }
}

/// The platform over all cycles.
#[derive(Clone, Debug, Default)]
pub struct PlatformRecord {
    /// Columns of the structure matrix, all cables of a cycle one after the other; NaN without a usable pose.
    pub structure: Vec<Vector6<f64>>,
    /// Pose of each cycle.
    pub poses: Vec<Option<Pose>>,
    /// Measured external wrench of each cycle.
    pub wrenches: Vec<Option<Wrench>>,
}

/// The rows of a cable, and its references in the same cycles, N. Copies share them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples {
    pub rows: Arc<Vec<Row>>,
    pub references_n: Arc<Vec<f64>>,
}

impl Samples {
    /// Adds a cycle.
    fn push(&mut self, row: Row, reference_n: f64) {
        Arc::make_mut(&mut self.rows).push(row);
        Arc::make_mut(&mut self.references_n).push(reference_n);
    }
}

/// The samples of one or several logs of a robot, in memory: of all its cables, or of those that a
/// [`SampleStore`](super::store::SampleStore) has loaded.
#[derive(Clone, Debug)]
pub struct Measurements<'a> {
    robot: RobotParams<'a>,
    reference: Reference,
    /// The cables whose rows are here.
    pub(super) held: Range<usize>,
    /// The samples of the cables that are here.
    pub(super) samples: Vec<Samples>,
    platform: PlatformRecord,
    per_log: Option<LogZero>,
    /// Play to either side within which a change of the measured length counts as noise, m.
    length_play_m: f64,
    starts: Vec<usize>,
    times_s: Arc<Vec<f64>>,
    log_start: LogStart,
    clock: Clock,
    cycle: f64,
    signals: Vec<SignalState<f64>>,
    pose_wraps: Vec<PoseWrap>,
}

/// The start of the present log's time.
#[derive(Clone, Copy, Debug, Default)]
struct LogStart {
    first_nanos: Option<i64>,
    time_s: f64,
}

impl<'a> Measurements<'a> {
    /// Creates empty measurements for a robot.
    #[must_use]
    pub fn new(robot: &RobotParams<'a>, reference: Reference) -> Self {
        let count = robot.cables().len();
        Self {
            robot: *robot,
            reference,
            held: 0..count,
            samples: vec![Samples::default(); count],
            platform: PlatformRecord::default(),
            per_log: None,
            length_play_m: robot.monitor().length_noise_m,
            starts: Vec::new(),
            times_s: Arc::default(),
            log_start: LogStart::default(),
            clock: Clock::new(robot.cycle_s()),
            cycle: BEFORE_FIRST,
            signals: vec![SignalState::start(); count],
            pose_wraps: vec![PoseWrap::START; count],
        }
    }

    /// Lets each log have a zero of its own, in all fits to forces.
    #[must_use]
    pub fn with_zero_per_log(self, zero: Option<LogZero>) -> Self {
        Self { per_log: zero, ..self }
    }

    /// Starts another log: the memory of a cable does not carry over.
    pub fn start_log(&mut self) {
        self.clock = Clock::new(self.robot.cycle_s());
        self.cycle = BEFORE_FIRST;
        self.signals.fill(SignalState::start());
        self.pose_wraps.fill(PoseWrap::START);
        let time_s = self.times_s.last().map_or(0.0, |last_s| last_s + self.robot.cycle_s());
        self.log_start = LogStart { first_nanos: None, time_s };
        if self.starts.last() != Some(&self.len()) {
            self.starts.push(self.len());
        }
    }

    /// Adds the next sample of the log.
    pub fn add(&mut self, sample: &Sample<'_>) {
        if self.starts.is_empty() {
            self.start_log();
        }
        let elapsed_cycles = self.clock.elapsed_cycles(sample.stamp_nanos);
        let first_nanos = *self.log_start.first_nanos.get_or_insert(sample.stamp_nanos);
        #[expect(clippy::cast_precision_loss, reason = "a duration")]
        let since_start_s = sample.stamp_nanos.saturating_sub(first_nanos) as f64 * 1e-9;
        Arc::make_mut(&mut self.times_s).push(self.log_start.time_s + since_start_s);
        self.cycle = next_cycle(self.cycle, elapsed_cycles);
        let pose = sample.pose.filter(Pose::is_usable);
        let limits = self.robot.monitor().limits();
        let states = self.signals.iter_mut().zip(&mut self.pose_wraps);
        let cables = self.robot.cables().iter().zip(&mut self.samples).zip(states);
        for (index, ((params, samples), (state, wrap))) in cables.enumerate() {
            let input = sample.cables.get(index).copied().unwrap_or(NOTHING);
            let CableInput { sensor_force_n, length_m, speed_m_per_s } = input;
            let raw = RawSignals { sensor_force_n, length_m, speed_m_per_s };
            let mut signals = condition(&limits, state, &raw, elapsed_cycles);
            if signals.length_m >= UNKNOWN {
                signals.length_m = f64::NAN;
            }
            let pose_wrap = pose.as_ref().and_then(|pose| PoseWrap::at(params, pose));
            *wrap = pose_wrap.unwrap_or(*wrap);
            let reference_n = sample.reference_force_n.get(index).copied().unwrap_or(f64::NAN);
            let pose_fault = params.needs_pose() && pose_wrap.is_none();
            samples.push(Row { signals, pose_wrap: *wrap, pose_fault, cycle: self.cycle }, reference_n);
            if self.reference == Reference::Wrench {
                let column = pose.as_ref().and_then(|pose| params.structure_column(pose));
                self.platform.structure.push(column.unwrap_or_else(|| Vector6::repeat(f64::NAN)));
            }
        }
        if self.reference == Reference::Wrench {
            self.platform.poses.push(pose);
            self.platform.wrenches.push(sample.outside_wrench);
        }
    }

    /// Returns the robot.
    #[must_use]
    pub fn robot(&self) -> &RobotParams<'a> {
        &self.robot
    }

    /// Returns the reference that is kept.
    #[must_use]
    pub fn reference(&self) -> Reference {
        self.reference
    }

    /// Returns the same measurements with these samples of some cables alone.
    pub(crate) fn holding(&self, held: Range<usize>, samples: Vec<Samples>) -> Self {
        Self {
            held,
            samples,
            platform: PlatformRecord::default(),
            starts: self.starts.clone(),
            times_s: Arc::clone(&self.times_s),
            clock: self.clock.clone(),
            signals: self.signals.clone(),
            pose_wraps: self.pose_wraps.clone(),
            ..*self
        }
    }

    /// Returns the same measurements with other rows for some of the cables that are here.
    pub(crate) fn with_rows(&self, rows: Vec<Option<Vec<Row>>>) -> Self {
        let mut samples = self.samples.clone();
        for (of_cable, rows) in samples.iter_mut().zip(rows) {
            of_cable.rows = rows.map_or_else(|| Arc::clone(&of_cable.rows), Arc::new);
        }
        Self { samples, ..self.clone() }
    }

    /// Returns the same measurements with other references for some of the cables that are here.
    pub(crate) fn with_references(&self, references_n: Vec<Option<Vec<f64>>>) -> Self {
        let mut samples = self.samples.clone();
        for (of_cable, references_n) in samples.iter_mut().zip(references_n) {
            of_cable.references_n = references_n.map_or_else(|| Arc::clone(&of_cable.references_n), Arc::new);
        }
        Self { samples, ..self.clone() }
    }

    /// Returns the same measurements with another wrench in each sample.
    pub(crate) fn with_wrenches(self, wrenches: Vec<Option<Wrench>>) -> Self {
        Self { platform: PlatformRecord { wrenches, ..self.platform }, ..self }
    }

    /// Returns the same measurements, conditioned again with other limits and thus with another play of the length.
    pub(crate) fn conditioned(&self, limits: &SignalLimits) -> Self {
        let rows = self.cables().map(|record| Some(record.conditioned(limits))).collect();
        Self { length_play_m: limits.length_noise_m, ..self.with_rows(rows) }
    }

    /// Returns the time of each sample, s since the first one.
    pub(crate) fn times_s(&self) -> Arc<Vec<f64>> {
        Arc::clone(&self.times_s)
    }

    /// Returns the number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// Whether there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the start of each log, s. Several logs follow one another.
    #[must_use]
    pub fn log_starts_s(&self) -> Vec<f64> {
        self.starts.iter().map(|start| self.times_s.get(*start).copied().unwrap_or(0.0)).collect()
    }

    /// Returns a cable's parameters and cycles; `None` past the robot's cables, and for a cable that is not here.
    #[must_use]
    pub fn cable(&self, index: usize) -> Option<CableRecord<'_>> {
        let params = self.robot.cables().get(index)?;
        let Samples { rows, references_n } = self.samples.get(index.checked_sub(self.held.start)?)?;
        let (starts, times_s) = (self.starts.as_slice(), self.times_s.as_slice());
        let reference_is_known = self.robot.known_reference().is_some();
        let cycle_s = self.robot.cycle_s();
        let interval_s = usual_interval_s(times_s).unwrap_or(cycle_s);
        let per_log = self.per_log.map(|zero| PerLog { zero, in_columns: false });
        Some(CableRecord {
            params,
            rows,
            references_n,
            starts,
            times_s,
            cycle_s,
            interval_s,
            reference_is_known,
            length_play_m: self.length_play_m,
            per_log,
            noise_reach: 1,
            added_noise: None,
        })
    }

    /// Returns all cables that are here, in order.
    pub fn cables(&self) -> impl Iterator<Item = CableRecord<'_>> {
        self.held.clone().filter_map(|index| self.cable(index))
    }

    /// Returns the index of each cable that is here.
    pub(crate) fn held(&self) -> Range<usize> {
        self.held.clone()
    }

    /// Returns the platform; empty unless the reference is the wrench.
    pub(crate) fn platform(&self) -> &PlatformRecord {
        &self.platform
    }

    /// Returns the pose of each sample; empty unless the reference is the wrench.
    pub(crate) fn poses(&self) -> &[Option<Pose>] {
        &self.platform.poses
    }

    /// Returns the columns of the structure matrix, all cables of a sample one after the other; empty unless the reference is the wrench.
    pub(crate) fn structure(&self) -> &[Vector6<f64>] {
        &self.platform.structure
    }
}

const NOTHING: CableInput = CableInput { sensor_force_n: f64::NAN, length_m: f64::NAN, speed_m_per_s: f64::NAN };

/// Returns the median time between two samples, s; `None` for fewer than two, or if most have the stamp of the one before.
fn usual_interval_s(times_s: &[f64]) -> Option<f64> {
    let mut intervals: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = intervals.len() / 2;
    let median = (!intervals.is_empty()).then(|| *intervals.select_nth_unstable_by(middle, f64::total_cmp).1);
    median.filter(|interval_s| *interval_s > 0.0)
}
