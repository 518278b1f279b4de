//! The positions of a cable's pulleys in the order of the cycle.

use crate::pulley::{traction_ratio, wrap_factor};
use crate::robot::{CableParams, MAX_PULLEYS, Wrap};

/// Number of pulley positions: a sensor in line with the cable takes one of its own.
pub const PLACES: usize = MAX_PULLEYS + 1;
/// Beyond every tension ratio, with an inverse that is still a normal number.
pub const NO_SLIP: f64 = 1e200;
/// Wrap factor of a pulley that follows the pose, before the first pose: 90°.
pub const START_WRAP_FACTOR: f64 = core::f64::consts::SQRT_2;

/// The pulleys of one cable, position by position.
///
/// Pulleys occupy the positions from the first on, except that a pulley that follows the pose is at the last position, which is the same for all
/// cables of a robot. Positions without a pulley lie before it.
#[derive(Clone, Copy, Debug)]
pub struct Places {
    /// 1 where there is a pulley, else 0.
    pub has_pulley: [f64; PLACES],
    /// Number of the pulley, counted from 1 at the sensor; 0 where there is none.
    pub number: [f64; PLACES],
    /// `j/n` at pulley j of n, from the winch: the fraction of the cable's stretch before it.
    pub stretch_ratio: [f64; PLACES],
    /// `2 sin(α/2)` of fixed wraps.
    pub wrap_factor: [f64; PLACES],
    /// `e^{μ_p α}` of fixed wraps; [`NO_SLIP`] without a slip limit.
    pub traction_ratio: [f64; PLACES],
    /// Position of each pulley; [`PLACES`] for those that the cable does not have.
    pub of_pulley: [usize; MAX_PULLEYS],
}

impl Places {
    /// Returns the number of positions that a cable needs.
    pub fn needed(params: &CableParams) -> usize {
        params.pulley_count + usize::from(params.sensor_wrap_rad.is_none())
    }

    /// Returns the positions of a cable; `place_count` must be at least [`needed`](Self::needed).
    pub fn new(params: &CableParams, place_count: usize) -> Self {
        let mut places = Self {
            has_pulley: [0.0; PLACES],
            number: [0.0; PLACES],
            stretch_ratio: [0.0; PLACES],
            wrap_factor: [0.0; PLACES],
            traction_ratio: [NO_SLIP; PLACES],
            of_pulley: [PLACES; MAX_PULLEYS],
        };
        let first_place = usize::from(params.sensor_wrap_rad.is_none());
        let pulleys = params.wraps.iter().take(params.pulley_count).zip(&mut places.of_pulley).enumerate();
        for (pulley, (wrap, stands_at)) in pulleys {
            *stands_at = if *wrap == Wrap::Pose { place_count - 1 } else { first_place + pulley };
            let at = |column: &mut [f64; PLACES], value| {
                if let Some(place) = column.get_mut(*stands_at) {
                    *place = value;
                }
            };
            at(&mut places.has_pulley, 1.0);
            #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
            let [number, count] = [pulley + 1, params.pulley_count].map(|count| count as f64);
            at(&mut places.number, number);
            at(&mut places.stretch_ratio, number / count);
            if let Wrap::Fixed { wrap_rad } = *wrap {
                at(&mut places.wrap_factor, wrap_factor(wrap_rad));
                if let Some(traction_mu) = params.traction_mu {
                    at(&mut places.traction_ratio, traction_ratio(traction_mu, wrap_rad));
                }
            }
        }
        places
    }
}
