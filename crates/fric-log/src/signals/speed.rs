//! Derives the speed if it is not measured.
//!
//! It is the slope, at the row's time, of the cubic that fits the lengths around the row best (of the parabola through three of them in the narrowest
//! window), and has no lag. A difference to the previous row would be the speed of half a cycle ago, which would delay viscous friction and the
//! acceleration of the pulleys. A control loop without a measured speed has this lag; a log need not.
//!
//! The wider the window, the less of an encoder's steps and noise remains in the slope, and the more of a changing acceleration is lost. A row bears
//! the widest window whose slope agrees with those of all narrower ones, within [`AGREEMENT`] standard errors of each: the intersection of confidence
//! intervals (A. Goldenshluger and A. Nemirovski, *On spatially adaptive estimation of nonparametric regression*, 1997; V. Katkovnik, *A new method
//! for varying adaptive bandwidth selection*, 1999). The noise of the lengths comes from the same rows, by what is left of five lengths in succession
//! after their own cubic.
//!
//! A window that changes from one row to the next makes the speed jump by the difference of two slopes, and the acceleration by that over a cycle. So
//! it changes gradually: each row has the narrowest window that it and its neighbours bear, and the speed is the mean over the windows of the row and
//! its neighbours. None of these is wider than the row bears.

use std::collections::VecDeque;
use std::ops::{Range, RangeInclusive};

use nalgebra::{Matrix4, Vector4};

use super::waiting::Row;

/// Lengths on each side of the row in the windows, from the narrowest to the widest.
const WINDOWS: [usize; 9] = [1, 2, 3, 4, 6, 8, 11, 15, 20];
const WIDEST: usize = WINDOWS[WINDOWS.len() - 1];
/// Standard errors within which the slopes of two windows agree. In `tests/signals/speed.rs` white noise leaves 1.12 times the error of the widest
/// window (5 % of that of the parabola), and an encoder's steps in quick strokes leave 61 % of the parabola's; half of it 8.5 times and 34 %, twice 1.0
/// times and 120 %.
const AGREEMENT: f64 = 4.0;

/// Rows on each side that are a row's neighbours. On a drive whose force goes by the acceleration, one instead of two leaves 5 % more of it unexplained
/// where the motion is extrapolated by a cycle; more than two change nothing.
const NEIGHBOURS: usize = 2;

/// Least noise of a length as a fraction of it. Lengths on a line would otherwise have no noise but that of their own rounding and of this arithmetic's.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Lengths that the noise is estimated from together: a cubic goes through any four.
const FIVE: usize = 5;

/// A known length of a cable, and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct KnownLength {
    stamp_nanos: i64,
    length_m: f64,
    /// What is left of this length and the four before it after their cubic, squared, m². One number of the variance of a length; unknown until it is
    /// needed.
    rest_m2: Option<f64>,
    /// Unknown until they are needed.
    slopes: Option<Slopes>,
}

/// The slopes of the length at a row.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Slopes {
    /// By window, as far as the row bears them, m/s.
    speeds_m_per_s: [f64; WINDOWS.len()],
    /// Number of windows that the row bears; none if no other length is known.
    count: usize,
}

impl Slopes {
    /// Adds the slope of the next window. Windows before the first that has enough lengths stand for it.
    fn push(&mut self, window: usize, speed_m_per_s: f64) {
        let narrower = if self.count == 0 { 0 } else { window };
        if let Some(speeds) = self.speeds_m_per_s.get_mut(narrower..=window) {
            speeds.fill(speed_m_per_s);
        }
        self.count = window + 1;
    }
}

