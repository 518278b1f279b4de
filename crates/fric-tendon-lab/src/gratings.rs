//! The gratings of a manipulator over a run: converts shifts to tensions, removes the temperature effect, and finds and interpolates dead gratings.
//!
//! A grating counts as dead in a sample if its shift is not finite, if the shift stays bit-identical while the tension changes, or if its tension is
//! so disproportionate to that of its neighbours that friction in a hole cannot explain it.

use std::ops::Range;

use fric_tendon::file::{ManipulatorFile, OneOrEach};
use fric_tendon::{ManipulatorParams, Tendon};

use super::error::ContinuumError;
use super::fbg::{
    Calibration, GratingPlace, LineError, StrainForm, Tension, bridged, check_travel, without_temperature,
};
use super::run::{Run, RunSample};

/// This many equal consecutive shifts are no measurement.
const FROZEN_SAMPLES: usize = 10;
/// Distance from the neighbours beyond which a grating is dead: a fraction of the local tension, plus a fraction of the run's greatest tension, plus
/// a number of standard errors.
const FAR_RATIO: f64 = 0.3;
const FAR_OF_GREATEST_RATIO: f64 = 0.1;
const FAR_ERRORS: f64 = 8.0;

/// Error of a line relative to the standard error of a tension from one shift, used if only the latter is stated: that at the ends of ten evenly
/// spaced loads, `√(h/(1 + h))` with the leverage `h = 1/10 + 4.5²/82.5`.
const USUAL_LINE_RATIO: f64 = 0.5;

/// Range of the ratio of the gratings' tension to the tension at the base that friction, a load and a rough calibration can explain; the smallest
/// ratio of two units is 9.8.
const PLAUSIBLE_SCALE: Range<f64> = 0.2..6.0;
/// Fraction of the greatest tension above which the ratio of two tensions is meaningful.
const LOADED_RATIO: f64 = 0.2;

/// The gratings of the first tendon.
#[derive(Clone, Debug, PartialEq)]
pub struct Gratings {
    lines: Vec<Calibration>,
    /// The uncertainties of the lines.
    line_errors: Vec<LineError>,
    /// Drift of each shift over the time of the run, nm/s.
    drift_nm_per_s: Vec<f64>,
    /// Common shift of all gratings from a time on, nm, and that time, s.
    common_step: (f64, f64),
    /// Bragg wavelengths of the gratings and of the reference, nm.
    wavelength_nm: Option<(Vec<f64>, f64)>,
    places: Option<Vec<GratingPlace>>,
}

/// The tensions of the gratings at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct GratingSample {
    /// Tension in each segment, N.
    pub tension: Vec<Tension>,
    /// Whether the grating of a segment is dead and its tension interpolated.
    pub is_bridged: Vec<bool>,
}

impl Gratings {
    /// Creates gratings from calibrations alone.
    #[must_use]
    pub fn new(lines: Vec<Calibration>) -> Self {
        let line_errors = lines.iter().map(Calibration::line_error).collect();
        Self {
            drift_nm_per_s: vec![0.0; lines.len()],
            common_step: (0.0, 0.0),
            line_errors,
            lines,
            wavelength_nm: None,
            places: None,
        }
    }

