//! Effects that several cables share.

use fric_core::effects::Effect;
use serde::Serialize;

use super::cable::DiscoverCableResult;
use super::effect::EffectResult;

/// An effect that several cables share.
#[derive(Clone, Debug, Serialize)]
pub struct CommonEffect {
    /// Its name in the catalogue.
    pub kind: &'static str,
    /// The cables that have it.
    pub cables: Vec<String>,
    /// Its fitted parameters over these cables.
    pub parameters: Vec<CommonParameter>,
}

/// One of its parameters.
#[derive(Clone, Debug, Serialize)]
pub struct CommonParameter {
    /// Its key.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Weighted mean over the cables; the plain mean if they differ.
    pub mean: f64,
    /// Standard error of the mean; from the scatter of the cables if they differ.
    pub standard_error: f64,
    /// Whether the cables differ by more than their errors.
    pub differs: bool,
    /// Least value over the cables.
    pub least: f64,
    /// Greatest value over the cables.
    pub greatest: f64,
}

/// The cables differ if the normalised sum of squares exceeds its expectation by this many of its own standard deviations. The limit is high because
/// the errors that a fit reports are uncertain themselves.
const DIFFERS: f64 = 5.0;

pub fn common_effects(cables: &[DiscoverCableResult]) -> Vec<CommonEffect> {
    let mut all: Vec<Effect> = Vec::new();
    for found in cables.iter().flat_map(|cable| &cable.effects) {
        if !all.contains(&found.effect) {
            all.push(found.effect);
        }
    }
    all.into_iter().filter_map(|effect| common_effect(effect, cables)).collect()
}

/// Returns an effect over the cables that have it, if there are several.
fn common_effect(effect: Effect, cables: &[DiscoverCableResult]) -> Option<CommonEffect> {
    let with: Vec<(&str, &EffectResult)> = cables
        .iter()
        .filter_map(|cable| Some((cable.name.as_str(), cable.effects.iter().find(|found| found.effect == effect)?)))
        .collect();
    // Tables have no common value.
    if effect == Effect::Empirical {
        return None;
    }
    let parameters = effect.row().parameters.iter().filter_map(|parameter| {
        let of_cable = |(_, found): &(&str, &EffectResult)| {
            Some((found.parameters.get(parameter.key)?, found.standard_errors.get(parameter.key)?))
        };
        let numbers: Vec<(f64, f64)> = with.iter().filter_map(of_cable).collect();
        CommonParameter::of(parameter.key, parameter.unit, &numbers)
    });
    (with.len() > 1).then(|| CommonEffect {
        kind: effect.kind(),
        cables: with.iter().map(|(name, _)| (*name).to_owned()).collect(),
        parameters: parameters.collect(),
    })
}

impl CommonParameter {
    /// Creates the parameter from values with their standard errors.
    fn of(key: &'static str, unit: &'static str, numbers: &[(f64, f64)]) -> Option<Self> {
        let numbers: Vec<(f64, f64)> = numbers.iter().copied().filter(|(_, error)| *error > 0.0).collect();
        #[expect(clippy::cast_precision_loss, reason = "a count of cables")]
        let count = numbers.len() as f64;
        if count < 2.0 {
            return None;
        }
        let weights: f64 = numbers.iter().map(|(_, error)| error.powi(-2)).sum();
        let weighted = numbers.iter().map(|(value, error)| value * error.powi(-2)).sum::<f64>() / weights;
        let squares: f64 = numbers.iter().map(|(value, error)| ((value - weighted) / error).powi(2)).sum();
        let freedom = count - 1.0;
        let differs = squares > freedom + DIFFERS * (2.0 * freedom).sqrt();
        let plain = numbers.iter().map(|(value, _)| value).sum::<f64>() / count;
        let scatter: f64 = numbers.iter().map(|(value, _)| (value - plain).powi(2)).sum();
        let (mean, standard_error) =
            if differs { (plain, (scatter / freedom / count).sqrt()) } else { (weighted, weights.sqrt().recip()) };
        let ends = numbers.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), (value, _)| {
            (least.min(*value), greatest.max(*value))
        });
        Some(Self { key, unit, mean, standard_error, differs, least: ends.0, greatest: ends.1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_over_cables_says_when_they_differ() {
        let of = |numbers: &[(f64, f64)]| CommonParameter::of("delay_s", "s", numbers).unwrap();
        let same = of(&[(6.0e-3, 1e-4), (6.2e-3, 1e-4), (6.1e-3, 2e-4), (6.1e-3, 2e-4)]);
        assert!(!same.differs && (same.mean - 6.1e-3).abs() < 1e-12, "{same:?}");
        assert!((same.standard_error - 1.0 / (2e8_f64 + 0.5e8).sqrt()).abs() < 1e-12, "{same:?}");
        let other = of(&[(2e-3, 1e-5), (6e-3, 1e-4)]);
        assert!(other.differs && (other.mean - 4e-3).abs() < 1e-12, "{other:?}");
        assert!((other.standard_error - 2e-3).abs() < 1e-12 && other.greatest - other.least > 3.9e-3, "{other:?}");
        assert!(CommonParameter::of("delay_s", "s", &[(1.0, 1.0), (1.0, 0.0)]).is_none());
    }
}
