//! Samples and outputs of a whole log in memory, one column per quantity.
//!
//! They serve work that needs a whole log at once: arrays for Python, fits. [`SampleColumns`] collects samples, and [`SampleRows`] returns them
//! bit-identically from columns at any place in memory. Rows follow one another, with one number per cable or coordinate; unknown values are NaN.
//! Nothing is checked or computed here, and memory grows with the log.

use std::ops::Range;

use fric_core::{CableInput, CableOutput, Pose, Sample, Wrench};

/// Samples, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampleColumns {
    /// Stamps, ns since 1970.
    pub stamp_nanos: Vec<i64>,
    /// Sensor forces, N. This and the next three columns have one value per cable and row.
    pub sensor_force_n: Vec<f64>,
    /// Cable lengths, m.
    pub length_m: Vec<f64>,
    /// Rates of the lengths, m/s.
    pub speed_m_per_s: Vec<f64>,
    /// Forces measured at the platform, N.
    pub reference_force_n: Vec<f64>,
    /// Positions of the platform, m; three values per row.
    pub position_m: Vec<f64>,
    /// Orientations of the platform as unit quaternions x, y, z, w; four values per row.
    pub orientation_xyzw: Vec<f64>,
    /// External forces on the platform, N; three values per row.
    pub outside_force_n: Vec<f64>,
    /// External torques on the platform, N m; three values per row.
    pub outside_torque_nm: Vec<f64>,
}

impl SampleColumns {
    /// Adds a sample.
    pub fn push(&mut self, sample: &Sample<'_>) {
        self.stamp_nanos.push(sample.stamp_nanos);
        self.sensor_force_n.extend(sample.cables.iter().map(|cable| cable.sensor_force_n));
        self.length_m.extend(sample.cables.iter().map(|cable| cable.length_m));
        self.speed_m_per_s.extend(sample.cables.iter().map(|cable| cable.speed_m_per_s));
        self.reference_force_n.extend_from_slice(sample.reference_force_n);
        let (position_m, orientation_xyzw) = sample
            .pose
            .map_or(([f64::NAN; 3], [f64::NAN; 4]), |pose| (pose.position_m.into(), pose.orientation.coords.into()));
        self.position_m.extend(position_m);
        self.orientation_xyzw.extend(orientation_xyzw);
        let (force_n, torque_nm) = sample
            .outside_wrench
            .map_or(([f64::NAN; 3], [f64::NAN; 3]), |wrench| (wrench.force_n.into(), wrench.torque_nm.into()));
        self.outside_force_n.extend(force_n);
        self.outside_torque_nm.extend(torque_nm);
    }

    /// Returns the times since the first row, s.
    #[must_use]
    pub fn time_s(&self) -> Vec<f64> {
        let start_nanos = self.stamp_nanos.first().copied().unwrap_or_default();
        #[expect(clippy::cast_precision_loss, reason = "exact for 104 days, to the nanosecond for years")]
        let since_start_s = |stamp_nanos: &i64| stamp_nanos.saturating_sub(start_nanos) as f64 / 1e9;
        self.stamp_nanos.iter().map(since_start_s).collect()
    }

    /// Returns the collected samples.
    #[must_use]
    pub fn rows(&self) -> SampleRows<'_> {
        SampleRows {
            stamp_nanos: &self.stamp_nanos,
            sensor_force_n: &self.sensor_force_n,
            length_m: &self.length_m,
            speed_m_per_s: &self.speed_m_per_s,
            reference_force_n: &self.reference_force_n,
            position_m: &self.position_m,
            orientation_xyzw: &self.orientation_xyzw,
            outside_force_n: &self.outside_force_n,
            outside_torque_nm: &self.outside_torque_nm,
        }
    }
}

/// The columns of [`SampleColumns`], borrowed from any place.
#[derive(Clone, Copy, Debug)]
pub struct SampleRows<'a> {
    /// See [`SampleColumns::stamp_nanos`].
    pub stamp_nanos: &'a [i64],
    /// See [`SampleColumns::sensor_force_n`].
    pub sensor_force_n: &'a [f64],
    /// See [`SampleColumns::length_m`].
    pub length_m: &'a [f64],
    /// See [`SampleColumns::speed_m_per_s`].
    pub speed_m_per_s: &'a [f64],
    /// See [`SampleColumns::reference_force_n`].
    pub reference_force_n: &'a [f64],
    /// See [`SampleColumns::position_m`].
    pub position_m: &'a [f64],
    /// See [`SampleColumns::orientation_xyzw`].
    pub orientation_xyzw: &'a [f64],
    /// See [`SampleColumns::outside_force_n`].
    pub outside_force_n: &'a [f64],
    /// See [`SampleColumns::outside_torque_nm`].
    pub outside_torque_nm: &'a [f64],
}

