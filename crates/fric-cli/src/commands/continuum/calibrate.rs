//! `continuum calibrate`: fits the lines of the gratings to load steps.

use fric_tendon::edit::{ManipulatorEdit, rewrite};
use fric_tendon_lab::fbg::Calibration;
use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::result::CalibrationResult;
use fric_tendon_lab::{columns, load_steps};

use super::{Model, about, read_table};
use crate::arguments::continuum::CalibrateArguments;
use crate::failure::Outcome;
use crate::output::Outputs;
use fric_work::report::continuum;

/// Runs the command.
pub fn run(arguments: &CalibrateArguments) -> Outcome {
    let CalibrateArguments { loads, model, output, page } = arguments;
    Outputs::check(&page.result, &[Some(output), page.report.as_deref()])?;
    let inputs = vec![loads.clone(), model.clone()];
    let model = Model::read(model)?;
    let mut outputs = Outputs::create(&page.result, page.report.as_deref(), inputs)?;
    let file = outputs.file(output)?;
    let table = read_table(loads, &columns::of_calibration(model.disk_count()))?;
    let stated = Gratings::from_file(&model.file)?;
    let wavelengths_nm = stated.as_ref().and_then(Gratings::wavelengths_nm);
    let steps = load_steps(&table, model.file.params(), wavelengths_nm).map_err(|error| about(loads, error))?;
    let lines = Calibration::fit_all(&steps).map_err(|error| about(loads, error))?;
    let result = CalibrationResult::new(model.name(), &steps, &lines);
    let edit = ManipulatorEdit { lines: result.lines(), ..ManipulatorEdit::default() };
    let calibrated = file.complete_with(&rewrite(&model.text, &model.origin, &edit)?)?;
    outputs.add(calibrated, "the manipulator file with the coefficients of its gratings");
    outputs.write_report(|provenance| continuum::calibration(&result, provenance))?;
    outputs.finish(&result, &result.summary(), "")
}
