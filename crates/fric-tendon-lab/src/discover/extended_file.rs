//! What the extended file says: what was found, and values fitted to the run where it contradicts those given.

use fric_tendon::edit::ManipulatorEdit;
use fric_tendon::file::USUAL_SIGMA_N_PER_M;

use super::case::Case;
use super::model::{Effect, Model};
use super::naming::Outcome;
use crate::shape_errors::Way;

/// What to change in the file given.
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

/// Drift of a shift, that which the file states included.
pub fn drift(case: &Case<'_>, model: &Model, grating: usize) -> f64 {
    let stated = case.file.tables().gratings.as_ref().and_then(|table| table.drift_nm_per_s.get(grating)).copied();
    let found = model.drift_n_per_s.get(grating).zip(case.newton_per_nm.get(grating));
    stated.unwrap_or(0.0) + found.map_or(0.0, |(drift_n_per_s, newton_per_nm)| drift_n_per_s / newton_per_nm)
}
