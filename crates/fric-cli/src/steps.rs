//! The steps that a recording allows, for every `info`.

use fric_lab::text::table_with_text;
use fric_work::report::info::InfoStep;
use serde::Serialize;

/// Whether a recording allows a step.
#[derive(Debug, Serialize)]
pub struct StepResult {
    step: &'static str,
    possible: bool,
    /// What is missing, or what is missing for all cables.
    reasons: Vec<String>,
}

impl StepResult {
    pub fn new(step: &'static str, possible: bool, reasons: Vec<String>) -> Self {
        Self { step, possible, reasons }
    }

    /// Returns the step for a page.
    pub fn on_page(&self) -> InfoStep {
        InfoStep { name: self.step.to_owned(), is_possible: self.possible, remarks: self.reasons.clone() }
    }
}

/// Length of reasons that take two lines at most, and so are as well read again.
const SHORT: usize = 90;

/// Formats steps as a table. Reasons that a step above has as well are not repeated, unless they are short.
pub fn step_table(title: &str, steps: &[StepResult]) -> String {
    let row = |(place, step): (usize, &StepResult)| {
        let possible = if step.possible { "possible" } else { "impossible" };
        let alike = steps.iter().take(place).find(|above| above.reasons == step.reasons);
        let reasons = step.reasons.join("; ");
        let reasons = match alike {
            Some(above) if reasons.len() > SHORT => format!("as `{}`", above.step),
            _ => reasons,
        };
        [step.step.to_owned(), possible.to_owned(), reasons]
    };
    table_with_text(&[title, "", ""], 3, &steps.iter().enumerate().map(row).collect::<Vec<_>>())
}
