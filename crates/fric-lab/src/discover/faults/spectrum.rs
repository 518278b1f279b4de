//! Power spectra of a log's signals, over rows that may be missing.
//!
//! The periodogram of Welch: spectra of overlapping stretches under Hann's window, averaged.

use std::f64::consts::TAU;
use std::ops::Range;

use realfft::RealFftPlanner;

use crate::fit::{CableRecord, Row};
use crate::samples::conditions::sign;

/// Cycles of a stretch, and of a pause after which a phase begins anew.
pub const STRETCH: usize = 4096;
/// Neighbours on either side that a place is compared with.
pub const NEIGHBOURS: usize = 24;
/// Width of a line on either side, in places.
pub const LINE_WIDTH: usize = 3;
/// By how many times their median a line of the motion or the load stands out: less than this may be chance in a few tens of spectra averaged.
const MOTION_RATIO: f64 = 4.0;
/// The least ratio of the median of a power over the log to its mean of what goes on. What is there in less than half of the log has a median of nearly
/// 0; hum that is twice as high in two fifths of a log has 0.45.
const LEAST_MEDIAN_RATIO: f64 = 0.25;
/// A log whose samples are as far apart as the cycles, but for this share, is that of the loop.
const RATE_TOLERANCE: f64 = 0.1;

/// When a record's rows are, and over which of them a line keeps its phase.
pub struct Times {
    /// Of each row, its place since the first of its log, in rows of a log without gaps.
    pub places: Vec<f64>,
    /// Rows of one phase.
    pub runs: Vec<Range<usize>>,
    /// From one place to the next, s.
    pub interval_s: f64,
}

impl Times {
    /// Of a record.
    #[must_use]
    pub fn of(record: &CableRecord<'_>) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let is_near = |one: &f64, next: &f64| next - one < STRETCH as f64;
        // A loop that logs each cycle does not jitter as its stamps do; of a log at another rate the stamps are all there is.
        let is_of_loop = (record.interval_s / record.cycle_s - 1.0).abs() < RATE_TOLERANCE;
        let interval_s = if is_of_loop { record.cycle_s } else { record.interval_s };
        let (mut places, mut runs) = (Vec::with_capacity(record.rows.len()), Vec::new());
        for (mut start, rows) in record.logs() {
            let first_s = record.time_s(start);
            let by_stamp = |place: usize| (record.time_s(start + place) - first_s) / interval_s;
            let of_log =
                rows.iter().enumerate().map(|(place, row)| if is_of_loop { row.cycle } else { by_stamp(place) });
            places.extend(of_log);
            for run in places.get(start..).unwrap_or_default().chunk_by(is_near) {
                runs.push(start..start + run.len());
                start += run.len();
            }
        }
        Self { places, runs, interval_s }
    }

    /// The places of the rows of a run.
    pub fn of_run(&self, run: &Range<usize>) -> &[f64] {
        self.places.get(run.clone()).unwrap_or_default()
    }

    /// Phase of a line at a place, rad.
    pub fn phase(&self, frequency_hz: f64, place: f64) -> f64 {
        TAU * frequency_hz * (place * self.interval_s)
    }

    /// From one place of a [`Spectrum`] to the next, Hz.
    pub fn place_hz(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let length = STRETCH as f64;
        1.0 / (length * self.interval_s)
    }

    /// Puts the numbers of rows where these would be had they no gaps, and fills what lies between two of them. Before the first and after the last is 0.
    pub fn spread(&self, rows: &Range<usize>, numbers: &[f64], fill: Fill, room: &mut [f64]) {
        room.fill(0.0);
        let places = self.of_run(rows);
        let Some(first) = places.first() else { return };
        let mut before: Option<(usize, f64)> = None;
        for (place, number) in places.iter().zip(numbers).filter(|(_, number)| number.is_finite()) {
            // Those after lost rows move on, the last out of the room.
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
            let place = (place - first).round() as usize;
            if let Some((from, of)) = before.filter(|_| fill == Fill::Between) {
                let width = places_between(from, place);
                for between in from + 1..place {
                    if let Some(room) = room.get_mut(between) {
                        *room = of + (number - of) * places_between(from, between) / width;
                    }
                }
            }
            if let Some(room) = room.get_mut(place) {
                *room = *number;
            }
            before = Some((place, *number));
        }
    }

    /// Rows from the first to the last of the longest run, had it no gaps.
    pub fn longest(&self) -> f64 {
        let length = |run: &Range<usize>| match self.of_run(run) {
            [first, .., last] => last - first + 1.0,
            _ => 1.0,
        };
        self.runs.iter().map(length).fold(1.0, f64::max)
    }
}

