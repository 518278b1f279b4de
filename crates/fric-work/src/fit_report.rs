//! A fit for people: its verdict with the tables, and a report in the style of lmfit with values, errors, correlations and undetermined parameters.

use std::fmt::Write as _;

use fric_lab::errors::ForceError;
use fric_lab::fit::CableFit;
use fric_lab::fit::result::{FitCableResult, FitResult};
use fric_lab::text::{digits_of, number, plain, significant, wrapped};
use fric_lab::words::Times;

use crate::report::fit::remark;
use crate::verdict::of_fit;

/// Minimum magnitude of a reported correlation.
const LEAST_CORRELATION: f64 = 0.5;

/// Two parameters that the samples do not distinguish well.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlation {
    /// The first parameter.
    pub first: String,
    /// The second parameter.
    pub second: String,
    /// −1 to 1.
    pub value: f64,
}

/// Returns the correlations of a cable's parameters with a magnitude of at least 0.5, the strongest first.
#[must_use]
pub fn correlations(fit: &CableFit) -> Vec<Correlation> {
    let matrix = fit.correlation();
    let of_pair = |(first, second): (usize, usize)| {
        let value = matrix.get((first, second)).copied().filter(|value| value.abs() >= LEAST_CORRELATION)?;
        let [first, second] = [fit.fitted.get(first)?, fit.fitted.get(second)?].map(ToString::to_string);
        Some(Correlation { first, second, value })
    };
    let pairs =
        (0..fit.fitted.len()).flat_map(|first| (first + 1..fit.fitted.len()).map(move |second| (first, second)));
    let mut strong: Vec<Correlation> = pairs.filter_map(of_pair).collect();
    strong.sort_by(|one, other| other.value.abs().total_cmp(&one.value.abs()));
    strong
}

/// Returns the verdict and the tables for people.
#[must_use]
pub fn summary(result: &FitResult) -> String {
    format!("{}\n{}", wrapped("", &of_fit(result).sentence), result.summary())
}

/// Returns the report; `fits` belong to the result.
#[must_use]
pub fn fit_report(result: &FitResult, fits: &[CableFit]) -> String {
    let mut text = format!("[[Fit of {}]]\n    reference: {}\n", result.robot, result.reference.name());
    for (cable, fit) in result.cables.iter().zip(fits) {
        // Writing to a String cannot fail, here and below.
        let _ = write!(text, "[[{}]]\n{}[[Variables]]\n{}", cable.name, statistics(cable), variables(cable));
        let strong = correlations(fit);
        if !strong.is_empty() {
            let _ = writeln!(text, "[[Correlations]] (those below {LEAST_CORRELATION} are not shown)");
            for Correlation { first, second, value } in strong {
                let _ = writeln!(text, "    C({first}, {second}) = {value:+.4}");
            }
        }
        for log in &cable.per_log {
            for (name, value) in &log.parameters.0 {
                let error = log.standard_errors.get(name);
                let _ = write!(text, "    {}: {name} = {}", log.log, value_text(*value, error));
                let _ = writeln!(text, " +/- {}", error.map_or_else(|| "?".to_owned(), plain));
            }
        }
        for fault in &cable.faults {
            let _ = writeln!(text, "    recording: {}", fault.in_words(&Times::default()));
        }
        for open in &cable.open {
            let parts =
                open.0.iter().map(|part| format!("{} of {} by {}", part.parameter, part.cable, significant(part.step)));
            let _ = writeln!(text, "    open: together {}", parts.collect::<Vec<_>>().join(", "));
        }
    }
    if let Some(wrench) = &result.wrench {
        text += &wrench.table();
    }
    text
}

/// Formats a value with the digits that its error allows.
pub(crate) fn value_text(value: f64, error: Option<f64>) -> String {
    match error {
        Some(error) if error.is_finite() && error > 0.0 => number(value, digits_of(error)),
        _ => significant(value),
    }
}

fn statistics(cable: &FitCableResult) -> String {
    let FitCableResult { samples, evaluations, termination, before, after, .. } = cable;
    let mut text = format!("    samples = {samples}, evaluations = {evaluations}, {termination}\n");
    if let (Some(ForceError { rms_n: before_n, .. }), Some(ForceError { rms_n: after_n, .. })) = (before, after) {
        let _ = writeln!(text, "    rms before = {before_n:.4} N, after = {after_n:.4} N");
    }
    text
}

fn variables(cable: &FitCableResult) -> String {
    let width = cable.parameters.0.iter().map(|(name, _)| name.len()).max().unwrap_or(0) + 1;
    let mut text = String::new();
    for (name, value) in &cable.parameters.0 {
        let label = format!("{name}:");
        let error = cable.standard_errors.get(name);
        let _ = write!(text, "    {label:width$} {}", value_text(*value, error));
        if let Some(error) = error {
            let _ = write!(text, " +/- {}", plain(error));
            if *value != 0.0 {
                let _ = write!(text, " ({:.2}%)", 100.0 * (error / value).abs());
            }
        }
        let remark = remark(cable, name);
        let _ = if remark.is_empty() { writeln!(text) } else { writeln!(text, " ({remark})") };
    }
    text
}
