//! Tells a sensor force on another scale than the reference, which no friction causes, and what of the set-up has that ratio.
//!
//! A wrong scale multiplies the force: its mean and its slope over the reference. A wrong zero changes only the mean. Friction changes only the slope, if
//! the load goes with the direction of the motion. The slope is between that of either by least squares, of which one is too low by the noise of the
//! reference and the other too high by that of the force.

use super::beside::Beside;
use super::cause::{BEYOND_FRICTION, is_beyond_friction, of_changes, of_level};
use crate::text::significant;

/// Least standard deviation of a reference, as a fraction of its mean, that tells a scale from a zero. Half and twice this fraction tell the same
/// for forces that a run changes; a load that hangs still varies by a hundredth.
const LEAST_VARIATION: f64 = 0.05;
/// Greatest ratio of the changes' scale to that of the means that are of one scale. A zero of half the force makes 1.5; half and twice the difference
/// tell the same of 150 logs of sound and of wrong sensors.
const MOST_APART: f64 = 1.5;

/// Sums over a cable's samples that have a reference and a force by the sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scale {
    /// Force at the platform per force of the sensor without friction: below 1 if the sensor holds a pulley.
    frictionless_gain: f64,
    /// Whether the reference is a load that the robot file states.
    is_stated: bool,
    /// The force without any correction, and with the model's.
    forces: [Beside; 2],
}

/// How a sensor is off from the reference beyond friction.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Off {
    /// Ratio of the mean force to the mean reference.
    Level(f64),
    /// Ratio of the changes of the force to those of the reference.
    Changes(f64),
}

impl Scale {
    /// Creates empty sums for a cable whose sensor has this frictionless gain, and whose reference is measured or a load that the robot file states.
    pub fn new(frictionless_gain: f64, is_stated: bool) -> Self {
        Self { frictionless_gain, is_stated, ..Self::default() }
    }

    /// Adds a sample: the sign of the motion, its reference, and the force at the platform by the sensor without any correction and with the model's.
    pub fn add(&mut self, sign: f64, reference_n: f64, forces_n: [f64; 2]) {
        if !(reference_n.is_finite() && forces_n.iter().all(|force_n| force_n.is_finite())) {
            return;
        }
        for (beside, force_n) in self.forces.iter_mut().zip(forces_n) {
            beside.add(sign, force_n, reference_n);
        }
    }

    /// Whether sensor and reference are not on one scale.
    pub fn is_off(&self) -> bool {
        self.off().is_some()
    }

    /// Whether sensor and reference change alike, so that they are on one scale.
    pub fn is_told_alike(&self) -> bool {
        let [shown, _] = &self.forces;
        shown.changes().is_some_and(|changes| !changes.slopes.into_iter().any(is_beyond_friction))
    }

    fn off(&self) -> Option<Off> {
        self.ratio_of_levels().map(Off::Level).or_else(|| self.ratio_of_changes().map(Off::Changes))
    }

    /// Returns the ratio of the mean force to the mean reference, if, where the reference varies, that of the changes is alike, and if the model's correction
    /// does not make up for it.
    fn ratio_of_levels(&self) -> Option<f64> {
        let [shown, corrected] = &self.forces;
        let of_means = |beside: &Beside| beside.total().force / beside.total().reference;
        let ratio = Some(of_means(shown)).filter(|ratio| is_beyond_friction(*ratio) && !self.is_told_alike())?;
        if !self.varies() {
            return is_beyond_friction(of_means(corrected)).then_some(ratio);
        }
        // A fit may bend the force of a wrong scale in any way, but only the right scale brings both slopes near 1.
        if !corrected.centred().slopes().into_iter().any(is_beyond_friction) {
            return None;
        }
        let slopes = shown.centred().slopes();
        let is_alike = slopes.map(|slope| slope > 1.0) == [slopes[0] > 1.0; 2];
        let slope = slopes[0].signum() * (slopes[0] * slopes[1]).sqrt();
        let are_beyond = slopes.into_iter().all(is_beyond_friction) && is_alike;
        (are_beyond && (MOST_APART.recip()..MOST_APART).contains(&(slope / ratio))).then_some(ratio)
    }