#[expect(clippy::cast_precision_loss, reason = "counts of rows")]
fn places_between(from: usize, to: usize) -> f64 {
    to.saturating_sub(from) as f64
}

/// What stands in a row without a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// 0: in a signal with a number in one of every few rows, whose images lie above half the rate of the numbers. A straight line between numbers so far
    /// apart would take off what is fast.
    Zero,
    /// A straight line between the numbers on either side. With 0 in the few rows without a number, what is slow would change as often as those come,
    /// and stamps that jitter by half a cycle have them in a pattern: its line would be in the spectrum.
    Between,
}

impl Fill {
    /// Of a signal by rows, NaN where there is no number.
    pub fn of(signal: &[f64]) -> Self {
        if rows_a_number(signal).is_some() { Self::Zero } else { Self::Between }
    }
}

/// Returns the mean number of rows from one number of a signal to the next, gaps apart; `None` if most rows have one.
fn rows_a_number(signal: &[f64]) -> Option<f64> {
    let places: Vec<usize> = (0..signal.len()).filter(|place| signal[*place].is_finite()).collect();
    let mut rows: Vec<usize> = places.windows(2).map(|pair| pair[1] - pair[0]).collect();
    rows.sort_unstable();
    let median = rows.get(rows.len() / 2).copied().filter(|median| *median > 1)?;
    // A slow signal comes a row early or late.
    let usual = rows.partition_point(|rows| *rows < median - 1)..rows.partition_point(|rows| *rows <= median + 1);
    let usual = rows.get(usual)?;
    #[expect(clippy::cast_precision_loss, reason = "counts of rows")]
    let mean = usual.iter().sum::<usize>() as f64 / usual.len() as f64;
    Some(mean)
}

/// Mean squares of a signal by frequency.
pub struct Spectrum {
    /// Of each place, from frequency 0 up; they sum up to the signal's.
    pub powers: Vec<f64>,
    /// How many spectra were averaged.
    pub stretches: f64,
}

impl Spectrum {
    /// Of a signal with a number for each row, NaN where there is none; `None` where no run is as long as a stretch. It ends at half the rate of the numbers:
    /// above it, one in every few rows makes images of what is slow.
    pub fn of(signal: &[f64], times: &Times) -> Option<Self> {
        let mut spectrum = Self::watching(signal, times, |_| ())?;
        if let Some(rows) = rows_a_number(signal) {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let most = spectrum.powers.len() as f64 / rows;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "less than the count before")]
            spectrum.powers.truncate(most as usize);
        }
        Some(spectrum)
    }

    /// As [`Self::of`]; `watch` is shown the powers of each stretch, in a unit of its own.
    fn watching(signal: &[f64], times: &Times, mut watch: impl FnMut(&[f64])) -> Option<Self> {
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(STRETCH);
        let mut input = transform.make_input_vec();
        let mut output = transform.make_output_vec();
        let mut of_stretch = vec![0.0; output.len()];
        let mut powers = of_stretch.clone();
        let mut stretches = 0.0;
        let fill = Fill::of(signal);
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let window = |place: usize| 0.5 - 0.5 * (TAU * place as f64 / STRETCH as f64).cos();
        for run in &times.runs {
            for start in (run.start..(run.end + 1).saturating_sub(STRETCH)).step_by(STRETCH / 2) {
                let stretch = start..start + STRETCH;
                times.spread(&stretch, signal.get(stretch.clone())?, fill, &mut input);
                input.iter_mut().enumerate().for_each(|(place, number)| *number *= window(place));
                transform.process(&mut input, &mut output).ok()?;
                of_stretch.iter_mut().zip(&output).for_each(|(power, number)| *power = number.norm_sqr());
                watch(&of_stretch);
                powers.iter_mut().zip(&of_stretch).for_each(|(sum, power)| *sum += power);
                stretches += 1.0;
            }
        }
        // Half of the places of the transform are here; Hann's window leaves three eighths of the mean square.
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let length = STRETCH as f64;
        let scale = 2.0 / (length * length * 0.375 * stretches);
        for power in &mut powers {
            *power *= scale;
        }
        (stretches > 0.0).then_some(Self { powers, stretches })
    }

    /// When a signal has a line near each of some places.
    fn lines_near(places: &[usize], signal: &[f64], times: &Times) -> Option<Vec<Occurrence>> {
        let near = |place: &usize| place.saturating_sub(1)..=place + 1;
        let mut of_stretches = vec![Vec::new(); places.len()];
        let spectrum = Self::watching(signal, times, |powers| {
            for (place, of_stretches) in places.iter().zip(&mut of_stretches) {
                of_stretches.push(powers.get(near(place)).unwrap_or_default().iter().sum());
            }
        })?;
        let when = |(place, of_stretches): (&usize, Vec<f64>)| {
            let stands_out = |place| spectrum.over_median(place).is_some_and(|ratio| ratio > MOTION_RATIO);
            match near(place).any(stands_out) {
                true if goes_on(of_stretches) => Occurrence::Throughout,
                true => Occurrence::Sometimes,
                false => Occurrence::Never,
            }
        };
        Some(places.iter().zip(of_stretches).map(when).collect())
    }

    /// By how many times the median of its neighbours a place stands out.
    pub fn over_median(&self, place: usize) -> Option<f64> {
        Some(self.powers.get(place)? / self.median_around(place)?)
    }

    /// Mean square of a line at a place: what is more there than around.
    pub fn line_power(&self, place: usize) -> Option<f64> {
        let median = self.median_around(place)?;
        let line = self.powers.get(place.checked_sub(LINE_WIDTH)?..=place + LINE_WIDTH)?;
        Some(line.iter().map(|power| power - median).sum())
    }

    fn median_around(&self, place: usize) -> Option<f64> {
        let around = place.checked_sub(NEIGHBOURS)?..(place + NEIGHBOURS + 1).min(self.powers.len());
        let others = around.filter(|other| other.abs_diff(place) > LINE_WIDTH);
        let mut others: Vec<f64> = others.filter_map(|other| self.powers.get(other).copied()).collect();
        if others.is_empty() {
            return None;
        }
        let middle = others.len() / 2;
        Some(*others.select_nth_unstable_by(middle, f64::total_cmp).1)
    }
}

