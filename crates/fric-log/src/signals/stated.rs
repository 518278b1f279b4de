//! Signals that the robot file states in place of measured ones, for samples that are no log's.

use fric_core::Sample;

use super::SignalPaths;
use super::hanging::HangingRows;
use super::lengths::{LengthPoses, PosesFromLengths};
use super::speed::SpeedRows;
use super::waiting::Row;

/// Completes samples as [`SignalReader`](super::SignalReader) does for a log: with a known reference, and with the pose and the
/// speeds from the lengths.
#[derive(Debug)]
pub struct StatedSignals {
    constant_n: Option<f64>,
    speed_is_from_lengths: bool,
    /// The rows that wait for their speeds, from the first row on.
    speeds: Option<SpeedRows>,
    hanging: Option<HangingRows>,
    poses: Option<PosesFromLengths>,
    /// The row that waits for no other.
    row: Option<Row>,
    /// The row that was lent last.
    lent: Row,
}

impl StatedSignals {
    /// Returns what completes samples; `None` if all signals are measured.
    #[must_use]
    pub fn of(paths: &SignalPaths) -> Option<Self> {
        let stated = Self {
            constant_n: paths.constant_reference_n(),
            speed_is_from_lengths: paths.speed_is_from_lengths(),
            speeds: None,
            hanging: HangingRows::of(paths),
            poses: PosesFromLengths::of(paths),
            row: None,
            lent: Row::default(),
        };
        let has_reference = stated.constant_n.is_some() || stated.hanging.is_some();
        (has_reference || stated.speed_is_from_lengths || stated.poses.is_some()).then_some(stated)
    }

    /// Adds the next sample. Take what [`next_sample`](Self::next_sample) has before adding another one.
    pub fn push(&mut self, sample: &Sample<'_>) {
        let mut row = Row::of(sample);
        if let Some(constant_n) = self.constant_n {
            row.set_reference(constant_n);
        }
        if self.speed_is_from_lengths {
            row.cables.iter_mut().for_each(|input| input.speed_m_per_s = f64::NAN);
            self.speeds.get_or_insert_with(|| SpeedRows::new(row.cables.len())).push(row);
        } else {
            self.push_with_speeds(row);
        }
    }

    fn push_with_speeds(&mut self, row: Row) {
        match &mut self.hanging {
            Some(hanging) => hanging.push(row),
            None => self.row = Some(row),
        }
    }

    /// Marks the end: no sample follows.
    pub fn end(&mut self) {
        match &mut self.speeds {
            Some(speeds) => speeds.end(),
            None => self.hanging.iter_mut().for_each(HangingRows::end),
        }
    }

    /// Passes on rows that have got their speeds, until the next sample is complete.
    fn take_speeds(&mut self) {
        while self.row.is_none() && self.hanging.as_ref().is_none_or(|hanging| !hanging.is_ready()) {
            let Some(speeds) = self.speeds.as_mut().filter(|speeds| speeds.is_ready()) else { return };
            let Some(row) = speeds.pop() else { return self.hanging.iter_mut().for_each(HangingRows::end) };
            self.push_with_speeds(row);
        }
    }

    /// Returns the next complete sample; `None` if it waits for others.
    pub fn next_sample(&mut self) -> Option<Sample<'_>> {
        self.take_speeds();
        let sample = if let Some(hanging) = &mut self.hanging {
            hanging.is_ready().then(|| hanging.pop()).flatten()?
        } else {
            self.lent = self.row.take()?;
            self.lent.sample()
        };
        Some(match &mut self.poses {
            Some(poses) => Sample { pose: poses.next_pose(sample.cables, true), ..sample },
            None => sample,
        })
    }

    /// Returns the statistics of the poses from the lengths; `None` if the pose is measured.
    #[must_use]
    pub fn length_poses(&self) -> Option<LengthPoses> {
        self.poses.as_ref().map(|poses| poses.summary)
    }
}
