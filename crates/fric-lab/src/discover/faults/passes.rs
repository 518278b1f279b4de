//! What a residual repeats each time the cable passes a place.

use crate::fit::CableRecord;

/// Number of parts of the range of the length, for each direction. What has at most half as many waves in a stroke is seen to repeat. Hum of the mains has
/// more in strokes of a second or longer, which matters because strokes that take whole seconds would make it repeat too. With half of the parts harmonics of
/// the strokes of a real cylinder were taken for hum, with double none.
const PARTS: usize = 32;
/// Number of passes that a mean needs. Of an oscillation that does not follow the cable it takes away a sixth then.
const FEWEST_PASSES: usize = 6;

/// The part of the range, and the direction, in which the cable is in each row; `None` at rest.
pub struct Passes(Vec<Option<usize>>);

impl Passes {
    /// No passes.
    #[cfg(test)]
    pub const fn none() -> Self {
        Self(Vec::new())
    }

    /// The passes of a cable.
    pub fn of(record: &CableRecord<'_>) -> Self {
        let lengths_m = || record.rows.iter().map(|row| row.signals.length_m).filter(|length_m| length_m.is_finite());
        let (least_m, greatest_m) =
            (lengths_m().fold(f64::INFINITY, f64::min), lengths_m().fold(f64::NEG_INFINITY, f64::max));
        let part = |length_m: f64, speed_m_per_s: f64| {
            #[expect(clippy::cast_precision_loss, reason = "a small constant")]
            let part = (length_m - least_m) / (greatest_m - least_m) * PARTS as f64;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
            let part = (part.is_finite() && speed_m_per_s.abs() > 0.0).then(|| (part as usize).min(PARTS - 1));
            part.map(|part| if speed_m_per_s > 0.0 { part } else { part + PARTS })
        };
        Self(record.rows.iter().map(|row| part(row.signals.length_m, row.signals.speed_m_per_s)).collect())
    }

    /// Returns a residual less its mean over the passes of each part. Where there are too few, it stays.
    pub fn less_what_repeats(&self, residual: &[f64]) -> Vec<f64> {
        let mut sums = [(0.0, 0.0, 0_usize); 2 * PARTS];
        let mut before = None;
        for (part, number) in self.0.iter().zip(residual) {
            if let Some((sum, count, passes)) = part.and_then(|part| sums.get_mut(part)) {
                if number.is_finite() {
                    (*sum, *count) = (*sum + number, *count + 1.0);
                }
                *passes += usize::from(before != *part);
            }
            before = *part;
        }
        let mean = |part: &Option<usize>| match part.and_then(|part| sums.get(part)) {
            Some((sum, count, passes)) if *passes >= FEWEST_PASSES && *count > 0.0 => sum / count,
            _ => 0.0,
        };
        let parts = self.0.iter().chain(std::iter::repeat(&None));
        parts.zip(residual).map(|(part, number)| number - mean(part)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{FEWEST_PASSES, PARTS, Passes};

    /// Strokes that take 4 rows a part, up and down.
    fn strokes(count: usize) -> Passes {
        let stroke = |stroke: usize| {
            (0..4 * PARTS)
                .map(move |row| Some(if stroke.is_multiple_of(2) { row / 4 } else { 2 * PARTS - 1 - row / 4 }))
        };
        Passes((0..count).flat_map(stroke).collect())
    }

    #[test]
    fn what_goes_with_place_and_direction_repeats() {
        let passes = strokes(2 * FEWEST_PASSES);
        let residual: Vec<f64> = passes
            .0
            .iter()
            .map(|part| part.map_or(0.0, |part| f64::from(u8::try_from(part * part % 7).unwrap())))
            .collect();
        assert!(passes.less_what_repeats(&residual).iter().all(|number| number.abs() < 1e-12));
        // One stroke less leaves too few passes in one direction.
        let few = strokes(2 * FEWEST_PASSES - 1);
        let left = few.less_what_repeats(&residual[..few.0.len()]);
        let is_left = |(part, number): (&Option<usize>, &f64)| {
            (*number > 0.0) == part.is_some_and(|part| part >= PARTS && part * part % 7 > 0)
        };
        assert!(few.0.iter().zip(&left).all(is_left));
    }

    #[test]
    fn what_goes_with_the_time_stays() {
        let passes = strokes(2 * FEWEST_PASSES);
        let wave: Vec<f64> = (0_u32..).take(passes.0.len()).map(|row| (f64::from(row) / 7.3).sin()).collect();
        let square = |numbers: &[f64]| numbers.iter().map(|number| number * number).sum::<f64>();
        let left = square(&passes.less_what_repeats(&wave)) / square(&wave);
        assert!(left > 0.75, "{left}");
    }
}
