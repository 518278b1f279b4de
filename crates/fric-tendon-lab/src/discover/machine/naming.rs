//! Names of what a search has found, and the file with it.

use fric_lab::fit::HALF_INTERVAL;
use fric_lab::numbers::Numbers;
use fric_tendon::file::{ManipulatorFile, ManipulatorTables};

use super::candidate::Candidate;
use super::joint::{Point, StandardError, Units};
use super::{Entry, Machine, Named, Place, Search};
use crate::discover::final_fit::OWN_RATIO;
use crate::discover::goes_with::{SILICA_PER_K, USUAL_WAVELENGTH_NM};
use crate::identify::unknown::Unknown;

impl Search<'_> {
    /// Removes names that are not clear, the last first, because the values of the others are only right without them.
    pub(super) fn without_guesses(
        &self,
        mut entries: Vec<Entry>,
        mut now: Place,
        before: &Place,
    ) -> Option<(Vec<Entry>, Place)> {
        loop {
            let errors = self.joint.errors(&now.point, &now.set, &now.jacobian)?;
            let left = self.left(&now);
            let is_guess = |entry: &Entry| entry.candidate.is_named() && !self.is_clear(entry, &now, &errors, left);
            let Some(at) = entries.iter().rposition(is_guess) else { return Some((entries, now)) };
            let guess = entries.remove(at).candidate;
            // Their ratio is what counts, but for weight.
            let is_twin = |entry: &&mut Entry| {
                let pair = [entry.candidate, guess];
                pair.contains(&Candidate::Stiffness) && pair.contains(&Candidate::TendonOffset)
            };
            if let Some(twin) = entries.iter_mut().find(is_twin).filter(|twin| !twin.alike.contains(&guess)) {
                twin.alike.push(guess);
            }
            let others: Vec<Candidate> = entries.iter().map(|entry| entry.candidate).collect();
            let fresh: Vec<Unknown> =
                others.iter().flat_map(|candidate| candidate.frees(&self.joint.runs.given)).collect();
            let set = self.set_of(&before.set, &others);
            let point = self.joint.fitted(&now.point, &set, &now.jacobian, &fresh, now.units)?;
            now = self.settled(point, set)?;
        }
    }

    /// Returns the squares of a residual in units of the noise.
    fn squares(&self, point: &Point, units: Units) -> f64 {
        let sums = self.joint.sums(point);
        sums.tension_n2 / units.tension_n.powi(2) + sums.marker_m2 / units.marker_m.powi(2)
    }

    /// Returns what is left of them above the noise.
    fn left(&self, now: &Place) -> f64 {
        (self.squares(&now.point, now.units) - self.count(&now.point)).max(0.0)
    }

    /// Whether a candidate accounts for more than is left, and the interval of one of its numbers excludes the stated value.
    fn is_clear(&self, entry: &Entry, now: &Place, errors: &[StandardError], left: f64) -> bool {
        let is_off = |unknown: Unknown| {
            let place = self.joint.place(unknown);
            let error = errors.iter().find(|error| Some(error.place) == place);
            error.is_some_and(|error| self.joint.found(&now.point, unknown).abs() > HALF_INTERVAL * error.whole)
        };
        entry.gain > left && entry.candidate.frees(&self.joint.runs.given).into_iter().any(is_off)
    }

    /// Returns the final names.
    pub(super) fn named(
        &self,
        file: &ManipulatorFile,
        entries: &[Entry],
        before: &Place,
        now: &Place,
    ) -> Option<Machine> {
        let joint = &self.joint;
        let count = self.count(&now.point);
        let left = self.left(now);
        // Wrong lines cause wrong shapes, and a rest above the noise may have any cause.
        let has_wrong_lines =
            entries.iter().any(|entry| matches!(entry.candidate, Candidate::AllLines | Candidate::Line(_)));
        if has_wrong_lines || left > count {
            return Some(Machine::none(file));
        }
        let errors = joint.errors(&now.point, &now.set, &now.jacobian)?;
        let error = |unknown: Unknown| {
            let place = joint.place(unknown)?;
            errors.iter().find(|error| error.place == place).map(|error| error.whole)
        };
        let is_clear = |entry: &&Entry| self.is_clear(entry, now, &errors, left);
        // Without markers a segment shows by friction alone, of the holes at both its ends. It must be as far off as a hole must be to be named.
        let is_enough = |entry: &&Entry| match entry.candidate {
            Candidate::SegmentStiffness(segment) if !joint.runs.has_markers() => {
                let softness = (-joint.found(&now.point, Unknown::SegmentStiffness(segment))).exp();
                (0.5 * (softness - 1.0)).abs() > OWN_RATIO
            }
            candidate => candidate.is_named(),
        };
        let is_late = |entry: &&Entry| entry.candidate == Candidate::LateMarkers;
        let marker_lag_s =
            entries.iter().find(is_late).filter(is_clear).map_or(0.0, |_| joint.found(&now.point, Unknown::MarkerLag));
        let clear: Vec<&Entry> = entries.iter().filter(is_clear).filter(is_enough).collect();
        let mut tables = file.tables().clone();
        for unknown in clear.iter().flat_map(|entry| entry.candidate.frees(&joint.runs.given)) {
            if unknown == Unknown::CommonShift
                && let (Some(to), Some(from)) = (&mut tables.gratings, &joint.runs.given.gratings)
            {
                to.common_step_s = from.common_step_s;
            }
            unknown.put(&mut tables, joint.found(&now.point, unknown));
        }
        let gap = (self.squares(&before.point, now.units) - count).max(0.0).sqrt();
        let gap_closed = if gap > 0.0 { 1.0 - left.sqrt() / gap } else { 1.0 };
        let named = clear.iter().map(|entry| {
            let (parameters, standard_errors) = numbers(entry.candidate, file.tables(), &tables, &error);
            // Without markers each of the holes at the ends of a segment can have the friction that goes with its bend.
            let is_by_friction = matches!(entry.candidate, Candidate::SegmentStiffness(_)) && !joint.runs.has_markers();
            let holes = is_by_friction.then_some(Candidate::AllHoles);
            // What is named has its own entry.
            let is_other = |other: &Candidate| clear.iter().all(|entry| entry.candidate.kind() != other.kind());
            Named {
                candidate: entry.candidate,
                parameters,
                standard_errors,
                delta_bic: entry.delta_bic,
                gap_closed,
                runner_up: entry.runner_up,
                alike: entry.alike.iter().copied().chain(holes).filter(is_other).collect(),
            }
        });
        let is_bent = |candidate: &Candidate| matches!(candidate, Candidate::SegmentStiffness(_));
        let rough =
            entries.iter().filter(|entry| !entry.alike.iter().any(is_bent)).filter_map(|entry| match entry.candidate {
                Candidate::Hole(hole) => Some(hole),
                _ => None,
            });
        let remembers =
            file.tables().tendon.mu == joint.runs.given.tendon.mu && file.tables().tendon.sigma_n_per_m.is_some();
        let mu = if remembers {
            now.point.state.tables(&joint.runs.given).tendon.mu.as_slice().to_vec()
        } else {
            Vec::new()
        };
        let lines = now.point.state.lines.clone();
        Some(Machine { named: named.collect(), tables, lines, marker_lag_s, rough: rough.collect(), mu })
    }
}