/// The known lengths of a cable around the one whose speed is asked for.
///
/// ```
/// use fric_log::signals::LengthWindow;
/// // x = t², at 0, 1 and 3 seconds.
/// let mut lengths = LengthWindow::default();
/// for (s, length_m) in [(0, 0.0), (1, 1.0), (3, 9.0)] {
///     lengths.push(s * 1_000_000_000, length_m);
/// }
/// for expected_m_per_s in [0.0, 2.0, 6.0] {
///     assert!((lengths.speed_m_per_s() - expected_m_per_s).abs() < 1e-12);
///     lengths.advance();
/// }
/// ```
#[derive(Debug, Default)]
pub struct LengthWindow {
    lengths: VecDeque<KnownLength>,
    /// Place of the length asked for.
    now: usize,
}

impl LengthWindow {
    /// Lengths on each side of the one asked for that its speed may depend on: so many rows have to wait.
    pub const REACH: usize = WIDEST + 2 * NEIGHBOURS;

    /// Adds a later length. One that is not finite is not known, and left out.
    pub fn push(&mut self, stamp_nanos: i64, length_m: f64) {
        if length_m.is_finite() {
            self.lengths.push_back(KnownLength { stamp_nanos, length_m, rest_m2: None, slopes: None });
        }
    }

    /// Whether there are so many lengths after the one asked for that more of them change nothing.
    #[must_use]
    pub fn is_determined(&self) -> bool {
        self.lengths.len() > self.now + Self::REACH
    }

    /// Asks for the next length.
    pub fn advance(&mut self) {
        self.now += 1;
        if self.now > Self::REACH {
            self.lengths.pop_front();
            self.now -= 1;
        }
    }

