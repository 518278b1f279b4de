//! What was found for all cables together by the wrench, in words.

use crate::discover::result::{WrenchComponent, WrenchGap};
use crate::replay::WrenchReference;

impl WrenchGap {
    /// Returns what the forces were compared with.
    #[must_use]
    pub fn title(&self) -> &'static str {
        if self.reference == WrenchReference::Mass.name() { "wrench, by mass" } else { "wrench" }
    }

    /// Returns the findings for all cables together, as sentences.
    #[must_use]
    pub fn in_words(&self) -> Vec<String> {
        let alike = self.alike.iter().map(|kind| format!("All cables have {kind} alike, with one value."));
        let wrong = self.geometry.iter().map(|wrong| {
            let numbers = wrong.parameters.0.iter().map(|(name, number)| format!("{name} = {number:.5}"));
            let of = wrong.cable.as_ref().map_or_else(String::new, |cable| format!(" of {cable}"));
            let numbers: Vec<String> = numbers.collect();
            format!("The robot file's {}{of} is wrong: {}.", wrong.kind, numbers.join(", "))
        });
        let tried =
            self.tried.iter().map(|tried| format!("Tried for all cables together: {}: {}.", tried.kind, tried.reason));
        alike.chain(wrong).chain(tried).collect()
    }
}

impl WrenchComponent {
    /// Returns name, noise, and root mean square before and after.
    #[must_use]
    pub fn cells(&self) -> [String; 4] {
        let unit = if self.name.ends_with("_nm") { "Nm" } else { "N" };
        let cell = |number: f64| format!("{number:.4} {unit}");
        let name = self.name.split('_').next().unwrap_or(self.name).to_owned();
        [name, cell(self.noise), cell(self.before), cell(self.after)]
    }
}
