//! Descriptions of runs for `excite`.

use std::fmt::Write as _;

use fric_core::effects::Effect;
use fric_lab::excite::{Excitation, Forecast, Goal, KnownParameter};
use fric_lab::text::to_millimetre;

use crate::report::RunSeries;

/// Describes for people how long the run is, where it goes and how fast.
#[must_use]
pub fn describe(excitation: &Excitation, series: &RunSeries) -> String {
    let duration_s = excitation.trajectory().duration_s();
    let mut text = format!(
        "{} set points, {duration_s:.1} s, up to {:.3} m/s",
        excitation.total_cycles(),
        series.speed().greatest
    );
    if let Some(work_box) = excitation.work_box() {
        let corners_m = [work_box.center_m - work_box.half_edges_m, work_box.center_m + work_box.half_edges_m];
        let [from, to] = corners_m.map(|corner_m| {
            let [x, y, z] = <[f64; 3]>::from(corner_m.map(to_millimetre));
            format!("({x:.3}, {y:.3}, {z:.3})")
        });
        // Writing to a String cannot fail, here and below.
        let _ = write!(text, ", from {from} to {to} m");
    } else {
        let (least_m, greatest_m) = series.length_m().ends();
        let _ = write!(text, ", cable lengths {least_m:.3} to {greatest_m:.3} m");
    }
    if let Some(tension_n) = series.tension_n() {
        let _ = write!(text, ", cable forces {:.2} to {:.2} N", tension_n.least, tension_n.greatest);
    }
    text
}

/// Describes for people what a designed run is expected to answer, one line each.
#[must_use]
pub fn expectations(cable_names: &[&str], forecasts: &[Forecast]) -> Vec<String> {
    let line = |forecast: &Forecast| {
        let Forecast { cable, noise_n, goal, standard } = forecast;
        let name = cable_names.get(*cable).copied().unwrap_or_default();
        let open = if goal.tells() { "" } else { "; this run does not tell" };
        let standard = standard.as_ref().map_or_else(String::new, |standard| {
            format!("; the identification run of the same time: {}", in_figures(standard))
        });
        let question = match goal {
            Goal::Separated { effects, .. } => {
                let [one, other] = effects.map(kind_or_none);
                format!("{one} or {other}: ")
            }
            Goal::Determined(_) => String::new(),
        };
        format!("{name}: {question}{}{open}{standard} (noise {noise_n:.4} N)", in_figures(goal))
    };
    forecasts.iter().map(line).collect()
}

fn kind_or_none(effect: Option<Effect>) -> &'static str {
    effect.map_or("no effect", Effect::kind)
}

/// Returns the expectation in figures.
fn in_figures(goal: &Goal) -> String {
    match goal {
        Goal::Separated { effects, delta_bic } => {
            let of = |(effect, delta_bic): (&Option<Effect>, &Option<f64>)| match (delta_bic, effect) {
                (Some(delta_bic), _) => Some(format!("ΔBIC {delta_bic:.0} if it is {}", kind_or_none(*effect))),
                (None, Some(effect)) => Some(format!("too little evidence if it is {effect}")),
                (None, None) => None,
            };
            effects.iter().zip(delta_bic).filter_map(of).collect::<Vec<String>>().join(", ")
        }
        Goal::Determined(known) => {
            let of = |known: &KnownParameter| {
                let KnownParameter { parameter, value, standard_error, .. } = known;
                // Two digits of the error, and the value to the same digit.
                let digits =
                    if *standard_error > 0.0 { (1.0 - standard_error.log10().floor()).clamp(0.0, 12.0) } else { 3.0 };
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0…12")]
                let digits = digits as usize;
                format!("{parameter} {value:.digits$} ± {standard_error:.digits$}")
            };
            known.iter().map(of).collect::<Vec<String>>().join(", ")
        }
    }
}
