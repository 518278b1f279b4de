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
use fric_core::{CableInput, CableParams, Pose, PoseWrap, Sample, Wrench};
use nalgebra::Vector6;

use super::noise::lasting_white_noise;
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
    /// Cable force measured at the platform, N; NaN if there is none.
    pub reference_n: f64,
    /// Whether a cable that needs a pose has no usable one.
    pub pose_fault: bool,
    /// Cycles since the first one of its log.
    pub cycle: f64,
}

/// Count of the plain numbers of a row.
pub(crate) const ROW_WIDTH: usize = 9;

impl Row {
    /// Returns the row as plain numbers with the same bits, together with another fact about its cycle: eight numbers, and one with a bit for each fact.
    pub(crate) fn to_numbers(self, fact: bool) -> [f64; ROW_WIDTH] {
        let Self { signals, pose_wrap, reference_n, pose_fault, cycle } = self;
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

    /// Restores a row and the other fact from the plain numbers.
    pub(crate) fn from_numbers(numbers: &[f64; ROW_WIDTH]) -> (Self, bool) {
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
        (Self { signals, pose_wrap: PoseWrap { wrap_factor, traction_ratio }, reference_n, pose_fault, cycle }, fact)
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

/// The samples of one or several logs of a robot, in memory: of all its cables, or of those that a
/// [`SampleStore`](super::store::SampleStore) has loaded.
#[derive(Clone, Debug)]
pub struct Measurements<'a> {
    robot: RobotParams<'a>,
    reference: Reference,
    /// The cables whose rows are here.
    pub(super) held: Range<usize>,
    /// The rows of the cables that are here.
    pub(super) rows: Vec<Vec<Row>>,
    platform: PlatformRecord,
    per_log: Option<LogZero>,
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
            rows: vec![Vec::new(); count],
            platform: PlatformRecord::default(),
            per_log: None,
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
        let cables = self.robot.cables().iter().zip(&mut self.rows).zip(states);
        for (index, ((params, rows), (state, wrap))) in cables.enumerate() {
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
            rows.push(Row { signals, pose_wrap: *wrap, reference_n, pose_fault, cycle: self.cycle });
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

    /// Returns the same measurements with these rows of some cables alone.
    pub(crate) fn holding(&self, held: Range<usize>, rows: Vec<Vec<Row>>) -> Self {
        Self {
            held,
            rows,
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
        let rows = self.rows.iter().zip(rows).map(|(given, rows)| rows.unwrap_or_else(|| given.clone()));
        Self { platform: self.platform.clone(), ..self.holding(self.held.clone(), rows.collect()) }
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
        let (params, rows) = (self.robot.cables().get(index)?, self.rows.get(index.checked_sub(self.held.start)?)?);
        let (starts, times_s) = (self.starts.as_slice(), self.times_s.as_slice());
        let reference_is_known = self.robot.known_reference().is_some();
        let cycle_s = self.robot.cycle_s();
        let interval_s = usual_interval_s(times_s).unwrap_or(cycle_s);
        let length_play_m = self.robot.monitor().length_noise_m;
        let per_log = self.per_log.map(|zero| PerLog { zero, in_columns: false });
        Some(CableRecord {
            params,
            rows,
            starts,
            times_s,
            cycle_s,
            interval_s,
            reference_is_known,
            length_play_m,
            per_log,
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

    /// Returns the index of the first sample of each log.
    pub(crate) fn starts(&self) -> &[usize] {
        &self.starts
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

/// Half width of the play that suppresses noise of the length best, as a multiple of the noise's standard deviation. On a log with noise of 3 µm, the
/// rms is 1.42 of its noise with 1σ, 1.03 with 2σ, 1.09 with 3σ, 1.21 with 4σ, and 3.7 without play.
pub const PLAY_OF_NOISE: f64 = 2.0;

/// The cycles of one cable.
#[derive(Clone, Copy, Debug)]
pub struct CableRecord<'a> {
    /// Its given parameters.
    pub params: &'a CableParams,
    /// Its cycles, one log after the other.
    pub rows: &'a [Row],
    pub(crate) starts: &'a [usize],
    pub(crate) times_s: &'a [f64],
    /// Cycle time of the control loop, s.
    pub cycle_s: f64,
    /// Usual time between two samples of the log, s.
    pub interval_s: f64,
    /// Whether the reference is known rather than measured: it may then be constant, and does not count as interpolated.
    pub(crate) reference_is_known: bool,
    /// Play to either side within which a change of the measured length counts as noise, m.
    pub(crate) length_play_m: f64,
    /// The zero that each log has of its own.
    pub(crate) per_log: Option<PerLog>,
}

impl<'a> CableRecord<'a> {
    /// Returns the cycles with the zero of each log changed by so much, N, in the data instead of the parameter: a model with the common zero leaves on
    /// them what it leaves with a zero per log.
    pub(crate) fn with_zeros(&self, changes_n: &[f64]) -> Vec<Row> {
        let mut rows = self.rows.to_vec();
        let Some(PerLog { zero, .. }) = self.per_log else { return rows };
        for ((start, log), change_n) in self.logs().zip(changes_n) {
            for row in rows.iter_mut().skip(start).take(log.len()) {
                match zero {
                    LogZero::Platform => row.reference_n -= change_n,
                    LogZero::Sensor => row.signals.sensor_force_n -= change_n,
                }
            }
        }
        rows
    }

    /// Returns a stretch of its cycles, as a log of its own.
    pub(crate) fn stretch(&self, cycles: &Range<usize>) -> Self {
        let rows = self.rows.get(cycles.clone()).unwrap_or_default();
        Self { rows, starts: &[0], times_s: self.times_s.get(cycles.clone()).unwrap_or_default(), ..*self }
    }

    /// Returns other cycles of the same cable, as one log.
    pub(crate) fn as_one_log<'b>(&self, rows: &'b [Row]) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { rows, starts: &[0], times_s: &[], ..*self }
    }

    /// Returns the same cycles with other start parameters.
    pub(crate) fn with_params<'b>(&self, params: &'b CableParams) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { params, ..*self }
    }

    /// Returns the same cycles with other signals.
    pub(crate) fn with_signals<'b>(&self, rows: &'b [Row]) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { rows, ..*self }
    }

    /// Returns the standard deviation of the white noise of the length, m; `None` if there is no permanent noise, or the cable always moves by more than
    /// its play from sample to sample.
    pub(crate) fn length_noise_m(&self) -> Option<f64> {
        let of_log = |(_, rows): (usize, &[Row])| {
            rows.iter().map(|row| row.signals.length_m).chain([f64::NAN]).collect::<Vec<f64>>()
        };
        lasting_white_noise(&self.logs().flat_map(of_log).collect::<Vec<f64>>(), PLAY_OF_NOISE)
    }

    /// Returns the record with cycles that were conditioned with this play.
    pub(crate) fn behind_play<'b>(&self, rows: &'b [Row], length_play_m: f64) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { rows, length_play_m, ..*self }
    }

