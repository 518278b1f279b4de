//! A reference that is a function of the cable length, as the load of a spring or a weight on a lever is. The length tells its time without any model of
//! the friction: a reference that is late is a loop over the length, open by its rate times twice the delay.
//!
//! The measure of the loop is the mean square of the steps between samples that are neighbours in length: mostly samples of different strokes, so that
//! everything that is no function of the length is in it, as in Rice's estimate of a noise. Where the load has nothing to do with the length the loop is as
//! wide as the load varies, whatever the delay, and tells nothing.

use super::shifted::{Shift, shifted};
use crate::fit::{CableRecord, Row};

/// A reference is a function of the length at one time and not at another if the squares of the loops have this ratio: the loop of the second is three times as
/// wide as all that is no function of the length. Of 1200 loads of three sines that have nothing to do with the motion, over two to twenty strokes, one had it
/// by chance, over two; 99 % stay below 3, so that half the ratio is hardly worse, while twice the ratio asks for a loop of 4.2 times the width.
const LEAST_RATIO: f64 = 9.0;
/// Each delay that is tried is so many times the one before. The one nearest to the true delay is within a fifth of it, and leaves a loop of a twenty-fifth.
const NEXT: f64 = 1.4;
/// Number of delays that are tried between none and twice the one that was found.
const DELAY_COUNT: u32 = 40;

/// Samples of a cable in the order of their lengths, log by log: each log may have its own zeros.
struct Neighbours<'a> {
    record: &'a CableRecord<'a>,
    logs: Vec<Vec<usize>>,
}

impl<'a> Neighbours<'a> {
    fn of(record: &'a CableRecord<'a>) -> Self {
        let length_m = |place: &usize| record.rows.get(*place).map_or(f64::NAN, |row| row.signals.length_m);
        let of_log = |(start, log): (usize, &[Row])| {
            let mut places: Vec<usize> =
                (start..start + log.len()).filter(|place| length_m(place).is_finite()).collect();
            places.sort_by(|one, other| length_m(one).total_cmp(&length_m(other)));
            places
        };
        Self { record, logs: record.logs().map(of_log).collect() }
    }

    /// Returns the mean square of the steps of a reference, N²; NaN if it has none.
    fn loop_of(&self, references_n: &[f64]) -> f64 {
        let at = |place: usize| references_n.get(place).copied().unwrap_or(f64::NAN);
        let steps_n = self.logs.iter().flat_map(|places| places.windows(2)).map(|pair| at(pair[1]) - at(pair[0]));
        let known = steps_n.filter(|number| number.is_finite());
        let (squares, count) =
            known.fold((0.0, 0.0), |(squares, count), number| (squares + number * number, count + 1.0));
        squares / count
    }

    fn loop_at(&self, delay_s: f64) -> f64 {
        self.loop_of(&shifted(self.record, Shift { delay_s, skew: 0.0 }))
    }
}

/// Whether the reference is a function of the length as it is, and not once it is moved.
pub fn is_in_time(record: &CableRecord<'_>, moved_n: &[f64]) -> bool {
    let neighbours = Neighbours::of(record);
    LEAST_RATIO * neighbours.loop_of(record.references_n) < neighbours.loop_of(moved_n)
}

/// Returns by how much a reference is late that is no function of the length as it is, s, negative if it is early: the least delay without which it is one.
/// `None` if it is one, or at none of the times up to `most_s`.
pub fn late_s(record: &CableRecord<'_>, most_s: f64) -> Option<f64> {
    let neighbours = Neighbours::of(record);
    let as_it_is = neighbours.loop_of(record.references_n);
    let is_function = |delay_s: &f64| LEAST_RATIO * neighbours.loop_at(*delay_s) < as_it_is;
    let delays_s = std::iter::successors(Some(record.interval_s), |delay_s| Some(NEXT * delay_s));
    let near_s =
        delays_s.take_while(|delay_s| *delay_s < most_s).flat_map(|delay_s| [delay_s, -delay_s]).find(is_function)?;
    let step_s = 2.0 * near_s / f64::from(DELAY_COUNT);
    let loops: Vec<f64> = (0..=DELAY_COUNT).map(|step| neighbours.loop_at(f64::from(step) * step_s)).collect();
    let around = (1..).zip(loops.windows(3)).min_by(|(_, one), (_, other)| one[1].total_cmp(&other[1]));
    let (step, &[before, least, after]) = around? else { return None };
    // The loop's square is a parabola of the delay.
    let off = 0.5 * (before - after) / (before - 2.0 * least + after);
    Some((f64::from(step) + off.clamp(-1.0, 1.0)) * step_s)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use fric_core::robot::file::RobotFile;
    use fric_core::{CableInput, Sample};

    use super::*;
    use crate::fit::{Measurements, Reference};

    const INTERVAL_S: f64 = 0.01;

    fn way_m(time_s: f64) -> f64 {
        0.2 * (TAU * time_s / 3.1).sin() + 0.05 * (TAU * time_s / 1.3).sin()
    }

    /// Runs work on 30 s of a motion with this reference.
    fn with_reference<T>(reference_n: impl Fn(f64) -> f64, work: impl FnOnce(&CableRecord<'_>) -> T) -> T {
        let text = "format = \"fric-robot/1\"\nname = \"axis\"\ncycle_s = 0.01\n[[cable]]\nname = \"a\"\n\
                    pulleys = [{ wrap_deg = 180.0 }]\nfriction = { mu = 0.02 }\n";
        let robot = RobotFile::parse(text, "axis").unwrap();
        let params = robot.params();
        let mut measurements = Measurements::new(&params, Reference::Forces);
        measurements.start_log();
        for cycle in 0_i32..3000 {
            let time_s = INTERVAL_S * f64::from(cycle);
            let cable = CableInput { sensor_force_n: 50.0, length_m: 1.0 + way_m(time_s), speed_m_per_s: 0.0 };
            measurements.add(&Sample {
                stamp_nanos: i64::from(cycle) * 10_000_000,
                cables: &[cable],
                reference_force_n: &[reference_n(time_s)],
                pose: None,
                outside_wrench: None,
            });
        }
        work(&measurements.cable(0).unwrap())
    }

    #[test]
    fn a_loop_over_the_length_tells_the_delay() {
        let of_lever_n = |time_s: f64| 50.0 + 20.0 * (way_m(time_s) / 0.1).sin();
        for delay_s in [0.03, 0.1, -0.1, 0.31] {
            let told_s = with_reference(|time_s| of_lever_n(time_s - delay_s), |record| late_s(record, 1.0));
            assert!(told_s.is_some_and(|told_s| (told_s - delay_s).abs() < 0.1 * INTERVAL_S), "{delay_s}: {told_s:?}");
        }
        with_reference(of_lever_n, |record| {
            let moved_n = shifted(record, Shift { delay_s: 0.1, skew: 0.0 });
            assert!(late_s(record, 1.0).is_none() && is_in_time(record, &moved_n));
        });
    }

    #[test]
    fn a_load_that_has_nothing_to_do_with_the_length_tells_none() {
        with_reference(
            |time_s| 50.0 + 12.0 * (TAU * time_s / 5.7).sin() + 4.0 * (TAU * time_s / 1.9).sin(),
            |record| {
                let moved_n = shifted(record, Shift { delay_s: 0.1, skew: 0.0 });
                assert!(late_s(record, 1.0).is_none() && !is_in_time(record, &moved_n));
            },
        );
    }
}
