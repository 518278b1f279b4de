//! The result of an identification: for machines, and as the tables of \[P\].

use std::fmt::Write as _;

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS};
use fric_core::robot::file::RobotFile;
use fric_lab::fit::{CableFit, Parameter, WrenchFit};
use fric_lab::replay::WrenchErrors;

use crate::commands::fit::Fits;
use crate::output::table;
use crate::result::{FitCableResult, FitResult, LeftOut, Numbers, WrenchError, WrenchResult, force_error};

/// The result for machines.
pub fn result(robot: &RobotFile, fits: &Fits) -> FitResult {
    let cables = robot.cable_names().into_iter().zip(fits.cables());
    let (reference, wrench) = match fits {
        Fits::Forces(_) => ("forces", None),
        Fits::Wrench(WrenchFit { measured, before, after, .. }) => {
            (if *measured { "wrench" } else { "mass" }, wrench_result(before, after))
        }
    };
    FitResult {
        format: FitResult::FORMAT,
        robot: robot.options().name.clone(),
        reference,
        cables: cables.map(|(name, fit)| cable_result(name, fit)).collect(),
        wrench,
    }
}

fn wrench_result(before: &WrenchErrors, after: &WrenchErrors) -> Option<WrenchResult> {
    let error = |(force_rms_n, torque_rms_nm)| WrenchError { force_rms_n, torque_rms_nm };
    Some(WrenchResult { before: error(before.rms()?), after: error(after.rms()?) })
}

fn cable_result(name: &str, fit: &CableFit) -> FitCableResult {
    let shown = |parameter: &Parameter| {
        let value = fit.values[parameter.place()];
        let relevant =
            parameter.is_friction() || fit.fitted.contains(parameter) || fit.undetermined.contains(parameter);
        (relevant && value < NO_PRESLIDING_N_PER_M).then(|| (parameter.to_string(), value))
    };
    let error = |parameter: &Parameter| Some((parameter.to_string(), fit.standard_error(parameter)?));
    let samples = fit.samples;
    FitCableResult {
        name: name.to_owned(),
        samples: samples.used,
        left_out: LeftOut {
            flagged: samples.flagged,
            without_reference: samples.without_reference,
            warm_up: samples.warm_up,
            outliers: samples.outliers,
        },
        termination: fit.termination.name(),
        evaluations: fit.evaluation_count,
        parameters: Numbers(Parameter::all().filter_map(|parameter| shown(&parameter)).collect()),
        standard_errors: Numbers(Parameter::all().filter_map(|parameter| error(&parameter)).collect()),
        undetermined: fit.undetermined.iter().map(ToString::to_string).collect(),
        before: force_error(&fit.errors.before_n),
        after: force_error(&fit.errors.after_n),
        mean_reference_n: fit.errors.reference_n.mean_magnitude(),
    }
}

/// The result for people: \[P\] table I, how sure it is, and what the log does not tell.
pub fn describe(result: &FitResult) -> String {
    let mut text = match result.reference {
        "forces" => format!("{}: identified from the forces at the platform\n\n", result.robot),
        "wrench" => format!("{}: identified from the outside wrench, all cables at once\n\n", result.robot),
        _ => format!("{}: identified from the platform's mass and pose, all cables at once\n\n", result.robot),
    };
    text += &paper_table(result);
    text += "\nstandard errors\n\n";
    text += &error_table(result);
    if let Some(WrenchResult { before, after }) = &result.wrench {
        let _ = writeln!(
            text,
            "\nwrench rms: {:.4} N and {:.4} Nm before, {:.4} N and {:.4} Nm after",
            before.force_rms_n, before.torque_rms_nm, after.force_rms_n, after.torque_rms_nm
        );
    }
    text += &undetermined(result);
    text
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
}

/// The number of a parameter by its place.
fn value_of(numbers: &Numbers, place: usize) -> Option<f64> {
    numbers.get(&Parameter::all().nth(place)?.to_string())
}

