//! The delivered row: the signals of one time, combined from the tracks.

use fric_core::{Pose, Wrench};

use super::track::{Around, Track, Tracked};
use super::waiting::Row;
use super::{Role, SignalPaths};

/// The delivered row, with the buffers for the next one.
#[derive(Debug)]
pub(super) struct RowBuffer {
    pub row: Row,
    has_length_path: bool,
    has_speed_path: bool,
    speed_is_from_lengths: bool,
    /// The constant reference of every cable, if there is one.
    constant_n: Option<f64>,
    /// Buffer for lengths and speeds with their own topics.
    numbers: Vec<f64>,
    poses: [KnownPose; 2],
}

/// The pose of a sample of the pose track; number 0 means no sample.
#[derive(Debug, Clone, Copy, Default)]
struct KnownPose {
    number: u64,
    pose: Option<Pose>,
}

impl RowBuffer {
    pub fn new(cable_count: usize, paths: &SignalPaths) -> Self {
        Self {
            row: Row::new(cable_count),
            has_length_path: paths.get(Role::Length).is_some(),
            has_speed_path: paths.get(Role::Speed).is_some(),
            speed_is_from_lengths: paths.speed_is_from_lengths(),
            constant_n: paths.constant_reference_n(),
            numbers: vec![f64::NAN; cable_count],
            poses: [KnownPose::default(); 2],
        }
    }

    /// Whether missing speeds are derived from the lengths.
    pub fn derives_speed(&self) -> bool {
        !self.has_speed_path
    }

    /// Fills the row of a cable sample; `others` are the tracks of the other roles, advanced to its time.
    pub fn fill(&mut self, sample: &Tracked, others: &[Track; 5]) {
        let [length, speed, reference, pose, wrench] = others;
        self.row.stamp_nanos = sample.stamp_nanos;
        self.fill_cables(sample, length, speed);
        interpolate(reference, self.row.stamp_nanos, &mut self.row.reference_force_n);
        if let Some(constant_n) = self.constant_n {
            self.row.set_reference(constant_n);
        }
        self.row.pose = pose.around(self.row.stamp_nanos).and_then(|around| self.pose_at(&around));
        self.row.outside_wrench = wrench.around(self.row.stamp_nanos).map(|around| {
            let mut parts = [f64::NAN; 6];
            around.interpolate(&mut parts);
            let [fx, fy, fz, tx, ty, tz] = parts;
            Wrench { force_n: [fx, fy, fz].into(), torque_nm: [tx, ty, tz].into() }
        });
    }

    fn fill_cables(&mut self, sample: &Tracked, length: &Track, speed: &Track) {
        let stamp_nanos = self.row.stamp_nanos;
        let mut blocks = sample.values.chunks_exact(self.row.cables.len().max(1));
        for (cable, force_n) in self.row.cables.iter_mut().zip(blocks.next().unwrap_or_default()) {
            cable.sensor_force_n = *force_n;
        }
        let mut lengths_m = blocks.next().unwrap_or_default();
        if self.has_length_path {
            interpolate(length, stamp_nanos, &mut self.numbers);
            lengths_m = &self.numbers;
        }
        for (cable, length_m) in self.row.cables.iter_mut().zip(lengths_m) {
            cable.length_m = *length_m;
        }
        let mut speeds = blocks.next().filter(|_| !self.speed_is_from_lengths);
        if self.has_speed_path {
            interpolate(speed, stamp_nanos, &mut self.numbers);
            speeds = Some(&self.numbers);
        }
        let speeds = speeds.unwrap_or_default().iter().copied().chain(std::iter::repeat(f64::NAN));
        for (cable, speed_m_per_s) in self.row.cables.iter_mut().zip(speeds) {
            cable.speed_m_per_s = speed_m_per_s;
        }
    }

    fn pose_at(&mut self, around: &Around<'_>) -> Option<Pose> {
        let before = self.pose_of(around.before)?;
        if around.ratio == 0.0 {
            return Some(before);
        }
        Some(before.interpolate(&self.pose_of(around.after)?, around.ratio))
    }

    /// Returns the pose of a sample, normalised once, because rows are often more frequent than poses.
    fn pose_of(&mut self, sample: &Tracked) -> Option<Pose> {
        let [older, newer] = &mut self.poses;
        if newer.number == sample.number {
            return newer.pose;
        }
        if older.number == sample.number {
            return older.pose;
        }
        let pose = match *sample.values {
            [x, y, z, qx, qy, qz, qw] => Pose::from_parts([x, y, z], [qx, qy, qz, qw]),
            _ => None,
        };
        *older = std::mem::replace(newer, KnownPose { number: sample.number, pose });
        pose
    }
}

/// Returns the values of a track at a time, NaN if there are none.
fn interpolate(track: &Track, stamp_nanos: i64, out: &mut [f64]) {
    match track.around(stamp_nanos) {
        Some(around) => around.interpolate(out),
        None => out.fill(f64::NAN),
    }
}
