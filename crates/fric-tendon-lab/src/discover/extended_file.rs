//! Determines the content of the extended file: the findings, and fitted values where the run contradicts the given ones.

use fric_tendon::edit::ManipulatorEdit;
use fric_tendon::file::USUAL_SIGMA_N_PER_M;

use super::case::Case;
use super::friction::model::{Effect, Model};
use super::friction::naming::Outcome;
use crate::shape_errors::Way;

/// Returns the changes to the given file.
pub fn edit(case: &Case<'_>, outcome: &Outcome) -> ManipulatorEdit {
    let Outcome { given, last, findings, .. } = outcome;
    let model = &last.fit.model;
    let is_same = model.mu.windows(2).all(|pair| pair[0].to_bits() == pair[1].to_bits());
    let drifts = findings.iter().any(|finding| matches!(finding.effect, Effect::SensorDrift(_)));
    let remembers = findings.iter().any(|finding| finding.effect == Effect::Presliding);
    ManipulatorEdit {
        mu: match model.way {
            Way::None => Vec::new(),
            _ if model.mu == given.model.mu => Vec::new(),
            _ if is_same => model.mu.first().copied().into_iter().collect(),
            _ => model.mu.clone(),
        },
        sigma_n_per_m: remembers.then_some(USUAL_SIGMA_N_PER_M),
        lines: Vec::new(),
        drift_nm_per_s: if drifts {
            (0..model.mu.len()).map(|grating| drift(case, model, grating)).collect()
        } else {
            Vec::new()
        },
        ..ManipulatorEdit::default()
    }
}

/// Returns the drift of a shift, including that which the file states.
pub fn drift(case: &Case<'_>, model: &Model, grating: usize) -> f64 {
    let stated = case.file.tables().gratings.as_ref().and_then(|table| table.drift_nm_per_s.get(grating)).copied();
    let found = model.drift_n_per_s.get(grating).zip(case.newton_per_nm.get(grating));
    stated.unwrap_or(0.0) + found.map_or(0.0, |(drift_n_per_s, newton_per_nm)| drift_n_per_s / newton_per_nm)
}