    /// Returns the gratings of a manipulator file; `None` if it has none.
    ///
    /// # Errors
    /// Returns [`ContinuumError::OptionOutOfRange`] for numbers that no fibre has.
    pub fn from_file(file: &ManipulatorFile) -> Result<Option<Self>, ContinuumError> {
        let Some(table) = &file.tables().gratings else { return Ok(None) };
        let count = file.params().disk_count();
        let of_each = |values: &[f64], grating: usize| match values {
            [one] => Some(*one),
            each => each.get(grating).copied(),
        };
        let stated = |values: &Option<OneOrEach>, grating: usize| {
            values.as_ref().and_then(|values| of_each(values.as_slice(), grating))
        };
        let line = |grating: usize| {
            if let Some(newton_per_nm) = table.newton_per_nm.get(grating) {
                let of = |list: &[f64]| list.get(grating).copied().unwrap_or(0.0);
                return Ok(Calibration::known(*newton_per_nm, of(&table.offset_n), of(&table.standard_error_n)));
            }
            StrainForm {
                wavelength_nm: stated(&table.wavelength_nm, grating).unwrap_or(f64::NAN),
                photoelastic_ratio: table.photoelastic_ratio.unwrap_or(f64::NAN),
                axial_stiffness_n: file.params().axial_stiffness_n(Tendon::Agonist),
            }
            .calibration()
        };
        let wavelengths: Option<Vec<f64>> = (0..count).map(|grating| stated(&table.wavelength_nm, grating)).collect();
        #[expect(clippy::cast_precision_loss, reason = "a number of gratings")]
        let wavelength_nm = wavelengths.map(|all| {
            let mean_nm = all.iter().sum::<f64>() / all.len() as f64;
            (all, table.reference_wavelength_nm.unwrap_or(mean_nm))
        });
        let line_error = |grating: usize| {
            let of = |list: &[f64]| list.get(grating).copied();
            let usual_n = USUAL_LINE_RATIO * of(&table.standard_error_n).unwrap_or(0.0);
            LineError {
                line_error_n: of(&table.line_error_n).unwrap_or(usual_n),
                slope_error_n_per_nm: of(&table.slope_error_n_per_nm).unwrap_or(0.0),
                mean_shift_nm: of(&table.mean_shift_nm).unwrap_or(0.0),
            }
        };
        let place = |grating: usize| {
            Some(GratingPlace {
                from_base_side_m: stated(&table.from_base_side_m, grating)?,
                length_m: stated(&table.length_m, grating)?,
            })
        };
        Ok(Some(Self {
            lines: (0..count).map(line).collect::<Result<_, _>>()?,
            line_errors: (0..count).map(line_error).collect(),
            drift_nm_per_s: (0..count)
                .map(|grating| table.drift_nm_per_s.get(grating).copied().unwrap_or(0.0))
                .collect(),
            common_step: (table.common_step_nm.unwrap_or(0.0), table.common_step_s.unwrap_or(f64::NEG_INFINITY)),
            wavelength_nm,
            places: (0..count).map(place).collect(),
        }))
    }

    /// Returns the line of each grating, starting at the base.
    #[must_use]
    pub fn lines(&self) -> &[Calibration] {
        &self.lines
    }

    /// Returns the uncertainty of each line.
    #[must_use]
    pub fn line_errors(&self) -> &[LineError] {
        &self.line_errors
    }

    /// Returns the Bragg wavelengths of the gratings and of the reference, nm, which allow to remove the temperature effect.
    #[must_use]
    pub fn wavelengths_nm(&self) -> Option<(&[f64], f64)> {
        self.wavelength_nm.as_ref().map(|(all, reference)| (all.as_slice(), *reference))
    }

    /// Checks that every grating stays within its segment up to a bend, \[C\] 6; passes if the positions are not stated.
    ///
    /// # Errors
    /// Returns the errors of [`check_travel`].
    pub fn check_travel(&self, params: &ManipulatorParams, greatest_bend_rad: f64) -> Result<(), ContinuumError> {
        self.places.as_ref().map_or(Ok(()), |places| check_travel(params, places, greatest_bend_rad))
    }

    /// Returns the tensions of one sample from the lines, with the common step, the drift since the run's first sample and, if a reference and
    /// wavelengths are available, the temperature effect removed.
    #[must_use]
    pub fn tensions(&self, sample: &RunSample, elapsed_s: f64) -> Vec<Tension> {
        let reference_nm = sample.shift_reference_nm;
        let shift_nm = match &self.wavelength_nm {
            Some((all, reference)) if reference_nm.is_finite() => {
                without_temperature(&sample.shift_nm, reference_nm, all, *reference)
            }
            _ => sample.shift_nm.clone(),
        };
        let drift_nm = self.drift_nm_per_s.iter().map(|drift_nm_per_s| drift_nm_per_s * elapsed_s);
        let (step_nm, from_s) = self.common_step;
        let step_nm = if sample.time_s >= from_s { step_nm } else { 0.0 };
        let lines = self.lines.iter().zip(shift_nm).zip(drift_nm);
        lines.map(|((line, shift_nm), drift_nm)| line.tension(shift_nm - drift_nm - step_nm)).collect()
    }

