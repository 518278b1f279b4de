//! A search that doubts all force sensors at once, for logs that leave something which no single candidate explains. Where every sensor is wrong, the
//! friction of the given model makes up for that, and no sensor alone explains much.

use fric_core::effects::Effect;
use fric_core::parameters::OFFSET;

use super::standing::standings;
use super::{NEAR_ERRORS, Named, Naming};
use crate::candidates::catalogue::{fitted, has};
use crate::discover::naming::evidence::delta_bic;
use crate::discover::naming::{LEAST_SIZE, STRONG_BIC};
use crate::discover::wrench::bench::{Bench, Trial};
use crate::discover::wrench::candidate::Candidate;
use crate::discover::wrench::covariance::{geometric_mean_square, whitening};

/// Maximum number of fits of the start, each with the whitening of the one before, until that changes nothing. The covariance of the given model's
/// deviations makes little of the very directions in which it misses most. With 4 and with 16, the recording of `docs/recordings.md` leads to the same
/// names, with gains within 0.01 of each other.
const FITS: usize = 8;

/// Whether a candidate is the gain or the offset of one force sensor.
pub fn is_of_one_sensor(candidate: Candidate) -> bool {
    matches!(candidate, Candidate::Own(_, Effect::SensorGain | Effect::SensorOffset))
}

/// Returns the start of the search: each force sensor has its own gain and its own offset. `None` if there are no deviations. Leaves the whitening of the
/// last fit but one.
pub fn sensors_doubted(bench: &mut Bench<'_>, base: &Trial) -> Option<Naming> {
    let mut model = base.model.clone();
    let mut named = Vec::new();
    for (cable, (free, values)) in model.free.iter_mut().zip(&model.values).enumerate() {
        let has_offset = free.iter().any(|of| of.place() == OFFSET);
        let lacking = [(Effect::SensorGain, false), (Effect::SensorOffset, has_offset)];
        for (effect, _) in lacking.into_iter().filter(|(effect, is_there)| !is_there && !has(*effect, values)) {
            free.extend(fitted(effect));
            named.push(Named { candidate: Candidate::Own(cable, effect), delta_bic: f64::NAN, runner_up: None });
        }
    }
    let from_given = bench.with_given_friction(&model);
    let [from_base, from_given] = [model, from_given].map(|model| bench.fit(&model, NEAR_ERRORS));
    let mut trial = if from_given.training < from_base.training { from_given } else { from_base };
    for _ in 1..FITS {
        bench.whitening = whitening(bench, &trial.model)?;
        let square = geometric_mean_square(bench, &trial.model, false);
        trial = bench.fit(&trial.model, NEAR_ERRORS);
        if geometric_mean_square(bench, &trial.model, false) > (1.0 - LEAST_SIZE) * square {
            break;
        }
    }
    Some(Naming { trial, named, tried: Vec::new(), is_complete: false })
}

/// Whether the evidence for one outcome beside another is strong and holds on the held-out samples. Each is judged by the covariance of its own deviations
/// (determinant criterion; G. E. P. Box, N. R. Draper, *The Bayesian estimation of common parameters from several responses*, Biometrika 52, 1965): the
/// whitening of the one would count little of what the other explains in the directions in which the one leaves much.
pub fn is_better(bench: &Bench<'_>, one: &Naming, other: &Naming) -> bool {
    let is_new = |of: &Candidate| !other.named.iter().any(|named| named.candidate == *of);
    let new: Vec<Candidate> = one.named.iter().map(|named| named.candidate).filter(is_new).collect();
    let inflation = standings(bench, &one.trial, &new).iter().map(|of| of.inflation).fold(1.0, f64::max);
    let ratio = |held_out: bool| {
        let [one, other] = [one, other].map(|of| geometric_mean_square(bench, &of.trial.model, held_out));
        one / other
    };
    let [one, other] = [one, other].map(|of| of.trial.model.unknowns().len());
    #[expect(clippy::cast_precision_loss, reason = "counts")]
    let (count, more) = (6.0 * bench.count(false) as f64 / inflation, one as f64 - other as f64);
    ratio(true) < 1.0 && delta_bic(count, ratio(false), more) < -STRONG_BIC
}