    /// Returns its cycles, conditioned again with other limits.
    pub(crate) fn conditioned(&self, limits: &SignalLimits) -> Vec<Row> {
        let mut rows = Vec::with_capacity(self.rows.len());
        for (_, log) in self.logs() {
            let (mut state, mut last) = (SignalState::start(), BEFORE_FIRST);
            for row in log {
                let Conditioned { sensor_force_n, speed_m_per_s, length_m, sensor_finite, motion_finite, .. } =
                    row.signals;
                let known = |is_known: bool, value: f64| if is_known { value } else { f64::NAN };
                let raw = RawSignals {
                    sensor_force_n: known(sensor_finite, sensor_force_n),
                    length_m: known(motion_finite, length_m),
                    speed_m_per_s,
                };
                let signals = condition(limits, &mut state, &raw, row.cycle - last);
                last = row.cycle;
                rows.push(Row {
                    signals: Conditioned { length_m: known(signals.length_m < UNKNOWN, signals.length_m), ..signals },
                    ..*row
                });
            }
        }
        rows
    }

    /// Returns the time of a cycle, s since the first sample. Several logs follow one another.
    #[must_use]
    pub fn time_s(&self, cycle: usize) -> f64 {
        let (past, last_s) = match self.times_s {
            [] => (cycle, 0.0),
            [.., last_s] => (cycle.saturating_sub(self.times_s.len() - 1), *last_s),
        };
        #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
        let without_pause_s = last_s + past as f64 * self.cycle_s;
        self.times_s.get(cycle).copied().unwrap_or(without_pause_s)
    }

    /// Returns the cycles of each log, with the index of the first.
    pub fn logs(&self) -> impl Iterator<Item = (usize, &'a [Row])> {
        let rows = self.rows;
        let ends = self.starts.iter().skip(1).copied().chain([rows.len()]);
        self.starts.iter().zip(ends).filter_map(move |(start, end)| Some((*start, rows.get(*start..end)?)))
    }
}