    /// Returns the ratio of the changes, if it is that of a unit or of a sign and the model's correction does not make up for it. An offset that both columns
    /// have, as for a pretension, brings the levels of any scale together.
    fn ratio_of_changes(&self) -> Option<f64> {
        let [shown, corrected] = self.forces.map(|beside| beside.changes());
        let shown = shown?;
        let [least, greatest] = shown.beside_friction();
        let is_beyond = greatest < BEYOND_FRICTION.recip() || least > BEYOND_FRICTION;
        let is_made_up = corrected.is_some_and(|changes| !changes.slopes.into_iter().any(is_beyond_friction));
        // No gain makes up for a sign, but friction that is stored like a spring may.
        let ratio = Some(shown.slope()).filter(|ratio| is_beyond && !(is_made_up && *ratio > 0.0))?;
        of_changes(ratio).map(|_| ratio)
    }

    /// Returns by how much the force is above the reference throughout, N, where both change alike and neither friction nor the model makes up for it.
    fn zero_n(&self) -> Option<f64> {
        let [shown, corrected] = &self.forces;
        let changes = shown.changes().filter(|_| !self.is_off())?;
        let [least, greatest] = changes.beside_friction();
        let is_alike = least < BEYOND_FRICTION && greatest > BEYOND_FRICTION.recip();
        let gap_n = |beside: &Beside| (beside.total().force - beside.total().reference) / beside.total().count;
        let most_n = ((BEYOND_FRICTION - 1.0) * shown.total().reference_rms_n()).max(changes.friction_n);
        let is_beyond = [shown, corrected].into_iter().all(|beside| gap_n(beside).abs() > most_n);
        (is_alike && is_beyond).then(|| gap_n(shown))
    }

    fn varies(&self) -> bool {
        let [shown, _] = &self.forces;
        let mean_n = shown.total().reference / shown.total().count;
        shown.centred().variance() > (LEAST_VARIATION * mean_n).powi(2)
    }
}

/// Returns warnings about cables whose sensor is on another scale than the reference. Cables with the same cause share a line.
#[must_use]
pub(crate) fn warnings<'a>(cables: impl Iterator<Item = (&'a str, Scale)>) -> Vec<String> {
    type Group<'a> = ((bool, Option<&'static str>, bool, bool), Vec<&'a str>, [f64; 2]);
    let mut groups: Vec<Group<'a>> = Vec::new();
    for (name, scale) in cables {
        let Some(off) = scale.off() else { continue };
        let (kind, ratio) = match off {
            Off::Level(ratio) => {
                ((true, of_level(scale.frictionless_gain, ratio), scale.varies(), scale.is_stated), ratio)
            }
            Off::Changes(ratio) => ((false, of_changes(ratio), true, scale.is_stated), ratio),
        };
        match groups.iter_mut().find(|(other, ..)| *other == kind) {
            Some((_, names, [least, greatest])) => {
                names.push(name);
                (*least, *greatest) = (least.min(ratio), greatest.max(ratio));
            }
            None => groups.push((kind, vec![name], [ratio; 2])),
        }
    }
    let warning = |((is_level, cause, varies, is_stated), names, range): Group<'a>| {
        let [least, greatest] = range.map(significant);
        let ratio = if least == greatest { least } else { format!("{least} to {greatest}") };
        let likely = match (cause, is_stated) {
            (None, false) => "look at zero, unit and calibration of both, and at the sensor's pulley".to_owned(),
            (None, true) => {
                "look at the load that the robot file states, and at zero, unit, calibration and pulley of the sensor"
                    .to_owned()
            }
            (Some(cause), false) => format!("the likely cause is {cause}"),
            (Some(cause), true) => {
                format!("either the robot file states a load that is wrong by this factor, or it is {cause}")
            }
        };
        let (is, or) = match (is_level, varies) {
            (true, true) => ("is", ""),
            (true, false) => ("is", "; it may be its zero as well, from which a load that stays does not tell it"),
            (false, _) => ("changes by", "; a mass between them that moves fast does so as well"),
        };
        let names = names.join(", ");
        let reference = if is_level { "times the reference" } else { "times what the reference changes by" };
        format!(
            "{names}: the force by the sensor {is} {ratio} {reference}, more than friction usually makes: {likely}{or}"
        )
    };
    groups.into_iter().map(warning).collect()
}

