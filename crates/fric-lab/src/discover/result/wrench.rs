//! Findings for all cables together, by the wrench.

use serde::Serialize;

use super::effect::Evidence;
use super::finite;
use crate::discover::Verdict;
use crate::discover::wrench::{GeometryFinding, WrenchDiscovery};
use crate::errors::WrenchError;
use crate::numbers::Numbers;
use crate::replay::WrenchReference;

/// Names of the components with their units.
const COMPONENTS: [&str; 6] = ["fx_n", "fy_n", "fz_n", "tx_nm", "ty_nm", "tz_nm"];

/// The wrench error before and after, and the findings about the whole robot.
#[derive(Clone, Debug, Serialize)]
pub struct WrenchGap {
    /// The reference.
    pub reference: WrenchReference,
    /// Verdict for all cables together.
    pub verdict: Verdict,
    /// Error of the given model, fitted, on held-out samples.
    pub before: Option<WrenchError>,
    /// Error of the extended model on held-out samples.
    pub after: Option<WrenchError>,
    /// White noise.
    pub noise_floor: WrenchError,
    /// The six components.
    pub components: Vec<WrenchComponent>,
    /// Effects that all cables share, with one value.
    pub alike: Vec<&'static str>,
    /// Entries of the robot file that are wrong.
    pub geometry: Vec<GeometryResult>,
    /// Fitted inertia tensor about the centre of mass, kg m², xx, xy, xz, yy, yz, zz, if the wrench is that of the mass and the log determines it.
    pub inertia_kg_m2: Option<[f64; 6]>,
    /// Findings for all cables together that help but do not suffice.
    pub tried: Vec<TriedTogether>,
    /// Whether something is left that no error of one cable's force accounts for.
    #[serde(skip)]
    pub is_of_no_cable: bool,
}

/// One component of the wrench.
#[derive(Clone, Debug, Serialize)]
pub struct WrenchComponent {
    /// `fx_n` … `tz_nm`, the unit with it.
    pub name: &'static str,
    /// Standard deviation of the component's white noise.
    pub noise: f64,
    /// Root mean square error of the given model.
    pub before: f64,
    /// Root mean square error of the extended model.
    pub after: f64,
}

/// Entries of the robot file that are wrong.
#[derive(Clone, Debug, Serialize)]
pub struct GeometryResult {
    /// Key in the robot file.
    pub kind: &'static str,
    /// The cable, if the entry belongs to one.
    pub cable: Option<String>,
    /// The correct values.
    pub parameters: Numbers,
    /// Evidence for the correction.
    pub evidence: Evidence,
}

/// A finding for all cables together that helps but does not suffice.
#[derive(Clone, Debug, Serialize)]
pub struct TriedTogether {
    /// Name of the effect, or key of the robot file.
    pub kind: String,
    /// The cable, if the entry belongs to one.
    pub cable: Option<String>,
    /// The reason why it is not named, as a clause.
    pub reason: String,
}

impl WrenchGap {
    pub(super) fn of(found: &WrenchDiscovery, names: &[String]) -> Self {
        let parts = found.noise.iter().zip(found.before.components.iter().zip(&found.after.components));
        let component = |(name, (noise, (before, after))): (&&'static str, (&f64, (&f64, &f64)))| WrenchComponent {
            name,
            noise: *noise,
            before: *before,
            after: *after,
        };
        let name = |cable: Option<usize>| cable.and_then(|cable| names.get(cable).cloned());
        let geometry = |of: &GeometryFinding| GeometryResult {
            kind: of.geometry.key(),
            cable: name(of.geometry.cable()),
            parameters: Numbers(
                of.geometry
                    .names()
                    .iter()
                    .zip(&of.numbers)
                    .map(|(name, number)| ((*name).to_owned(), *number))
                    .collect(),
            ),
            evidence: Evidence { delta_bic: finite(of.delta_bic), held_out_rms_n: None },
        };
        let length = |parts: &[f64]| parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        let (force, torque) = found.noise.split_at(3);
        Self {
            reference: found.reference,
            verdict: found.verdict,
            is_of_no_cable: found.is_of_no_cable,
            inertia_kg_m2: found.inertia_kg_m2,
            before: WrenchError::of(&found.before.errors),
            after: WrenchError::of(&found.after.errors),
            noise_floor: WrenchError { force_rms_n: length(force), torque_rms_nm: length(torque) },
            components: COMPONENTS.iter().zip(parts).map(component).collect(),
            alike: found.alike.iter().map(|effect| effect.kind()).collect(),
            geometry: found.geometry.iter().map(geometry).collect(),
            tried: found
                .tried
                .iter()
                .map(|(kind, cable, refusal)| TriedTogether {
                    kind: kind.clone(),
                    cable: name(*cable),
                    reason: refusal.in_words(),
                })
                .collect(),
        }
    }
}
