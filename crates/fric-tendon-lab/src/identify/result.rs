//! The result of an identification: `fric-continuum-fit/1`.

use fric_lab::numbers::Numbers;
use fric_tendon::file::ManipulatorTables;
use serde::Serialize;

use super::super::base_noise::BaseNoise;
use super::super::discover::worse::Worse;
use super::super::guard::Guard;
use super::attempt::{Attempt, MadeWorse};
use super::evaluation::{Evaluation, Row};
use super::quantity::Quantity;
use super::unknown::Unknown;

/// `fric-continuum-fit/1`.
#[derive(Clone, Debug, Serialize)]
pub struct TendonFitResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Name of the manipulator.
    pub manipulator: String,
    /// The runs.
    pub runs: Vec<String>,
    /// Number of compared samples of each run.
    pub samples: Vec<usize>,
    /// Noise that was taken off the tension at the base of each run; null for none.
    pub base_noise: Vec<Option<BaseNoise>>,
    /// Common steps of the gratings that were taken off, in each run.
    pub common_steps: Vec<Vec<Guard>>,
    /// Identified values, by key.
    pub parameters: Numbers,
    /// Their standard errors.
    pub standard_errors: Numbers,
    /// Values in the given file.
    pub given: Numbers,
    /// Numbers that the runs do not determine.
    pub undetermined: Vec<Undetermined>,
    /// Errors with the given file.
    pub before: Disagreement,
    /// Errors with the fitted file.
    pub after: Disagreement,
    /// Whether more is left than noise and errors of the gratings' lines, so that something else is missing or wrong.
    pub is_misfit: bool,
    /// Of which signals: `gratings`, `markers`.
    pub misfit_of: Vec<&'static str>,
}

/// Numbers that the runs cannot distinguish, or do not determine at all.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Undetermined {
    /// Keys of the numbers, the held one first.
    pub parameters: Vec<String>,
    /// A sentence for people.
    pub sentence: String,
}

/// Differences between model and measurements; absent if they cannot be compared.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Disagreement {
    /// Root mean square of gratings minus model, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tension_rms_n: Option<f64>,
    /// Mean distance of the disks from their markers, mm: under the measured tensions or, without gratings, under the model's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub marker_mean_mm: Option<f64>,
    /// Greatest distance, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub marker_max_mm: Option<f64>,
}

impl Disagreement {
    pub(super) fn of(evaluation: &Evaluation) -> Self {
        let rows = || evaluation.runs.iter().flat_map(|run| &run.rows);
        let (mut squares, mut count) = (0.0, 0.0);
        for value in rows().flat_map(|row| &row.tension_n).filter(|value| value.is_finite()) {
            squares += value * value;
            count += 1.0;
        }
        let (mut sum_mm, mut max_mm, mut places) = (0.0, 0.0_f64, 0.0);
        let disks =
            |row: &Row| row.marker_m.chunks(2).map(|place| 1e3 * place[0].hypot(place[1])).collect::<Vec<f64>>();
        for distance_mm in rows().flat_map(disks).filter(|distance| distance.is_finite()) {
            sum_mm += distance_mm;
            max_mm = max_mm.max(distance_mm);
            places += 1.0;
        }
        Self {
            tension_rms_n: (count > 0.0).then(|| (squares / count).sqrt()),
            marker_mean_mm: (places > 0.0).then(|| sum_mm / places),
            marker_max_mm: (places > 0.0).then_some(max_mm),
        }
    }
}

impl Undetermined {
    pub(super) fn of(held: Unknown, parts: &[Unknown]) -> Self {
        let others: Vec<String> =
            parts.iter().filter(|unknown| **unknown != held).map(|unknown| unknown.key()).collect();
        let sentence = if others.is_empty() {
            format!("the runs do not tell `{}`; it stays as the file states it", held.key())
        } else {
            format!(
                "the runs do not tell `{}` apart from `{}`; the first stays as the file states it, and the other is found for that value",
                held.key(),
                others.join("`, `")
            )
        };
        Self { parameters: std::iter::once(held.key()).chain(others).collect(), sentence }
    }

    pub(super) fn at_bound(unknown: Unknown) -> Self {
        let sentence = format!("`{}` would come out below zero; it is taken as 0", unknown.key());
        Self { parameters: vec![unknown.key()], sentence }
    }

    pub(super) fn worse<'a>(kept: impl Iterator<Item = &'a Quantity>, worse: &MadeWorse) -> Self {
        let parameters: Vec<String> = kept.map(|quantity| quantity.name().to_owned()).collect();
        let what = match worse {
            MadeWorse::Disk(Worse { disk, before_m, after_m }) => {
                format!("move disk {} from {:.2} to {:.2} mm off its marker", disk + 1, 1e3 * before_m, 1e3 * after_m)
            }
            MadeWorse::Tensions([before_n, after_n]) => {
                format!("leave {:.2} in place of {:.2} mN of the gratings' tensions", 1e3 * after_n, 1e3 * before_n)
            }
        };
        let sentence = format!("a fit of `{}` would {what}; the file keeps its numbers", parameters.join("`, `"));
        Self { parameters, sentence }
    }

    pub(super) fn unseen(kept: impl Iterator<Item = Quantity>) -> Self {
        let parameters: Vec<String> = kept.map(|quantity| quantity.name().to_owned()).collect();
        let sentence = format!(
            "`{}` are not looked for, because the runs have no markers; the file keeps its numbers",
            parameters.join("`, `")
        );
        Self { parameters, sentence }
    }

    pub(super) fn impossible(quantity: Quantity) -> Self {
        let reason = match quantity {
            Quantity::GravityDirection => {
                "there is no weight in the plane of bending: state `gravity_m_per_s2` and the masses"
            }
            Quantity::Sigma => "the file has no single `sigma_n_per_m`",
            _ => "the file leaves no place for it",
        };
        Self {
            parameters: vec![quantity.name().to_owned()],
            sentence: format!("`{}` is not identified: {reason}", quantity.name()),
        }
    }
}

impl TendonFitResult {
    /// Name and version of the format.
    pub const FORMAT: &'static str = "fric-continuum-fit/1";

    pub(super) fn new(
        given: &ManipulatorTables,
        names: &[String],
        samples: &[usize],
        found: Attempt,
        tables: &ManipulatorTables,
        (base_noise, common_steps): (Vec<Option<BaseNoise>>, Vec<Vec<Guard>>),
    ) -> Self {
        let (unknowns, covariance) = (found.unknowns(), &found.covariance);
        let numbers = |of: &dyn Fn(usize, Unknown) -> f64| {
            Numbers(unknowns.iter().enumerate().map(|(place, unknown)| (unknown.key(), of(place, *unknown))).collect())
        };
        Self {
            format: Self::FORMAT,
            manipulator: given.name.clone(),
            runs: names.to_vec(),
            samples: samples.to_vec(),
            base_noise,
            common_steps,
            parameters: numbers(&|_, unknown| unknown.value(tables)),
            standard_errors: numbers(&|place, unknown| {
                unknown.value_per_distance(tables) * covariance[(place, place)].max(0.0).sqrt()
            }),
            given: numbers(&|_, unknown| unknown.value(given)),
            undetermined: found.undetermined,
            before: Disagreement::of(&found.before),
            after: Disagreement::of(&found.after),
            is_misfit: found.misfit.any(),
            misfit_of: [(found.misfit.gratings, "gratings"), (found.misfit.markers, "markers")]
                .into_iter()
                .filter_map(|(is_left, signal)| is_left.then_some(signal))
                .collect(),
        }
    }
}