/// Returns a warning about cables whose sensor or reference has a zero; `None` without one.
#[must_use]
pub(crate) fn zero_warning<'a>(cables: impl Iterator<Item = (&'a str, Scale)>) -> Option<String> {
    let of_cable = |(name, scale): (&str, Scale)| {
        let zero_n = scale.zero_n()?;
        let side = if zero_n > 0.0 { "above" } else { "below" };
        Some(format!("{name}: the force by the sensor is {} N {side} the reference", significant(zero_n.abs())))
    };
    let zeros: Vec<String> = cables.filter_map(of_cable).collect();
    (!zeros.is_empty()).then(|| {
        format!(
            "{} throughout, more than friction usually makes: tare both, and look at `offset` under `[log.columns]`",
            zeros.join("; ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A load of 10 N that varies with the motion, under friction of `mu` in both directions. `shown` is what the sensor makes of the force, and
    /// `corrected` the model.
    fn scale(
        shown: impl Fn(f64) -> f64,
        corrected: impl Fn(f64) -> f64,
        (swing_n, phase): (f64, f64),
        mu: f64,
    ) -> Scale {
        let mut scale = Scale::new(1.0, false);
        for sample in 0..5000 {
            let angle = 0.01 * f64::from(sample);
            let load_n = 10.0 + swing_n * (angle + phase).sin();
            let rubbed_n = load_n * (1.0 + mu * angle.sin().signum());
            scale.add(angle.sin(), load_n, [shown(rubbed_n), corrected(rubbed_n)]);
        }
        scale
    }

    const VARIED: (f64, f64) = (3.0, 1.0);
    const STEADY: (f64, f64) = (0.05, 1.0);

    fn as_it_is(force_n: f64) -> f64 {
        force_n
    }

    fn double(force_n: f64) -> f64 {
        2.0 * force_n
    }

    fn shifted(force_n: f64) -> f64 {
        force_n + 20.0
    }

    #[test]
    fn a_scale_is_told_from_friction_a_zero_and_what_the_model_has() {
        assert_eq!(scale(as_it_is, as_it_is, VARIED, 0.08).ratio_of_levels(), None);
        assert_eq!(scale(shifted, shifted, VARIED, 0.08).ratio_of_levels(), None, "a zero");
        assert_eq!(scale(double, as_it_is, VARIED, 0.08).ratio_of_levels(), None, "the model has the gain");
        assert_eq!(scale(as_it_is, double, VARIED, 0.08).ratio_of_levels(), None, "the model is wrong by itself");
        assert_eq!(scale(double, as_it_is, STEADY, 0.08).ratio_of_levels(), None, "the model has the gain");
        // Friction of 2 % in phase with a load of ± 30 % changes the slope by up to 8 %.
        for found in [
            scale(double, double, VARIED, 0.02).ratio_of_levels(),
            scale(double, double, STEADY, 0.02).ratio_of_levels(),
        ] {
            assert!(found.is_some_and(|found| (found / 2.0 - 1.0).abs() < 0.1), "{found:?}");
        }
        // The zero of a fitted model changes no slope.
        let found = scale(double, |force_n| 2.0 * force_n - 10.0, VARIED, 0.02).ratio_of_levels().unwrap();
        assert!((found / 2.0 - 1.0).abs() < 0.1, "{found}");
        // A fit to kilonewtons may have friction that makes up for a part of it.
        let bent = |force_n: f64| 1e-3 * force_n + 0.5 + 0.4 * (7.0 * force_n).sin();
        let found = scale(|force_n| 1e-3 * force_n, bent, VARIED, 0.02).ratio_of_levels().unwrap();
        assert!((found / 1e-3 - 1.0).abs() < 0.1, "{found}");
        let kilograms = |force_n: f64| force_n / 9.80665;
        let two = ["a", "b"].map(|name| (name, scale(double, double, VARIED, 0.08)));
        let told = warnings(
            two.into_iter().chain([("c", scale(kilograms, kilograms, VARIED, 0.08)), ("d", Scale::default())]),
        );
        assert!(told.len() == 2 && told[0].starts_with("a, b: ") && told[0].contains("180°"), "{told:?}");
        assert!(told[1].starts_with("c: ") && told[1].contains("a sensor in kilograms"), "{told:?}");
    }

    /// Where the load goes with the direction of the motion, friction changes the slope as a scale does.
    #[test]
    fn friction_in_phase_with_the_load_is_no_scale() {
        for phase in [0.0, 0.5, 1.6, 3.1, 4.7] {
            for swing_n in [0.6, 1.0, 3.0] {
                let found = scale(as_it_is, |force_n| 1.1 * force_n - 1.0, (swing_n, phase), 0.2).off();
                assert_eq!(found, None, "{swing_n} N, {phase} rad");
            }
        }
    }

    #[test]
    fn noise_of_a_reference_is_no_scale() {
        // The reference trembles by as much as it varies; the force does not.
        let mut scale = Scale::new(1.0, false);
        for sample in 0..5000_i32 {
            let load_n = 10.0 + (0.01 * f64::from(sample)).sin();
            let tremble_n = if sample % 2 == 0 { 1.0 } else { -1.0 };
            scale.add(0.0, load_n + tremble_n, [load_n, load_n]);
        }
        assert_eq!(scale.off(), None);
    }

    /// With one offset in both columns, as for a pretension, the levels are alike on any scale.
    #[test]
    fn a_scale_under_a_pretension_is_told_by_the_changes() {
        let stretched = |factor: f64| move |force_n: f64| 10.0 + factor * (force_n - 10.0);
        for (factor, words) in [
            (1.0 / 9.80665, "a sensor in kilograms"),
            (9.80665, "a reference in kilograms"),
            (1e3, "a reference in kilonewtons"),
            (-1.0, "the other sign"),
        ] {
            let found = scale(stretched(factor), stretched(factor), VARIED, 0.05);
            assert_eq!(found.ratio_of_levels(), None, "{factor}");
            assert!(found.ratio_of_changes().is_some_and(|ratio| (ratio / factor - 1.0).abs() < 0.1), "{factor}");
            let told = warnings([("w", found)].into_iter());
            assert!(told.len() == 1 && told[0].contains(words) && told[0].contains("w: the force"), "{told:?}");
            let off = scale(stretched(factor), as_it_is, VARIED, 0.05).off();
            assert_eq!(off.is_some(), factor < 0.0, "{factor}: the model has it");
        }
        // Friction of 2 N hides the sign of a load of ± 0.3 N.
        assert_eq!(scale(stretched(-1.0), stretched(-1.0), (0.3, 0.5), 0.2).off(), None);
        for mu in [0.0, 0.05, 0.2] {
            assert_eq!(scale(as_it_is, as_it_is, VARIED, mu).off(), None);
        }
    }

    #[test]
    fn a_zero_is_told_where_both_change_alike() {
        let zero_n = scale(shifted, shifted, VARIED, 0.05).zero_n().unwrap();
        assert!((zero_n - 20.0).abs() < 0.1, "{zero_n} N");
        assert!(
            zero_warning([("w", scale(shifted, shifted, VARIED, 0.05))].into_iter())
                .unwrap()
                .contains("N above the reference throughout")
        );
        for found in [
            scale(as_it_is, as_it_is, VARIED, 0.2),
            scale(shifted, as_it_is, VARIED, 0.05),
            scale(double, double, VARIED, 0.05),
            scale(shifted, shifted, (0.0, 1.0), 0.05),
        ] {
            assert_eq!(found.zero_n(), None);
        }
    }
}