/// A column of a table: header, digits, value.
type Column = (&'static str, usize, fn(&FitCableResult) -> Option<f64>);

/// Columns of \[P\] table I, with ε and the root mean square beside them; those that nothing is known of are left out.
fn paper_table(result: &FitResult) -> String {
    let all: [Column; 8] = [
        ("μ", 5, |cable| value_of(&cable.parameters, MU)),
        ("σ [N/mm]", 4, |cable| Some(value_of(&cable.parameters, SIGMA)? * 1e-3)),
        ("F_pv [Ns/m]", 4, |cable| value_of(&cable.parameters, VISCOUS)),
        ("ε [N]", 4, |cable| value_of(&cable.parameters, OFFSET)),
        ("|F_ref − F_s| [N]", 4, |cable| Some(cable.before.as_ref()?.mae_n)),
        ("|F_ref − F_s − F_d| [N]", 4, |cable| Some(cable.after.as_ref()?.mae_n)),
        ("F_ref [N]", 2, |cable| cable.mean_reference_n),
        ("rms after [N]", 4, |cable| Some(cable.after.as_ref()?.rms_n)),
    ];
    let known = |(.., value): &&Column| result.cables.iter().any(|cable| value(cable).is_some());
    let columns: Vec<&Column> = all.iter().filter(known).collect();
    let mut rows: Vec<Vec<String>> = Vec::new();
    for cable in &result.cables {
        let cells = columns.iter().map(|(_, digits, value)| number(value(cable), *digits));
        rows.push(std::iter::once(cable.name.clone()).chain(cells).collect());
    }
    if result.cables.len() > 1 {
        let mean = |value: fn(&FitCableResult) -> Option<f64>| {
            let (sum, count) =
                result.cables.iter().filter_map(value).fold((0.0, 0.0), |(sum, count), one| (sum + one, count + 1.0));
            (count > 0.0).then(|| sum / count)
        };
        let cells = columns.iter().map(|(_, digits, value)| number(mean(*value), *digits));
        rows.push(std::iter::once("mean".to_owned()).chain(cells).collect());
    }
    let header: Vec<&str> = std::iter::once("cable").chain(columns.iter().map(|(header, ..)| *header)).collect();
    table(&header, 1, &rows)
}

/// How sure each value is, and from how many samples.
fn error_table(result: &FitResult) -> String {
    let fitted: Vec<Parameter> = Parameter::all()
        .filter(|p| result.cables.iter().any(|c| value_of(&c.standard_errors, p.place()).is_some()))
        .collect();
    let names: Vec<String> = fitted.iter().map(|parameter| format!("± {parameter}")).collect();
    let mut header = vec!["cable"];
    header.extend(names.iter().map(String::as_str));
    header.extend(["samples", "left out", "search"]);
    let row = |cable: &FitCableResult| {
        let mut row = vec![cable.name.clone()];
        row.extend(fitted.iter().map(|parameter| {
            value_of(&cable.standard_errors, parameter.place()).map_or_else(|| "–".to_owned(), plain)
        }));
        let LeftOut { flagged, without_reference, warm_up, outliers } = cable.left_out;
        let reasons = [
            (flagged, "flagged"),
            (without_reference, "without reference"),
            (warm_up, "warm-up"),
            (outliers, "outliers"),
        ];
        let said = reasons.into_iter().filter(|(count, _)| *count > 0);
        let left_out: Vec<String> = said.map(|(count, reason)| format!("{count} {reason}")).collect();
        row.extend([
            cable.samples.to_string(),
            left_out.join(", "),
            format!("{} after {} evaluations", cable.termination, cable.evaluations),
        ]);
        row
    };
    let rows: Vec<Vec<String>> = result.cables.iter().map(row).collect();
    table(&header, 1, &rows)
}

/// A standard error with two digits that count, without an exponent where that can be read.
fn plain(error: f64) -> String {
    if !(1e-7..1e7).contains(&error) {
        return format!("{error:.1e}");
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 8")]
    let digits = (1.0 - error.log10().floor()).max(0.0) as usize;
    format!("{error:.digits$}")
}

/// What the log cannot determine, and what to record for it.
fn undetermined(result: &FitResult) -> String {
    let mut text = String::new();
    for parameter in Parameter::all() {
        let name = parameter.to_string();
        let cables: Vec<&str> = result
            .cables
            .iter()
            .filter(|cable| cable.undetermined.contains(&name))
            .map(|cable| cable.name.as_str())
            .collect();
        if !cables.is_empty() {
            let excitation = parameter.row().excitation;
            let _ = writeln!(
                text,
                "\nThe log does not determine {name} of {}; the given value is kept. Record {excitation}.",
                cables.join(", ")
            );
        }
    }
    text
}
