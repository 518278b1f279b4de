//! The result of an identification for people.

use fric_lab::fit::HALF_INTERVAL;
use fric_lab::text::{quantity, table, wrapped};

use super::super::base_noise::BaseNoise;
use super::super::guard::Guard;
use super::result::{Disagreement, TendonFitResult};

impl TendonFitResult {
    /// Returns a summary for people.
    #[must_use]
    pub fn summary(&self) -> String {
        let row = |(key, value): &(String, f64)| {
            let half = self.standard_errors.get(key).map(|error| HALF_INTERVAL * error);
            let given = self.given.get(key).map_or_else(|| "–".to_owned(), |given| quantity(given, half, "1"));
            let given = given.split(" ±").next().unwrap_or_default().to_owned();
            [key.clone(), given, quantity(*value, half, "1")]
        };
        let rows: Vec<[String; 3]> = self.parameters.0.iter().map(row).collect();
        let samples: usize = self.samples.iter().sum();
        let mut text = format!("{}: {samples} samples of {} runs\n\n", self.manipulator, self.runs.len());
        if self.runs.len() == 1 {
            text = text.replace(" of 1 runs", "");
        }
        if rows.is_empty() {
            text += "Nothing is found that the file could take; it keeps its numbers.\n\n";
        } else {
            text += &table(&["", "given", "found"], 1, &rows);
            text += "\nValues with 95 % intervals.\n";
        }
        for line in [differences("before", &self.before), differences("after", &self.after)] {
            text += &line;
        }
        for open in &self.undetermined {
            text += &wrapped("undetermined: ", &format!("{}.", open.sentence));
        }
        for noise in self.noises() {
            text += &wrapped("noise: ", &format!("{noise}."));
        }
        for step in self.steps() {
            text += &wrapped("step: ", &format!("{step}."));
        }
        if let Some(misfit) = self.misfit() {
            text += &wrapped("misfit: ", &format!("{misfit}."));
        }
        text
    }

    /// Returns what the fit leaves more of than noise, in a sentence; `None` if it does not.
    fn misfit(&self) -> Option<String> {
        let what = match self.misfit_of.as_slice() {
            [] => return None,
            ["gratings"] => "more of the gratings' tensions is left than noise and errors of their lines",
            ["markers"] => "disks stay further from their markers than noise",
            _ => "more of the gratings' tensions is left than noise, and disks stay further from their markers",
        };
        Some(format!(
            "{what}, so something is missing or wrong that the fit does not vary, and values and intervals may be off; `fric-cli discover` looks for it"
        ))
    }

    /// Returns one sentence for each common step of the gratings.
    fn steps(&self) -> impl Iterator<Item = String> {
        let of_run = |(name, steps): (&String, &Vec<Guard>)| {
            steps.iter().map(|step| format!("{name}: {}", step.warning())).collect::<Vec<_>>()
        };
        self.runs.iter().zip(&self.common_steps).flat_map(of_run)
    }

    /// Returns one sentence for each run with noise on the tension at the base.
    fn noises(&self) -> impl Iterator<Item = String> {
        let of_run =
            |(name, noise): (&String, &Option<BaseNoise>)| noise.map(|noise| format!("{name}: {}", noise.warning()));
        self.runs.iter().zip(&self.base_noise).filter_map(of_run)
    }

    /// Returns one sentence for each number that the runs do not determine, for each run with noise on the tension at the base, for each common step of the
    /// gratings, and for a misfit.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let open = self.undetermined.iter().map(|open| open.sentence.clone());
        open.chain(self.noises()).chain(self.steps()).chain(self.misfit()).collect()
    }
}

fn differences(name: &str, one: &Disagreement) -> String {
    let tension = one.tension_rms_n.map(|rms_n| format!("tension {:.2} mN off the gratings (rms)", 1e3 * rms_n));
    let markers = one
        .marker_mean_mm
        .zip(one.marker_max_mm)
        .map(|(mean_mm, max_mm)| format!("disks {mean_mm:.2} mm off the markers (mean; at most {max_mm:.2} mm)"));
    let parts: Vec<String> = tension.into_iter().chain(markers).collect();
    wrapped(&format!("{name}: "), &format!("{}.", parts.join(", ")))
}