/// Returns the parameters of a candidate and their standard errors.
fn numbers(
    candidate: Candidate,
    given: &ManipulatorTables,
    tables: &ManipulatorTables,
    error: &dyn Fn(Unknown) -> Option<f64>,
) -> (Numbers, Numbers) {
    let (mut parameters, mut errors) = (Vec::new(), Vec::new());
    for unknown in candidate.frees(given) {
        let mut add = |key: String, value: f64, per_distance: f64| {
            parameters.push((key.clone(), value));
            errors.extend(error(unknown).map(|error| (key, per_distance.abs() * error)));
        };
        match unknown {
            Unknown::SegmentStiffness(segment) => {
                #[expect(clippy::cast_precision_loss, reason = "a small count")]
                let number = (segment + 1) as f64;
                parameters.push(("segment".to_owned(), number));
                let value = unknown.value(tables);
                errors.extend(error(unknown).map(|error| ("stiffness_ratio".to_owned(), value * error)));
                parameters.push(("stiffness_ratio".to_owned(), value));
            }
            Unknown::Stiffness => {
                let ratio = unknown.value(tables) / unknown.value(given);
                add(unknown.key(), unknown.value(tables), unknown.value_per_distance(tables));
                add("stiffness_ratio".to_owned(), ratio, ratio);
            }
            Unknown::CommonShift => {
                let table = tables.gratings.as_ref();
                let wavelengths = table.and_then(|table| table.wavelength_nm.as_ref());
                let wavelength_nm =
                    wavelengths.and_then(|all| all.as_slice().first()).copied().unwrap_or(USUAL_WAVELENGTH_NM);
                let kelvin = (wavelength_nm * SILICA_PER_K).recip();
                let shift_nm = unknown.value(tables);
                add(unknown.key(), shift_nm, 1.0);
                add("temperature_k".to_owned(), shift_nm * kelvin, kelvin);
                parameters.extend(table.and_then(|table| table.common_step_s).map(|at| ("from_s".to_owned(), at)));
            }
            _ => add(unknown.key(), unknown.value(tables), unknown.value_per_distance(tables)),
        }
    }
    (Numbers(parameters), Numbers(errors))
}