    /// Returns the speed at the length asked for; 0 if no other one is known. Lengths before one that is not earlier, or after one that is not later,
    /// count as unknown: the clock was set there.
    pub fn speed_m_per_s(&mut self) -> f64 {
        let run = self.run(self.now);
        let near = |place: usize, count: usize| {
            place.saturating_sub(count).max(*run.start())..=(place + count).min(*run.end())
        };
        let slopes: Vec<Slopes> = near(self.now, 2 * NEIGHBOURS).map(|place| self.slopes(place)).collect();
        let first = *near(self.now, 2 * NEIGHBOURS).start();
        let borne = |place: usize| slopes.get(place - first).map(|of| of.count).filter(|count| *count > 0);
        let speeds = slopes.get(self.now - first).copied().unwrap_or_default().speeds_m_per_s;
        let of_neighbours = near(self.now, NEIGHBOURS).filter_map(|place| {
            let narrowest = near(place, NEIGHBOURS).filter_map(borne).min()?;
            speeds.get(narrowest - 1)
        });
        let (sum, count) = of_neighbours.fold((0.0, 0.0), |(sum, count), speed| (sum + speed, count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Returns the slopes at a length.
    fn slopes(&mut self, place: usize) -> Slopes {
        let Some(now) = self.lengths.get(place).copied() else { return Slopes::default() };
        if let Some(known) = now.slopes {
            return known;
        }
        let run = self.run(place);
        let noise_m = self.noise_m(&run);
        let ends = [run.start(), run.end()].map(|end| self.lengths.get(*end).map_or(0.0, |it| seconds(now, *it)));
        let scale_s = ends[1].max(-ends[0]);
        let mut fit = Cubic::default();
        let mut agreed = [f64::NEG_INFINITY, f64::INFINITY];
        let mut slopes = Slopes::default();
        let mut within = place..place + 1;
        for (window, reach) in WINDOWS.into_iter().enumerate() {
            let wider = place.saturating_sub(reach).max(*run.start())..(place + reach).min(*run.end()) + 1;
            if wider == within {
                break;
            }
            if wider.len() < 3 && run.end() - run.start() > 1 {
                continue;
            }
            let added = self.lengths.range(wider.start..within.start).chain(self.lengths.range(within.end..wider.end));
            added.for_each(|it| fit.add(seconds(now, *it) / scale_s, it.length_m - now.length_m));
            within = wider;
            let highest_power = if within.len() > 3 { 3 } else { 2 };
            let Some([slope_m, error]) = fit.slope(highest_power) else { break };
            let margin_m = AGREEMENT * error * noise_m.unwrap_or(0.0);
            agreed = [agreed[0].max(slope_m - margin_m), agreed[1].min(slope_m + margin_m)];
            if agreed[0] > agreed[1] {
                break;
            }
            slopes.push(window, slope_m / scale_s);
            if noise_m.is_none() {
                break;
            }
        }
        if let Some(known) = self.lengths.get_mut(place) {
            known.slopes = Some(slopes);
        }
        slopes
    }

    /// Returns the places around one, within its widest window, whose times ascend.
    fn run(&self, around: usize) -> RangeInclusive<usize> {
        let ascends = |place: usize| {
            let stamp = |place: usize| self.lengths.get(place).map(|it| it.stamp_nanos);
            stamp(place) < stamp(place + 1)
        };
        let last = (around + WIDEST).min(self.lengths.len().saturating_sub(1));
        let first = (around.saturating_sub(WIDEST)..around).rev().take_while(|place| ascends(*place)).last();
        let end = (around..last).take_while(|place| ascends(*place)).last().map_or(around, |place| place + 1);
        first.unwrap_or(around)..=end
    }

    /// Returns the standard deviation of the noise of the lengths in a run, at least that of their rounding; `None` if there are too few. A single jump or spike does not count: the
    /// greatest rest is left out, with all that share a length with it.
    fn noise_m(&mut self, run: &RangeInclusive<usize>) -> Option<f64> {
        let of_five: Range<usize> = run.start() + FIVE - 1..run.end() + 1;
        let mut rests = [0.0; 2 * WIDEST];
        let mut count = 0;
        for (place, slot) in of_five.zip(&mut rests) {
            let known = self.lengths.get(place)?.rest_m2;
            *slot = known.unwrap_or_else(|| self.rest_m2(place));
            self.lengths.get_mut(place)?.rest_m2 = Some(*slot);
            count += 1;
        }
        let rests = rests.get(..count)?;
        let (greatest, _) = rests.iter().enumerate().max_by(|one, other| one.1.total_cmp(other.1))?;
        let (sum, count) = rests
            .iter()
            .enumerate()
            .filter(|(place, _)| place.abs_diff(greatest) >= FIVE)
            .fold((0.0, 0.0), |(sum, count), (_, rest_m2)| (sum + rest_m2, count + 1.0));
        let rounding_m =
            ROUNDING * self.lengths.range(run.clone()).fold(0.0, |most: f64, it| most.max(it.length_m.abs()));
        (count > 0.0).then(|| (sum / count).sqrt().max(rounding_m))
    }

    /// Returns what is left of the five lengths up to a place after their cubic: the square of their fourth divided difference, normalised.
    fn rest_m2(&self, place: usize) -> f64 {
        let five = self.lengths.range((place + 1).saturating_sub(FIVE)..=place);
        let Some(last) = self.lengths.get(place) else { return 0.0 };
        let interval_s = five.clone().next().map_or(1.0, |first| seconds(*first, *last));
        let (mut difference, mut norm) = (0.0, 0.0);
        for (this, length) in five.clone().enumerate() {
            let others = five.clone().enumerate().filter(|(other, _)| *other != this);
            let weight: f64 = others.map(|(_, other)| interval_s / seconds(*other, *length)).product();
            difference += weight * (length.length_m - last.length_m);
            norm += weight * weight;
        }
        difference * difference / norm
    }
}

/// Returns the time from one length to another, s.
#[expect(clippy::cast_precision_loss, reason = "an interval between rows")]
fn seconds(from: KnownLength, to: KnownLength) -> f64 {
    to.stamp_nanos.saturating_sub(from.stamp_nanos) as f64 * 1e-9
}

/// Least squares of a polynomial in the time, by its normal equations. The row itself is the origin, and counts as added.
#[derive(Debug)]
struct Cubic {
    /// Sums of the powers of the time, 0 to 6.
    powers: [f64; 7],
    /// Sums of the powers, 0 to 3, times the length.
    lengths: Vector4<f64>,
}

impl Default for Cubic {
    fn default() -> Self {
        Self { powers: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], lengths: Vector4::zeros() }
    }
}

impl Cubic {
    fn add(&mut self, time: f64, length_m: f64) {
        let mut power = 1.0;
        for (place, sum) in self.powers.iter_mut().enumerate() {
            *sum += power;
            if let Some(sum) = self.lengths.get_mut(place) {
                *sum += power * length_m;
            }
            power *= time;
        }
    }

    /// Returns the slope at the origin, and its standard error for lengths of standard deviation 1. No power is higher than there are points for.
    fn slope(&self, highest_power: usize) -> Option<[f64; 2]> {
        let is_used =
            |power: usize| power <= highest_power && f64::from(u8::try_from(power).unwrap_or(u8::MAX)) < self.powers[0];
        let normal = Matrix4::from_fn(|row, column| {
            let is_part = is_used(row) && is_used(column);
            if is_part { self.powers[row + column] } else { f64::from(u8::from(row == column)) }
        });
        let weights = normal.cholesky()?.solve(&Vector4::y());
        let used = Vector4::from_fn(|row, _| if is_used(row) { self.lengths[row] } else { 0.0 });
        Some([weights.dot(&used), weights[1].sqrt()])
    }
}

/// Rows that wait for their speeds.
#[derive(Debug)]
pub(super) struct SpeedRows {
    rows: VecDeque<Row>,
    /// By cable: the lengths around that of the front row.
    lengths: Vec<LengthWindow>,
    is_ended: bool,
}

impl SpeedRows {
    pub fn new(cable_count: usize) -> Self {
        Self {
            rows: VecDeque::new(),
            lengths: (0..cable_count).map(|_| LengthWindow::default()).collect(),
            is_ended: false,
        }
    }

    /// Whether the next row has all its speeds and none waits before it, so that it need not be stored.
    pub fn passes(&mut self, row: &Row) -> bool {
        if !self.rows.is_empty() || self.cables().any(|cable| row.lacks_speed(cable)) {
            return false;
        }
        self.add_lengths(row);
        self.advance(row);
        true
    }

    /// Adds the next row.
    pub fn push(&mut self, row: Row) {
        self.add_lengths(&row);
        self.rows.push_back(row);
    }

    /// Marks the end: no row follows.
    pub fn end(&mut self) {
        self.is_ended = true;
    }

    /// Whether the front row is final, or there is none to wait for. If each cable has messages of its own, as many rows as there are cables have the
    /// next length of each.
    pub fn is_ready(&self) -> bool {
        let mut lengths = self.lengths.iter().enumerate();
        let mut has_all = |row: &Row| lengths.all(|(cable, it)| !row.lacks_speed(cable) || it.is_determined());
        self.is_ended
            || self.rows.len() > LengthWindow::REACH * self.lengths.len()
            || self.rows.front().is_some_and(&mut has_all)
    }

    /// Returns the front row; `None` after the last.
    pub fn pop(&mut self) -> Option<Row> {
        let mut row = self.rows.pop_front()?;
        for (cable, lengths) in self.lengths.iter_mut().enumerate() {
            if row.lacks_speed(cable)
                && let Some(input) = row.cables.get_mut(cable)
            {
                input.speed_m_per_s = lengths.speed_m_per_s();
            }
        }
        self.advance(&row);
        Some(row)
    }

    fn cables(&self) -> Range<usize> {
        0..self.lengths.len()
    }

    fn add_lengths(&mut self, row: &Row) {
        for (lengths, input) in self.lengths.iter_mut().zip(&row.cables) {
            lengths.push(row.stamp_nanos, input.length_m);
        }
    }

    /// Leaves a row, and its lengths, behind.
    fn advance(&mut self, row: &Row) {
        for (lengths, _) in self.lengths.iter_mut().zip(&row.cables).filter(|(_, input)| input.length_m.is_finite()) {
            lengths.advance();
        }
    }
}
