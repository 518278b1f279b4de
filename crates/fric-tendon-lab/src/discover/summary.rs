//! The result of a tendon's discovery for people.

use std::fmt::Write as _;

use fric_lab::discover::result::{DiscoverResult, EffectResult, TriedResult, UnexplainedResult};
use fric_lab::errors::ForceError;
use fric_lab::fit::HALF_INTERVAL;
use fric_lab::text::{listed, quantity, table, wrapped};

use super::result::{Manipulator, TendonMarkers};

/// What a run without markers does not tell.
pub const WITHOUT_MARKERS: &str = "the run has none that can be used, so that the bending is not checked: a wrong stiffness, offset or load stays hidden.";

/// Returns the full summary.
pub fn describe(result: &DiscoverResult<Manipulator>) -> String {
    let number =
        |error: Option<ForceError>| error.map_or_else(|| "–".to_owned(), |error| format!("{:.4}", error.rms_n));
    let percent = |share: Option<f64>| share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share));
    let rows: Vec<[String; 7]> = result
        .cables
        .iter()
        .map(|tendon| {
            let mut kinds: Vec<&str> = tendon.effects.iter().map(|effect| effect.kind).collect();
            kinds.dedup();
            [
                tendon.name.clone(),
                tendon.verdict.name().to_owned(),
                if kinds.is_empty() { "–".to_owned() } else { kinds.join("\n") },
                tendon.noise_floor_n.map_or_else(|| "–".to_owned(), |noise_n| format!("{noise_n:.4}")),
                number(tendon.before),
                number(tendon.after),
                percent(tendon.gap_closed),
            ]
        })
        .collect();
    let header = ["", "verdict", "found", "noise\n[N]", "before\n[N]", "after\n[N]", "gap\nclosed"];
    let mut text = format!("{}: what the model lacks\n\n{}", result.robot, table(&header, 3, &rows));
    text += "\nBefore and after are the rms difference of tension between gratings and model,\non samples that no fit has seen.\n";
    let effects: Vec<&EffectResult<Manipulator>> = result.cables.iter().flat_map(|tendon| &tendon.effects).collect();
    for (place, effect) in effects.iter().enumerate() {
        let values: Vec<String> = effect
            .parameters
            .0
            .iter()
            .map(|(name, value)| {
                let half_interval = effect.standard_errors.get(name).map(|error| HALF_INTERVAL * error);
                format!("{name} = {}", quantity(*value, half_interval, "1"))
            })
            .collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\n{}: {}", effect.kind, values.join(", "));
        if !effect.alike.is_empty() {
            text += &wrapped("  or      ", &alternatives(effect));
        }
        // Printed once for holes that were found together.
        if effects.get(place + 1).is_none_or(|next| next.kind != effect.kind) {
            let [cause, remedy] = effect.effect;
            text += &wrapped("  cause   ", cause);
            text += &wrapped("  remedy  ", remedy);
        }
    }
    for tendon in &result.cables {
        let markers = tendon.markers.as_ref().map_or_else(|| WITHOUT_MARKERS.to_owned(), TendonMarkers::sentence);
        text += "\n";
        text += &wrapped("markers: ", &markers);
        for tried in tried_in_words(&tendon.tried) {
            text += "\n";
            text += &wrapped("not named: ", &tried);
        }
        if let Some(kept) = &tendon.kept {
            text += "\n";
            text += &wrapped("kept: ", kept);
        }
        if let Some(rest) = &tendon.unexplained {
            text += "\n";
            text += &wrapped("unexplained: ", &rest_in_words(rest));
        }
    }
    text
}

/// Returns the effects that may be present instead, in words.
#[must_use]
pub fn alternatives(effect: &EffectResult<Manipulator>) -> String {
    let is_hole = |kind: &str| kind == "hole_friction";
    let right = if is_hole(effect.kind) || effect.alike.iter().any(|kind| is_hole(kind)) {
        "tensions are right with either, shapes only with the right one: record markers"
    } else {
        "shapes are right with either"
    };
    format!("{}: the run does not tell them apart. The file gets {}; {right}.", effect.alike.join(", or "), effect.kind)
}

impl TendonMarkers {
    fn sentence(&self) -> String {
        let Self { noise_mm, calibration_error_mm, before, after } = self;
        format!(
            "with the tensions that the gratings show the disks are {:.2} mm off their markers (rms; at most {:.2} mm), {:.2} mm as \
             given; noise makes {noise_mm:.2} mm of it, and one standard error of the calibration {calibration_error_mm:.2} mm.",
            after.rms_mm, after.max_mm, before.rms_mm
        )
    }
}

/// Returns the candidates that do not suffice, a sentence for those of one kind and reason that follow one another.
#[must_use]
pub fn tried_in_words(tried: &[TriedResult]) -> Vec<String> {
    let is_alike = |one: &TriedResult, other: &TriedResult| (one.kind, &one.reason) == (other.kind, &other.reason);
    tried
        .chunk_by(is_alike)
        .map(|alike| {
            let parameters = || alike.iter().filter_map(|tried| tried.parameters.as_ref()).flat_map(|one| &one.0);
            let places: Vec<String> = parameters().map(|(_, place)| place.to_string()).collect();
            let at =
                parameters().next().map_or_else(String::new, |(name, _)| format!(" at {name} {}", listed(&places)));
            alike.first().map_or_else(String::new, |first| format!("{}{at}: {}.", first.kind, first.reason))
        })
        .collect()
}

/// Returns the rest that no effect explains, in sentences.
#[must_use]
pub fn rest_in_words(rest: &UnexplainedResult<Manipulator>) -> String {
    // The signal's place with the greatest share.
    let most = |signal: &str| {
        let place = rest.places.iter().find(|place| place.signal == signal)?;
        Some((100.0 * place.share_of_excess?, place.from))
    };
    let mut text = String::new();
    // Writing to a String cannot fail.
    if let (Some((share, grating)), Some(rms_n)) = (most("grating"), rest.rms_n) {
        let _ = write!(
            text,
            "{rms_n:.4} N of tension are left above the noise, {share:.0} % of the squares at grating {grating}. "
        );
    }
    if let (Some((share, disk)), Some(rms_mm)) = (most("marker"), rest.rms_mm) {
        let _ = write!(
            text,
            "The disks are {rms_mm:.2} mm (rms) off their markers above the noise, {share:.0} % of the squares at disk {disk}. "
        );
    }
    for one in &rest.goes_with {
        text += &one.sentence;
        text += " ";
    }
    text + "No effect of the catalogue accounts for it."
}