    /// Returns the tensions of a whole run with dead gratings interpolated.
    ///
    /// # Errors
    /// Returns [`ContinuumError::WrongCount`] for a run with another number of gratings, or [`ContinuumError::AllDead`] if none is alive in any
    /// sample.
    pub fn read(&self, run: &Run) -> Result<Vec<GratingSample>, ContinuumError> {
        Self::bridged(run, self.unbridged(run)?)
    }

    /// Returns the tensions of a whole run with dead gratings, and those that are NaN, interpolated.
    pub(super) fn bridged(run: &Run, tensions: Vec<Vec<Tension>>) -> Result<Vec<GratingSample>, ContinuumError> {
        let base_n = run.samples().iter().map(|sample| sample.tension_base_n);
        let greatest_n = base_n.clone().chain(tensions.iter().map(|all| middle(all))).fold(0.0, f64::max);
        let whole: Vec<GratingSample> =
            tensions.into_iter().zip(base_n).map(|(tension, base_n)| judged(tension, base_n, greatest_n)).collect();
        let is_alive = |sample: &GratingSample| sample.is_bridged.iter().any(|is_bridged| !is_bridged);
        if whole.iter().any(is_alive) { Ok(whole) } else { Err(ContinuumError::AllDead) }
    }

    /// Returns the tensions of a whole run without interpolation; NaN if a grating is silent or frozen.
    ///
    /// # Errors
    /// Returns [`ContinuumError::WrongCount`] for a run with another number of gratings, or [`ContinuumError::GratingUnit`] if all of them differ
    /// from the tension at the base by a factor that friction cannot explain.
    pub fn unbridged(&self, run: &Run) -> Result<Vec<Vec<Tension>>, ContinuumError> {
        let count = self.lines.len();
        if count != run.disk_count() {
            return Err(ContinuumError::WrongCount { what: "gratings", count, needed: run.disk_count() });
        }
        let samples = run.samples();
        let start_s = samples.first().map_or(0.0, |first| first.time_s);
        let mut tensions: Vec<Vec<Tension>> =
            samples.iter().map(|sample| self.tensions(sample, sample.time_s - start_s)).collect();
        if let Some(ratio) = scale(samples, &tensions).filter(|ratio| !PLAUSIBLE_SCALE.contains(ratio)) {
            return Err(ContinuumError::GratingUnit { ratio });
        }
        for grating in 0..count {
            for place in frozen(samples, &tensions, grating) {
                if let Some(tension) = tensions.get_mut(place).and_then(|sample| sample.get_mut(grating)) {
                    tension.value_n = f64::NAN;
                }
            }
        }
        Ok(tensions)
    }
}

