//! The values to write: fitted to all samples, but only where the run contradicts the file.

use fric_lab::discover::Verdict;
use fric_lab::fit::HALF_INTERVAL;
use nalgebra::{DMatrix, DVector};

use super::case::{Case, Fit};
use super::friction::fitting::{covariance, fitted};
use super::friction::model::{Model, Parameter};
use super::markers::MarkerFit;
use super::worse::{Worse, worse_shape};
use crate::shape_errors::Way;

/// The last fit with its covariance.
#[derive(Clone, Debug)]
pub struct Final {
    pub fit: Fit,
    /// The parameters of the covariance. They include a shared μ that stays as given, because keeping it does not make it known.
    parameters: Vec<Parameter>,
    covariance: Option<DMatrix<f64>>,
    /// If the given μ stays because a refit would move a disk further off: that disk, and the refitted μ.
    pub kept: Option<(Worse, f64)>,
}

impl Final {
    /// Fits an extended model. `whole` is the run with nothing held out.
    ///
    /// The μ that holes share stays as given if its 95 % interval, including the calibration's error, contains the given value, if it may contain
    /// something unexplained, or if shapes would become worse.
    pub fn new(
        whole: &Case<'_>,
        given: &Fit,
        given_markers: Option<&MarkerFit>,
        after: &Fit,
        verdict: Verdict,
        is_given: bool,
    ) -> Option<Self> {
        if verdict == Verdict::Unexplained && is_given {
            return Some(Self { fit: given.clone(), parameters: Vec::new(), covariance: None, kept: None });
        }
        let mut kept = None;
        let free = Self::of(whole, &after.model)?;
        if given.model.way == Way::None || (verdict != Verdict::Unexplained && free.contradicts(given)) {
            if given.model.way == Way::None {
                return Some(free);
            }
            let markers = MarkerFit::new(whole, &free.fit);
            match worse_shape([given, &free.fit], [given_markers, markers.as_ref()]) {
                None => return Some(free),
                Some(worse) => kept = Some((worse, shared_mu(&free.fit.model))),
            }
        }
        let mut model = after.model.clone();
        for (mu, (given_mu, is_own)) in model.mu.iter_mut().zip(given.model.mu.iter().zip(&after.model.is_own)) {
            if !is_own {
                *mu = *given_mu;
            }
        }
        model.is_shared_given = true;
        Some(Self { fit: fitted(whole, &model)?, kept, ..free })
    }

    fn of(whole: &Case<'_>, model: &Model) -> Option<Self> {
        let fit = fitted(whole, model)?;
        Some(Self { parameters: fit.model.parameters(), covariance: covariance(whole, &fit), fit, kept: None })
    }

    /// Whether the interval of the shared μ excludes the given one.
    fn contradicts(&self, given: &Fit) -> bool {
        let Some(error) = self.standard_error(Parameter::SharedMu) else {
            return false;
        };
        let [found, stated] = [&self.fit.model, &given.model].map(|model| {
            let shared = model.mu.iter().zip(&self.fit.model.is_own).find(|(_, is_own)| !**is_own);
            shared.map_or(f64::NAN, |(mu, _)| *mu)
        });
        (found - stated).abs() > HALF_INTERVAL * error
    }

    /// Returns the standard error of a fitted number; `None` for any other, and for one that the run does not determine.
    pub fn standard_error(&self, parameter: Parameter) -> Option<f64> {
        let place = self.parameters.iter().position(|fitted| *fitted == parameter)?;
        Some(self.covariance.as_ref()?.get((place, place))?.sqrt()).filter(|error| error.is_finite())
    }

    /// Returns the standard error of [`shared_mu`].
    pub fn shared_mu_error(&self) -> Option<f64> {
        if let Some(error) = self.standard_error(Parameter::SharedMu) {
            return Some(error);
        }
        let is_own = |parameter: &Parameter| matches!(parameter, Parameter::OwnMu(_));
        let own = self.parameters.iter().map(|parameter| if is_own(parameter) { 1.0 } else { 0.0 });
        let own = DVector::from_iterator(self.parameters.len(), own);
        let variance = own.dot(&(self.covariance.as_ref()? * &own)) / own.sum().powi(2);
        Some(variance.sqrt()).filter(|error| error.is_finite())
    }
}

/// Returns the μ of the holes that share one, or of the mean hole if none does.
pub fn shared_mu(model: &Model) -> f64 {
    let shared = model.mu.iter().zip(&model.is_own).find(|(_, is_own)| !**is_own);
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let mean = model.mu.iter().sum::<f64>() / model.mu.len() as f64;
    shared.map_or(mean, |(mu, _)| *mu)
}

/// Minimum relative difference of a hole's μ from that of the others to count as its own. Equal holes differ by ±10 %. At 0.2, holes are named in
/// some correct files; at twice this value, a hole with half as much friction again as the others is missed.
pub const OWN_RATIO: f64 = 0.3;

/// Returns how clearly the μ of a hole differs from that of the others; 1 is the threshold. The difference is measured in half widths of its 95 %
/// interval and in [`OWN_RATIO`]. Each μ counts relative to the value in the file, if the file states one.
pub fn is_own_mu(given: &Model, model: &Model, covariance: Option<&DMatrix<f64>>, hole: usize) -> f64 {
    let parameters = model.parameters();
    let has_given = given.mu.iter().all(|mu| *mu > 0.0);
    let unit = |place: usize| if has_given { given.mu.get(place).copied().unwrap_or(1.0) } else { 1.0 };
    let first_shared = model.is_own.iter().position(|is_own| !is_own);
    let (mut ratio, mut contrast) = (0.0, DVector::zeros(parameters.len()));
    let mut add = |place: usize, parameter: Parameter, weight: f64| {
        ratio += weight * model.mu.get(place).copied().unwrap_or(f64::NAN) / unit(place);
        if let Some(row) = parameters.iter().position(|fitted| *fitted == parameter) {
            contrast[row] += weight / unit(place);
        }
    };
    add(hole, Parameter::OwnMu(hole), 1.0);
    if let Some(shared) = first_shared {
        add(shared, Parameter::SharedMu, -1.0);
    } else {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let weight = -1.0 / model.mu.len() as f64;
        (0..model.mu.len()).for_each(|other| add(other, Parameter::OwnMu(other), weight));
    }
    let variance = covariance.map_or(f64::INFINITY, |covariance| contrast.dot(&(covariance * &contrast)));
    let own = model.mu.get(hole).copied().unwrap_or(f64::NAN) / unit(hole);
    let of_others = (own - ratio).abs();
    let is_clear = if variance.is_finite() { ratio.abs() / (HALF_INTERVAL * variance.sqrt()) } else { 0.0 };
    is_clear.min(ratio.abs() / (OWN_RATIO * of_others))
}
