//! The hysteresis for machines, and as table II of \[P\].

use fric_core::robot::file::RobotFile;
use serde::Serialize;

use super::{AxisHysteresis, CrossedPose, Width};
use crate::axis::CartesianAxis;
use crate::text::{table, to_millimetre, wrapped};

/// `fric-hysteresis/1`.
#[derive(Clone, Debug, Serialize)]
pub struct HysteresisResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Name of the robot.
    pub robot: String,
    /// All axes: x, y, z, a, b, c.
    pub axes: Vec<AxisResult>,
    /// The crossed position, m.
    #[serde(skip)]
    pub position_m: [f64; 3],
}

/// One axis. An axis that is not crossed has 0 passes and no widths; one whose width without compensation is not significant has no ratio.
#[derive(Clone, Debug, Serialize)]
pub struct AxisResult {
    /// Its name.
    pub axis: &'static str,
    /// Unit of the widths.
    pub unit: &'static str,
    /// Number of passes in both directions together.
    pub passes: u64,
    /// Width from frictionless forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without: Option<WidthResult>,
    /// Width from compensated forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with: Option<WidthResult>,
    /// Width with compensation divided by the width without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lasting_ratio: Option<f64>,
    /// Whether the log's external wrench was subtracted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub applied_subtracted: Option<bool>,
}

/// Width of a hysteresis.
#[derive(Clone, Debug, Serialize)]
pub struct WidthResult {
    /// Difference of the means in both directions.
    pub width: f64,
    /// Its standard error; none if a direction has a single pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
}

impl HysteresisResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-hysteresis/1";

    /// Creates the result from the axes that a robot has crossed.
    #[must_use]
    pub fn new(robot: &RobotFile, crossed: &CrossedPose, axes: &[AxisHysteresis]) -> Self {
        Self {
            format: Self::FORMAT,
            robot: robot.options().name.clone(),
            axes: CartesianAxis::ALL.map(|axis| axis_result(axis, axes)).into(),
            position_m: crossed.pose().position_m.into(),
        }
    }

    /// Returns a summary for people.
    #[must_use]
    pub fn summary(&self) -> String {
        describe(self)
    }
}

fn axis_result(axis: CartesianAxis, all: &[AxisHysteresis]) -> AxisResult {
    let found = all.iter().find(|found| found.axis == axis);
    let width = |Width { width, standard_error }: Width| WidthResult { width, standard_error };
    AxisResult {
        axis: axis.name(),
        unit: axis.wrench_unit(),
        passes: found.map_or(0, |found| found.pass_count),
        without: found.map(|found| width(found.without)),
        with: found.map(|found| width(found.with)),
        lasting_ratio: found.and_then(AxisHysteresis::lasting_ratio),
        applied_subtracted: found.map(|found| found.is_applied_subtracted),
    }
}

/// Formats the result as a table, like table II of \[P\].
fn describe(result: &HysteresisResult) -> String {
    let [x_m, y_m, z_m] = result.position_m.map(to_millimetre);
    let rows: Vec<_> = result
        .axes
        .iter()
        .map(|axis| {
            let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
            let (without, with) = (axis.without.as_ref(), axis.with.as_ref());
            [
                format!("{} [{}]", axis.axis, axis.unit),
                axis.passes.to_string(),
                number(without.map(|width| width.width)),
                number(without.and_then(|width| width.standard_error)),
                number(with.map(|width| width.width)),
                number(with.and_then(|width| width.standard_error)),
                axis.lasting_ratio.map_or_else(|| "–".to_owned(), |ratio| format!("{:.1} %", ratio * 100.0)),
            ]
        })
        .collect();
    let mut text =
        format!("{}: width of the wrench's hysteresis at ({x_m:.3}, {y_m:.3}, {z_m:.3}) m\n\n", result.robot);
    text += &table(&["axis", "passes", "without\ncompensation", "±", "with\ncompensation", "±", "left"], 1, &rows);
    text += "\n";
    let named = |wanted: fn(&AxisResult) -> bool| {
        let names: Vec<&str> = result.axes.iter().filter(|axis| wanted(axis)).map(|axis| axis.axis).collect();
        Some(names.join(", ")).filter(|names| !names.is_empty())
    };
    if let Some(names) = named(|axis| axis.applied_subtracted == Some(true)) {
        let sentence =
            format!("The log's outside wrench is taken off, so that what is really applied does not count: {names}.");
        text += &wrapped("", &sentence);
    }
    if let Some(names) = named(|axis| axis.applied_subtracted == Some(false)) {
        let sentence =
            format!("The log's outside wrench is not known, so that forces from outside count too: {names}.");
        text += &wrapped("", &sentence);
    }
    if let Some(names) = named(|axis| axis.passes == 0) {
        let sentence = format!(
            "Not crossed: {names}. Record the platform going to and fro across this position along (x, y, z) or about (a, b, c) \
             these axes, several times, with nothing else moving."
        );
        text += &wrapped("", &sentence);
    }
    text
}