/// A signal by the row.
pub type Signal<'a> = Box<dyn Fn(usize) -> f64 + 'a>;

/// Signals that only together tell a line: each may hum by itself.
pub type Together<'a> = Vec<Signal<'a>>;

/// When a line is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Occurrence {
    Never,
    /// In few stretches of the log: even a smooth motion has some frequency at which its start stands out.
    Sometimes,
    Throughout,
}

/// Returns when any of the signals has a line at a frequency, for each of some.
pub fn occurrences(frequencies_hz: &[f64], signals: &[Together<'_>], times: &Times) -> Vec<Occurrence> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place of the spectrum")]
    let places: Vec<usize> =
        frequencies_hz.iter().map(|frequency_hz| (frequency_hz / times.place_hz()).round() as usize).collect();
    let of_signal = |signal: &Signal<'_>| {
        let numbers: Vec<f64> = (0..times.places.len()).map(signal).collect();
        Spectrum::lines_near(&places, &numbers, times)
    };
    let of_signals: Vec<Vec<Vec<Occurrence>>> =
        signals.iter().map(|of| of.iter().filter_map(of_signal).collect()).collect();
    let when = |line: usize| {
        let together = |of: &Vec<Vec<Occurrence>>| of.iter().filter_map(|of| of.get(line)).min().copied();
        of_signals.iter().filter_map(together).max().unwrap_or(Occurrence::Never)
    };
    (0..places.len()).map(when).collect()
}

/// Whether what has these powers one after the other goes on all the time.
pub fn goes_on(mut powers: Vec<f64>) -> bool {
    powers.sort_unstable_by(f64::total_cmp);
    #[expect(clippy::cast_precision_loss, reason = "a count of stretches")]
    let mean = powers.iter().sum::<f64>() / powers.len() as f64;
    powers.get(powers.len() / 2).is_none_or(|median| *median >= LEAST_MEDIAN_RATIO * mean)
}

/// What a cable does and bears: the motion, with the harmonics that a law of friction makes of a periodic one, and the load as both of its sensors
/// see it.
pub fn motion_and_load<'a>(record: &CableRecord<'a>) -> Vec<Together<'a>> {
    let (rows, load_n) = (record.rows, record.references_n);
    let of = |value: fn(&Row) -> f64| -> Signal<'a> { Box::new(move |row| rows.get(row).map_or(f64::NAN, value)) };
    let speed_m_per_s = move |row: usize| rows.get(row).map_or(f64::NAN, |row| row.signals.speed_m_per_s);
    let acceleration =
        move |row: usize| row.checked_sub(1).map_or(0.0, |before| speed_m_per_s(row) - speed_m_per_s(before));
    let at_platform_n = move |row: usize| load_n.get(row).copied().unwrap_or(f64::NAN);
    vec![
        vec![of(|row| row.signals.displacement_m)],
        vec![of(|row| row.signals.displacement_m.abs())],
        vec![of(|row| sign(row.signals.displacement_m))],
        vec![Box::new(speed_m_per_s)],
        vec![Box::new(acceleration)],
        vec![of(|row| row.signals.sensor_force_n), Box::new(at_platform_n)],
    ]
}
