//! Friction of a cable over its speed and its length, measured and modelled: a plot of the law itself.
//!
//! Measured friction is the reference minus the force that the sensor would imply without friction; a model's friction is its force minus the same.
//! Both are at the platform, and negative where the platform feels less than the sensor.

use crate::fit::CableRecord;
use crate::samples::conditions::sign;

/// Number of bins over a condition.
const BINS: usize = 40;
/// Fraction of the samples whose speed lies within the bins. The few faster samples would squeeze the others.
const WITHIN: f64 = 0.995;

/// Friction in one bin of a condition; NaN where nothing was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionPoint {
    /// Middle of the bin, m/s or m.
    pub at: f64,
    /// Mean measured friction, N.
    pub measured_n: f64,
    /// Standard deviation of the measured friction, N.
    pub deviation_n: f64,
    /// Mean friction of the given model, fitted, N.
    pub before_n: f64,
    /// Mean friction of the extended model, N.
    pub after_n: f64,
}

/// Friction over both conditions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrictionCurves {
    /// Friction over the speed, m/s, positive paying out.
    pub over_speed: Vec<FrictionPoint>,
    /// Friction over the cable length, m: reeling in, and paying out.
    pub over_length: [Vec<FrictionPoint>; 2],
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: f64,
    measured: f64,
    squares: f64,
    before: f64,
    after: f64,
}

#[derive(Debug)]
struct Curve {
    from: f64,
    to: f64,
    bins: Vec<Sums>,
}

impl Curve {
    fn new(from: f64, to: f64) -> Self {
        Self { from, to, bins: vec![Sums::default(); BINS] }
    }

    fn add(&mut self, at: f64, [measured, before, after]: [f64; 3]) {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let place = (at - self.from) / (self.to - self.from) * BINS as f64;
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        if !(0.0..BINS as f64 + 1e-9).contains(&place) {
            return;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to BINS")]
        let Some(sums) = self.bins.get_mut((place as usize).min(BINS - 1)) else { return };
        sums.count += 1.0;
        sums.measured += measured;
        sums.squares += measured * measured;
        sums.before += before;
        sums.after += after;
    }

    fn points(&self) -> Vec<FrictionPoint> {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let middle = |place: usize| self.from + (self.to - self.from) * (place as f64 + 0.5) / BINS as f64;
        let point = |(place, sums): (usize, &Sums)| {
            let mean = sums.measured / sums.count;
            FrictionPoint {
                at: middle(place),
                measured_n: mean,
                deviation_n: (sums.squares / sums.count - mean * mean).max(0.0).sqrt(),
                before_n: sums.before / sums.count,
                after_n: sums.after / sums.count,
            }
        };
        if self.bins.iter().all(|sums| sums.count <= 0.0) {
            Vec::new()
        } else {
            self.bins.iter().enumerate().map(point).collect()
        }
    }
}

/// Returns the curves of a cable from these residuals, N, which are NaN where a sample does not count.
pub fn curves(record: &CableRecord<'_>, before_n: &[f64], after_n: &[f64]) -> FrictionCurves {
    let gain = record.params.frictionless_gain();
    let counts = |place: usize| {
        let row = record.rows.get(place)?;
        let (before_n, after_n) = (*before_n.get(place)?, *after_n.get(place)?);
        let measured_n = record.reference_n(place) - gain * row.signals.sensor_force_n;
        let all = [measured_n, measured_n + before_n, measured_n + after_n];
        all.iter().all(|value| value.is_finite()).then_some((row.signals, all))
    };
    let mut speeds: Vec<f64> = (0..record.rows.len())
        .filter_map(|place| Some(counts(place)?.0.speed_m_per_s.abs()).filter(|speed| speed.is_finite()))
        .collect();
    let lengths = (0..record.rows.len()).filter_map(|place| Some(counts(place)?.0.length_m));
    let ends_m = lengths
        .filter(|length_m| length_m.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), length_m| {
            (least.min(length_m), greatest.max(length_m))
        });
    if speeds.is_empty() || ends_m.1 <= ends_m.0 {
        return FrictionCurves::default();
    }
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of a count"
    )]
    let place = (WITHIN * (speeds.len() - 1) as f64) as usize;
    let fastest = *speeds.select_nth_unstable_by(place, f64::total_cmp).1;
    let mut over_speed = Curve::new(-fastest.max(f64::MIN_POSITIVE), fastest.max(f64::MIN_POSITIVE));
    let mut over_length = [Curve::new(ends_m.0, ends_m.1), Curve::new(ends_m.0, ends_m.1)];
    let mut direction = 0.0;
    for place in 0..record.rows.len() {
        let Some((signals, all)) = counts(place) else { continue };
        over_speed.add(signals.speed_m_per_s, all);
        let moves = sign(signals.displacement_m);
        direction = if moves == 0.0 { direction } else { moves };
        if direction != 0.0 {
            over_length[usize::from(direction > 0.0)].add(signals.length_m, all);
        }
    }
    FrictionCurves { over_speed: over_speed.points(), over_length: over_length.map(|curve| curve.points()) }
}
