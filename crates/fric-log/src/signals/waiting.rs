//! The signals of one time, as stored while a row waits for later ones.

use fric_core::{CableInput, Pose, Sample, Wrench};

/// A row.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    pub stamp_nanos: i64,
    pub cables: Vec<CableInput>,
    pub reference_force_n: Vec<f64>,
    pub pose: Option<Pose>,
    pub outside_wrench: Option<Wrench>,
}

impl Row {
    pub fn new(cable_count: usize) -> Self {
        Self {
            cables: vec![CableInput::default(); cable_count],
            reference_force_n: vec![f64::NAN; cable_count],
            ..Self::default()
        }
    }

    pub fn of(sample: &Sample<'_>) -> Self {
        Self {
            stamp_nanos: sample.stamp_nanos,
            cables: sample.cables.to_vec(),
            reference_force_n: sample.reference_force_n.to_vec(),
            pose: sample.pose,
            outside_wrench: sample.outside_wrench,
        }
    }

    /// Sets the reference of every cable that has a sensor force.
    pub fn set_reference(&mut self, force_n: f64) {
        for (reference_n, cable) in self.reference_force_n.iter_mut().zip(&self.cables) {
            *reference_n = if cable.sensor_force_n.is_finite() { force_n } else { f64::NAN };
        }
    }

    pub fn sample(&self) -> Sample<'_> {
        Sample {
            stamp_nanos: self.stamp_nanos,
            cables: &self.cables,
            reference_force_n: &self.reference_force_n,
            pose: self.pose,
            outside_wrench: self.outside_wrench,
        }
    }

    /// Whether a cable has a length but no speed.
    pub fn lacks_speed(&self, cable: usize) -> bool {
        self.cables.get(cable).is_some_and(|cable| cable.speed_m_per_s.is_nan() && cable.length_m.is_finite())
    }
}
