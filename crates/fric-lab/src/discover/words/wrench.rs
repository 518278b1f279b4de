//! What was found for all cables together by the wrench, in words.

use crate::discover::report::Verdict;
use crate::discover::result::{GeometryResult, WrenchComponent, WrenchGap};
use crate::discover::wrench::Geometry;
use crate::replay::WrenchReference;
use crate::text::significant;

/// What to do about a rest of the wrench that is of no cable.
pub const FROM_OUTSIDE: &str =
    "Look for what acts on the platform and is not in the log: a force from outside, a load that changes.";

impl WrenchGap {
    /// Returns what the forces were compared with.
    #[must_use]
    pub fn title(&self) -> &'static str {
        if self.reference == WrenchReference::Mass { "wrench, by mass" } else { "wrench" }
    }

    /// Returns the entries of the robot file that are wrong, as sentences.
    #[must_use]
    pub fn corrections(&self) -> Vec<String> {
        let correction = |wrong: &GeometryResult| {
            let numbers = wrong.parameters.0.iter().map(|(name, number)| format!("{name} = {number:.5}"));
            let numbers: Vec<String> = numbers.collect();
            format!("The robot file's {} is wrong: {}.", of_cable(wrong.kind, wrong.cable.as_ref()), numbers.join(", "))
        };
        self.geometry.iter().map(correction).collect()
    }

    /// Returns the findings for all cables together, as sentences.
    #[must_use]
    pub fn in_words(&self) -> Vec<String> {
        let alike = self.alike.iter().map(|kind| format!("All cables have {kind} alike, with one value."));
        let tried = self.tried.iter().map(|tried| {
            let together = if tried.cable.is_none() { " for all cables together" } else { "" };
            format!("Tried{together}: {}: {}.", of_cable(&tried.kind, tried.cable.as_ref()), tried.reason)
        });
        // The forces are known up to a common factor, with which the friction goes.
        let names_mass = self.geometry.iter().any(|wrong| wrong.kind == Geometry::Mass.key());
        let scale = (names_mass && self.reference == WrenchReference::Mass).then(|| {
            "By the weight alone, a wrong mass cannot be told from force sensors that all show too much or too little by the \
             same factor: weigh the platform, or check one sensor with a known load."
                .to_owned()
        });
        let rest = self.after.filter(|_| self.verdict == Verdict::Unexplained).map(|after| {
            let [after, noise] =
                [after, self.noise_floor].map(|of| format!("{:.4} N and {:.4} Nm", of.force_rms_n, of.torque_rms_nm));
            format!("Of the wrench {after} are left, where the noise is {noise}.")
        });
        let inertia = self.inertia_kg_m2.map(|[xx, _, _, yy, _, zz]| {
            let [xx, yy, zz] = [xx, yy, zz].map(significant);
            format!("The platform's moments of inertia by the log are {xx}, {yy} and {zz} kg m²; `-o` writes the tensor as inertia_kg_m2.")
        });
        let from_outside =
            self.is_of_no_cable.then(|| format!("No error of one cable's force accounts for it. {FROM_OUTSIDE}"));
        alike
            .chain(self.corrections())
            .chain(scale)
            .chain(inertia)
            .chain(tried)
            .chain(rest)
            .chain(from_outside)
            .collect()
    }
}

/// Returns a name, with the cable that it is of.
fn of_cable(name: &str, cable: Option<&String>) -> String {
    cable.map_or_else(|| name.to_owned(), |cable| format!("{name} of {cable}"))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::result::{Evidence, TriedTogether};
    use crate::errors::WrenchError;
    use crate::numbers::Numbers;

    fn gap(reference: WrenchReference, geometry: Vec<GeometryResult>) -> WrenchGap {
        WrenchGap {
            is_of_no_cable: false,
            inertia_kg_m2: None,
            reference,
            verdict: Verdict::Extended,
            before: None,
            after: None,
            noise_floor: WrenchError { force_rms_n: 0.1, torque_rms_nm: 0.01 },
            components: Vec::new(),
            alike: Vec::new(),
            geometry,
            tried: Vec::new(),
        }
    }

    #[test]
    fn a_mass_by_the_weight_is_told_with_what_looks_like_it() {
        let mass = GeometryResult {
            kind: Geometry::Mass.key(),
            cable: None,
            parameters: Numbers(vec![("mass_kg".to_owned(), 1.04)]),
            evidence: Evidence { delta_bic: None, held_out_rms_n: None },
        };
        let warns = |gap: WrenchGap| gap.in_words().iter().any(|sentence| sentence.contains("weigh the platform"));
        assert!(warns(gap(WrenchReference::Mass, vec![mass.clone()])));
        assert!(!warns(gap(WrenchReference::Mass, Vec::new())));
        assert!(!warns(gap(WrenchReference::Measured, vec![mass])));
    }

    #[test]
    fn what_was_tried_is_told_with_its_cable() {
        let tried = |kind: &str, cable: Option<&str>| TriedTogether {
            kind: kind.to_owned(),
            cable: cable.map(ToOwned::to_owned),
            reason: "it is weak".to_owned(),
        };
        let tried = vec![tried("platform_m", Some("cable3")), tried("sensor_gain", None)];
        let told = WrenchGap { tried, ..gap(WrenchReference::Measured, Vec::new()) }.in_words();
        let expected =
            ["Tried: platform_m of cable3: it is weak.", "Tried for all cables together: sensor_gain: it is weak."];
        assert_eq!(told, expected);
    }
}
