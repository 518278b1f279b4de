//! The calibration of all gratings, as in figures 4 and 5 of \[C\].

use fric_lab::text::table;
use fric_tendon::edit::GratingLine;
use serde::Serialize;

use crate::fbg::{Calibration, LineError, LoadStep};

/// `fric-continuum-calibrate/1`.
#[derive(Clone, Debug, Serialize)]
pub struct CalibrationResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Name of the manipulator.
    pub manipulator: String,
    /// Loads of the steps, N.
    pub load_n: Vec<f64>,
    /// One entry per grating, starting at the base.
    pub gratings: Vec<GratingResult>,
}

/// One grating: `T = a·Δλ + b`. Ratios are relative to the greatest load.
#[derive(Clone, Debug, Serialize)]
pub struct GratingResult {
    /// Its number, from 1 at the base.
    pub grating: usize,
    /// a, N/nm.
    pub newton_per_nm: f64,
    /// b, N.
    pub offset_n: f64,
    /// Greatest standard error of a tension from one shift within the range of the loads, N.
    pub standard_error_n: f64,
    /// The uncertainty of the line itself.
    #[serde(flatten)]
    pub line_error: LineError,
    /// Residual of each step.
    pub residual_ratio: Vec<f64>,
    /// Error at each step of the line through all others.
    pub left_out_ratio: Vec<f64>,
    /// The largest residual.
    pub largest_residual_ratio: f64,
    /// The largest error at a step of the line through all others.
    pub largest_left_out_ratio: f64,
}

impl CalibrationResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-continuum-calibrate/1";

    /// Creates the result from lines fitted to load steps.
    #[must_use]
    pub fn new(manipulator: &str, steps: &[LoadStep], lines: &[Calibration]) -> Self {
        let grating = |(place, line): (usize, &Calibration)| GratingResult {
            grating: place + 1,
            newton_per_nm: line.newton_per_nm,
            offset_n: line.offset_n,
            standard_error_n: line.largest_standard_error_n(),
            line_error: line.line_error(),
            residual_ratio: line.residual_ratio.clone(),
            left_out_ratio: line.left_out_ratio.clone(),
            largest_residual_ratio: line.largest_residual_ratio(),
            largest_left_out_ratio: line.largest_left_out_ratio(),
        };
        Self {
            format: Self::FORMAT,
            manipulator: manipulator.to_owned(),
            load_n: steps.iter().map(|step| step.load_n).collect(),
            gratings: lines.iter().enumerate().map(grating).collect(),
        }
    }

    /// Returns the line of each grating, for the manipulator file.
    #[must_use]
    pub fn lines(&self) -> Vec<GratingLine> {
        let line = |one: &GratingResult| GratingLine {
            newton_per_nm: one.newton_per_nm,
            offset_n: one.offset_n,
            standard_error_n: one.standard_error_n,
            line_error_n: one.line_error.line_error_n,
            slope_error_n_per_nm: one.line_error.slope_error_n_per_nm,
            mean_shift_nm: one.line_error.mean_shift_nm,
        };
        self.gratings.iter().map(line).collect()
    }

    /// Returns a summary for people.
    #[must_use]
    pub fn summary(&self) -> String {
        let percent = |ratio: f64| format!("{:.2}", 100.0 * ratio);
        let rows: Vec<_> = self
            .gratings
            .iter()
            .map(|one| {
                [
                    one.grating.to_string(),
                    format!("{:.4}", one.newton_per_nm),
                    format!("{:.4}", one.offset_n),
                    format!("{:.4}", one.standard_error_n),
                    percent(one.largest_residual_ratio),
                    percent(one.largest_left_out_ratio),
                ]
            })
            .collect();
        let header = [
            "grating",
            "slope a\n[N/nm]",
            "offset b\n[N]",
            "error of\nT [N]",
            "largest\nresidual [%]",
            "largest error\nleft out [%]",
        ];
        let [least_n, most_n] = self
            .load_n
            .iter()
            .fold([f64::INFINITY, 0.0_f64], |[least, most], load_n| [least.min(*load_n), most.max(*load_n)]);
        format!(
            "{}: {} gratings calibrated with {} loads, {least_n:.3} … {most_n:.3} N\n\n{}\n\
             T = a·Δλ + b, with the standard error of T. Per cent are of the greatest load:\n\
             the largest residual, and the largest error at a load that was left out.\n",
            self.manipulator,
            self.gratings.len(),
            self.load_n.len(),
            table(&header, 0, &rows)
        )
    }
}