/// Returns the median of the finite tensions; NaN if there are none.
fn middle(tensions: &[Tension]) -> f64 {
    let mut all: Vec<f64> = tensions.iter().map(|tension| tension.value_n).filter(|value| value.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Returns the ratio of the gratings' tension to the tension at the base; `None` unless it is similar in most samples under load.
fn scale(samples: &[RunSample], tensions: &[Vec<Tension>]) -> Option<f64> {
    let greatest_n = samples.iter().map(|sample| sample.tension_base_n).fold(0.0, f64::max);
    let loaded = samples.iter().zip(tensions).filter(|(sample, _)| sample.tension_base_n > LOADED_RATIO * greatest_n);
    let mut ratios: Vec<f64> = loaded.map(|(sample, all)| middle(all) / sample.tension_base_n).collect();
    ratios.retain(|ratio| ratio.is_finite());
    ratios.sort_by(f64::total_cmp);
    let at = |eighths: usize| ratios.get(ratios.len() * eighths / 8).copied();
    let (least, ratio, most) = (at(1)?, at(4)?, at(7)?);
    (least > ratio / 3.0 && most < ratio * 3.0).then_some(ratio)
}

/// Returns the samples in which the shift of a grating is frozen while the tension changes.
fn frozen(samples: &[RunSample], tensions: &[Vec<Tension>], grating: usize) -> Vec<usize> {
    let shift = |place: usize| samples.get(place).and_then(|sample| sample.shift_nm.get(grating)).copied();
    let load_n = |place: usize| match (samples.get(place), tensions.get(place)) {
        (Some(sample), _) if sample.tension_base_n.is_finite() => sample.tension_base_n,
        (_, Some(all)) => middle(all),
        _ => f64::NAN,
    };
    let mut found = Vec::new();
    let mut start = 0;
    while start < samples.len() {
        let first = shift(start).map(f64::to_bits);
        let end =
            (start..samples.len()).find(|&place| shift(place).map(f64::to_bits) != first).unwrap_or(samples.len());
        let loads = (start..end).map(load_n);
        let least_n = loads.clone().fold(f64::INFINITY, f64::min);
        let most_n = loads.fold(f64::NEG_INFINITY, f64::max);
        let error_n = tensions.get(start).and_then(|all| all.get(grating)).map_or(0.0, |one| one.standard_error_n);
        if end - start >= FROZEN_SAMPLES && most_n - least_n > FAR_ERRORS * error_n + 0.02 * most_n.abs() {
            found.extend(start..end);
        }
        start = end;
    }
    found
}

/// Removes disproportionate tensions from one sample, the worst first, and interpolates them.
fn judged(mut tension: Vec<Tension>, base_n: f64, greatest_n: f64) -> GratingSample {
    loop {
        let far = (0..tension.len()).filter_map(|place| Some((place, excess_n(&tension, base_n, greatest_n, place)?)));
        let worst = far.max_by(|(_, one), (_, other)| one.total_cmp(other));
        match worst.and_then(|(place, _)| tension.get_mut(place)) {
            Some(worst) => worst.value_n = f64::NAN,
            None => break,
        }
    }
    interpolated(tension, base_n)
}

/// Interpolates the tensions of one sample that are NaN.
pub(super) fn interpolated(mut tension: Vec<Tension>, base_n: f64) -> GratingSample {
    let values: Vec<f64> = tension.iter().map(|tension| tension.value_n).collect();
    if !values.iter().any(|value| value.is_finite()) {
        // Without any tension there is nothing to interpolate.
        return GratingSample { is_bridged: vec![true; values.len()], tension };
    }
    let (whole, is_bridged) = bridged(base_n, &values);
    for ((tension, value_n), is_bridged) in tension.iter_mut().zip(whole).zip(&is_bridged) {
        // Nothing was measured there. A tenth of the tension is more than a hole removes at usual bends.
        if *is_bridged {
            *tension = Tension { value_n, standard_error_n: tension.standard_error_n.max(0.1 * value_n.abs()) };
        }
    }
    GratingSample { tension, is_bridged }
}

/// Returns how much further a live grating is from its neighbours than friction allows; `None` if it is not.
fn excess_n(tension: &[Tension], base_n: f64, greatest_n: f64, place: usize) -> Option<f64> {
    let own = tension.get(place).filter(|own| own.value_n.is_finite())?;
    let live = |tension: &&Tension| tension.value_n.is_finite();
    let before = tension.iter().take(place).rev().find(live).map(|tension| tension.value_n);
    let before_n = before.or(Some(base_n).filter(|base_n| base_n.is_finite()));
    let behind_n = tension.iter().skip(place + 1).find(live).map(|tension| tension.value_n);
    let expected_n = match (before_n, behind_n) {
        (Some(before_n), Some(behind_n)) => 0.5 * (before_n + behind_n),
        (Some(only_n), None) | (None, Some(only_n)) => only_n,
        (None, None) => return None,
    };
    let allowed_n =
        FAR_RATIO * expected_n.abs() + FAR_OF_GREATEST_RATIO * greatest_n + FAR_ERRORS * own.standard_error_n;
    Some((own.value_n - expected_n).abs() - allowed_n).filter(|excess_n| *excess_n > 0.0)
}
