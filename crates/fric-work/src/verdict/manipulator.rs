//! Verdicts on the results of a continuum manipulator.

use fric_lab::discover::Verdict as Found;
use fric_lab::discover::result::DiscoverResult;
use fric_lab::text::listed;
use fric_tendon_lab::discover::{Manipulator, rest_in_words};
use fric_tendon_lab::identify::TendonFitResult;
use fric_tendon_lab::result::{CalibrationResult, FrictionResult, HoleResult, ShapeResult};

use super::{Tone, Verdict, counted};

/// Returns the verdict on a calibration: how well lines describe the gratings.
#[must_use]
pub fn of_calibration(result: &CalibrationResult) -> Verdict {
    let worst =
        result.gratings.iter().max_by(|one, other| one.largest_residual_ratio.total_cmp(&other.largest_residual_ratio));
    let largest = worst.map_or_else(String::new, |worst| {
        format!(
            ": the largest residual is {:.2} % of the greatest load, on grating {}",
            100.0 * worst.largest_residual_ratio,
            worst.grating
        )
    });
    let sentence = format!(
        "{} calibrated by {}{largest}.",
        counted(result.gratings.len(), "grating"),
        counted(result.load_n.len(), "load")
    );
    let todo =
        vec!["Measure the friction at the holes with the calibrated file: fric-cli continuum friction.".to_owned()];
    Verdict { tone: Tone::Well, sentence, todo }
}

/// Returns the verdict on the identification of a manipulator: the remaining error between model and markers, or between model and gratings.
#[must_use]
pub fn of_tendon_fit(result: &TendonFitResult) -> Verdict {
    let (before, after) = (result.before, result.after);
    let markers = before.marker_mean_mm.zip(after.marker_mean_mm);
    let tensions = before.tension_rms_n.zip(after.tension_rms_n);
    let left = match (markers, tensions) {
        (Some((before, after)), _) => {
            format!("the disks are {after:.2} mm from their markers in the mean, {before:.2} mm with the given file")
        }
        (None, Some((before, after))) => {
            format!("the tensions are {after:.4} N off (rms), {before:.4} N with the given file")
        }
        (None, None) => "model and measurement cannot be compared".to_owned(),
    };
    let sentence = format!(
        "{} identified from {}: {left}.",
        counted(result.parameters.0.len(), "number"),
        counted(result.runs.len(), "run")
    );
    let is_worse = markers.or(tensions).is_none_or(|(before, after)| after > before);
    let tone = match (is_worse, result.undetermined.is_empty() && !result.is_misfit) {
        (true, _) => Tone::Bad,
        (false, false) => Tone::Mixed,
        (false, true) => Tone::Well,
    };
    let todo = result.warnings().into_iter().map(|warning| format!("{warning}.")).collect();
    Verdict { tone, sentence, todo }
}

/// Returns the verdict on the friction at the holes: the hole with the most.
#[must_use]
pub fn of_hole_frictions(result: &FrictionResult) -> Verdict {
    let largest = |hole: &fric_tendon_lab::result::HoleSummary| hole.least_n.abs().max(hole.greatest_n.abs());
    let finite = result.holes.iter().filter(|hole| largest(hole).is_finite());
    let worst = finite.max_by(|one, other| largest(one).total_cmp(&largest(other)));
    let sentence = worst.map_or_else(
        || "Friction at the holes is not known.".to_owned(),
        |worst| {
            format!(
                "Friction is greatest at hole {}: {:.4} N to {:.4} N over the run, {:.4} N in the mean.",
                worst.hole, worst.least_n, worst.greatest_n, worst.mean_n
            )
        },
    );
    let mut todo = result.grating_warnings();
    todo.push("See what this friction does to the shape: fric-cli continuum shape.".to_owned());
    Verdict { tone: Tone::Mixed, sentence, todo }
}

/// Returns the verdict on shapes: the friction model nearest to the markers.
#[must_use]
pub fn of_shapes(result: &ShapeResult) -> Verdict {
    let mean_mm = |way: &fric_tendon_lab::result::WayErrors| way.all.mean_mm;
    let mut known: Vec<(&str, f64)> = result
        .ways
        .iter()
        .filter_map(|way| Some((way.way.name(), mean_mm(way)?)))
        .filter(|(_, mean_mm)| mean_mm.is_finite())
        .collect();
    known.sort_by(|one, other| one.1.total_cmp(&other.1));
    let (tone, sentence) = match known.as_slice() {
        [(best, best_mm), .., (last, last_mm)] => (
            Tone::Mixed,
            format!(
                "The shape is predicted best by the way `{best}`: {best_mm:.2} mm off the markers in the mean; worst by `{last}`, {last_mm:.2} mm."
            ),
        ),
        [(only, mm)] => {
            (Tone::Mixed, format!("The shape by the way `{only}` is {mm:.2} mm off the markers in the mean."))
        }
        [] => (Tone::Mixed, "Shapes are predicted; how well is not known, for the run has no markers.".to_owned()),
    };
    let mut todo = result.grating_warnings();
    if known.is_empty() {
        todo.push("Record markers on the disks to judge the shapes.".to_owned());
    }
    Verdict { tone, sentence, todo }
}

/// Returns the verdict on a manipulator's discovery.
#[must_use]
pub fn of_tendon(result: &DiscoverResult<Manipulator>) -> Verdict {
    let (mut parts, mut todo, mut is_well) = (Vec::new(), Vec::new(), true);
    for tendon in &result.cables {
        let kinds: Vec<&str> = tendon.effects.iter().map(|effect| effect.kind).collect();
        is_well &= tendon.verdict == Found::Complete;
        if tendon.verdict == Found::Complete {
            parts.push("The model is complete: what is left is noise.".to_owned());
        }
        if tendon.markers.is_none() {
            is_well = false;
            parts.push("The bending is not checked, for the run has no markers.".to_owned());
            todo.push(
                "Record markers on the disks; without them a wrong stiffness, offset or load stays hidden.".to_owned(),
            );
        }
        if !kinds.is_empty() {
            parts.push(format!("The model lacks {}.", listed(&kinds)));
        }
        if tendon.verdict == Found::Unexplained {
            parts.push("Something is left without a name.".to_owned());
        }
        todo.extend(tendon.effects.iter().map(|effect| format!("{}: {}", effect.kind, effect.effect[1])));
        todo.extend(tendon.unexplained.iter().map(rest_in_words));
    }
    if todo.is_empty() {
        todo.push("Nothing: keep the model.".to_owned());
    }
    Verdict { tone: if is_well { Tone::Well } else { Tone::Mixed }, sentence: parts.join(" "), todo }
}

/// Returns the verdict on a single hole.
#[must_use]
pub fn of_hole(result: &HoleResult) -> Verdict {
    let [from, to] = result.interval;
    let sentence =
        format!("The hole's coefficient of friction μ is {:.4}, with 95 % confidence {from:.4} to {to:.4}.", result.mu);
    Verdict { tone: Tone::Well, sentence, todo: Vec::new() }
}