impl<'a> SampleRows<'a> {
    /// Returns the number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.stamp_nanos.len()
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.stamp_nanos.is_empty()
    }

    /// Copies the rows of a range, which must be within bounds.
    #[must_use]
    pub fn copied(&self, rows: Range<usize>) -> SampleColumns {
        let row_count = self.stamp_nanos.len().max(1);
        let of = |column: &[f64]| {
            let width = column.len() / row_count;
            column.get(rows.start * width..rows.end * width).unwrap_or_default().to_vec()
        };
        SampleColumns {
            stamp_nanos: self.stamp_nanos.get(rows.clone()).unwrap_or_default().to_vec(),
            sensor_force_n: of(self.sensor_force_n),
            length_m: of(self.length_m),
            speed_m_per_s: of(self.speed_m_per_s),
            reference_force_n: of(self.reference_force_n),
            position_m: of(self.position_m),
            orientation_xyzw: of(self.orientation_xyzw),
            outside_force_n: of(self.outside_force_n),
            outside_torque_nm: of(self.outside_torque_nm),
        }
    }

    /// Returns the sample of a row; `cables` is a buffer for its signals. Returns `None` past the last row.
    pub fn sample<'b>(&self, row: usize, cables: &'b mut Vec<CableInput>) -> Option<Sample<'b>>
    where
        'a: 'b,
    {
        let stamp_nanos = *self.stamp_nanos.get(row)?;
        let cable_count = self.sensor_force_n.len() / self.stamp_nanos.len();
        let signals = part(self.sensor_force_n, row, cable_count)
            .iter()
            .zip(part(self.length_m, row, cable_count))
            .zip(part(self.speed_m_per_s, row, cable_count));
        cables.clear();
        cables.extend(signals.map(|((sensor_force_n, length_m), speed_m_per_s)| CableInput {
            sensor_force_n: *sensor_force_n,
            length_m: *length_m,
            speed_m_per_s: *speed_m_per_s,
        }));
        Some(Sample {
            stamp_nanos,
            cables,
            reference_force_n: part(self.reference_force_n, row, cable_count),
            pose: pose(part(self.position_m, row, 3), part(self.orientation_xyzw, row, 4)),
            outside_wrench: wrench(part(self.outside_force_n, row, 3), part(self.outside_torque_nm, row, 3)),
        })
    }
}

fn part(column: &[f64], row: usize, width: usize) -> &[f64] {
    column.get(row * width..(row + 1) * width).unwrap_or_default()
}

fn pose(position_m: &[f64], orientation_xyzw: &[f64]) -> Option<Pose> {
    Pose::from_parts(position_m.try_into().ok()?, orientation_xyzw.try_into().ok()?)
}

fn wrench(force_n: &[f64], torque_nm: &[f64]) -> Option<Wrench> {
    let [force, torque]: [[f64; 3]; 2] = [force_n.try_into().ok()?, torque_nm.try_into().ok()?];
    let is_known = force.iter().chain(&torque).any(|number| !number.is_nan());
    is_known.then(|| Wrench { force_n: force.into(), torque_nm: torque.into() })
}

/// Outputs of cycles, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputColumns {
    /// Forces at the platform, N. This and the next three columns have one value per cable and row.
    pub force_at_platform_n: Vec<f64>,
    /// Estimated friction, N.
    pub friction_n: Vec<f64>,
    /// Tensions computed from the sensor forces without friction, N.
    pub frictionless_n: Vec<f64>,
    /// Bits of [`CableStatus`](fric_core::CableStatus).
    pub status: Vec<u32>,
    /// External wrenches, force in N and torque in N m; six values per row.
    pub outside_wrench: Vec<f64>,
}

impl OutputColumns {
    /// Adds the output of a cycle.
    pub fn push(&mut self, cables: &[CableOutput], outside_wrench: Option<&Wrench>) {
        self.force_at_platform_n.extend(cables.iter().map(|cable| cable.force_at_platform_n));
        self.friction_n.extend(cables.iter().map(|cable| cable.friction_n));
        self.frictionless_n.extend(cables.iter().map(|cable| cable.frictionless_n));
        self.status.extend(cables.iter().map(|cable| cable.status.bits()));
        let parts = outside_wrench.map_or([f64::NAN; 6], |wrench| {
            let ([fx, fy, fz], [tx, ty, tz]): ([f64; 3], [f64; 3]) = (wrench.force_n.into(), wrench.torque_nm.into());
            [fx, fy, fz, tx, ty, tz]
        });
        self.outside_wrench.extend(parts);
    }

    /// Whether any cycle had a wrench.
    #[must_use]
    pub fn has_wrench(&self) -> bool {
        self.outside_wrench.iter().any(|number| !number.is_nan())
    }
}
