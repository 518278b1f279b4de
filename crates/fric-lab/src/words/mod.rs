//! Names, numbers, times and conditions of results in words, for the terminal and for pages.

mod times;

use crate::text::number;

pub use times::{Stretch, Times};

/// Unit suffixes of keys, the longer ones first.
const UNITS: [&str; 13] = [
    "_n_s2_per_m2",
    "_n_s_per_m",
    "_per_n",
    "_m_per_s",
    "_n_per_m",
    "_n_per_s",
    "_m_per_n",
    "_per_s",
    "_kg",
    "_nm",
    "_s",
    "_n",
    "_m",
];

/// Returns a parameter's key without its unit.
#[must_use]
pub fn name_of(key: &str) -> String {
    let name = UNITS.iter().find_map(|unit| key.strip_suffix(unit)).unwrap_or(key);
    name.replace('_', " ")
}

/// Formats a fraction in per cent, clamped to 0…100 %.
#[must_use]
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share.clamp(0.0, 1.0);
    // A fraction just below 100 % must not be rounded to 100 %, nor one just above 0 to 0: values near the ends get one more digit.
    if (98.5..99.95).contains(&percent) || (0.05..1.5).contains(&percent) {
        format!("{percent:.1} %")
    } else {
        format!("{percent:.0} %")
    }
}

/// Formats a force.
#[must_use]
pub fn newtons(force_n: f64) -> String {
    format!("{force_n:.4} N")
}

/// Formats a BIC difference.
#[must_use]
pub fn evidence(delta_bic: Option<f64>) -> String {
    delta_bic.map_or_else(|| "–".to_owned(), |of| number(of, 0).replace('-', "−"))
}

/// Formats a significance in standard errors. The number is truncated, not rounded, so that it stays on its side of a limit.
#[must_use]
pub fn significance(errors: f64) -> String {
    if errors < 10.0 {
        format!("{:.1} σ", (10.0 * errors).floor() / 10.0)
    } else {
        format!("{:.0} σ", errors.floor())
    }
}

/// Formats a time interval without its unit.
#[must_use]
pub fn interval([from_s, to_s]: &[f64; 2]) -> String {
    let digits = if to_s - from_s < 0.2 { 2 } else { 1 };
    let (from, to) = (format!("{from_s:.digits$}"), format!("{to_s:.digits$}"));
    if from == to { from } else { format!("{from}…{to}") }
}

/// Returns a condition's name in words.
#[must_use]
pub fn condition(signal: &str) -> String {
    match signal {
        "length" => "cable length".to_owned(),
        "load" => "cable tension".to_owned(),
        "way_since_reversal" => "way since the last reversal".to_owned(),
        "force_rate" => "rate of the sensor force".to_owned(),
        "reference_rate" => "rate of the reference".to_owned(),
        "past_load" => "past of the load".to_owned(),
        "friction_rate" => "rate at which the contacts store friction".to_owned(),
        "wrap" => "wrap angle".to_owned(),
        _ => signal.replace('_', " "),
    }
}
