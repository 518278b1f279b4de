//! Faults of the recording of markers: some stand still, two are exchanged, or all are late.
//!
//! Markers that stand still or are exchanged are found in the run alone, and put right before the search: hidden, or exchanged back. A delay is found by
//! the search. Such a run is never called complete or extended: it needs another recording, and the report says what is wrong with this one.

use fric_lab::numbers::Numbers;
use fric_lab::text::listed;
use fric_tendon::ManipulatorParams;
use fric_tendon::file::ManipulatorFile;

use super::goes_with::GoesWith;
use crate::error::ContinuumError;
use crate::identify::evaluation::way;
use crate::measuring::{corrected, moved_m};
use crate::result::intervals_s;
use crate::run::{Run, RunSample};
use crate::shape_errors::shapes;

/// Least number of steps in which a marker stands still, and least change of the tension meanwhile, as a fraction of the greatest. A tracker that reports to
/// a tenth of a millimetre repeats a place of the first disk, which moves 6 mm in a run, for half that change.
const LEAST_STILL: usize = 3;
const LEAST_CHANGE_RATIO: f64 = 0.01;
/// Greatest probability that a run without fault has a stretch as long.
const CHANCE: f64 = 1e-3;
/// Least number of other steps from which the probability of standing still is known.
const LEAST_OTHERS: usize = 20;
/// Neighbouring markers are never further apart than their disks are along the backbone. Beyond this multiple of that distance, which leaves room for a wrong
/// file and noise, one of them is another disk's: those of disks after next are apart by about twice the distance.
const APART_RATIO: f64 = 1.5;
/// Least number of samples in which two markers are exchanged.
const LEAST_EXCHANGED: usize = 2;

/// Returns the run with its markers put right, and what was wrong with them.
pub fn mended(run: &Run, params: &ManipulatorParams) -> (Run, Vec<GoesWith>) {
    let mut faults = Vec::new();
    let (run, exchanged) = exchanged_back(run, params.pitch_m());
    faults.extend(exchanged);
    let mut marker_m: Vec<Vec<[f64; 2]>> = run.samples().iter().map(|sample| sample.marker_m.clone()).collect();
    let mut still: Vec<([usize; 2], Vec<usize>)> = Vec::new();
    for marker in 0..run.disk_count() {
        for stretch in frozen(run.samples(), marker) {
            for row in marker_m.iter_mut().take(stretch[1] + 1).skip(stretch[0] + 1) {
                row[marker] = [f64::NAN; 2];
            }
            match still.iter_mut().find(|(other, _)| *other == stretch) {
                Some((_, markers)) => markers.push(marker + 1),
                None => still.push((stretch, vec![marker + 1])),
            }
        }
    }
    faults.extend(still.into_iter().map(|(stretch, markers)| {
        let time_s = |place: usize| run.samples().get(place).map_or(f64::NAN, |sample| sample.time_s);
        let [from_s, to_s] = stretch.map(time_s);
        let numbers: Vec<String> = markers.iter().map(ToString::to_string).collect();
        let which = if markers.len() > 1 { "Markers" } else { "Marker" };
        GoesWith {
            signal: "marker",
            with: "frozen",
            share: None,
            parameters: numbers_of(&markers, &[("from_s", from_s), ("to_s", to_s)]),
            sentence: format!(
                "{which} {} froze from {from_s} s to {to_s} s, while the tension at the base changed, and count as hidden there.",
                listed(&numbers)
            ),
        }
    }));
    (run.with_markers(marker_m), faults)
}

/// Returns the run with its markers moved ahead by a delay that the search has found, along the path of the disks by a file, and the fault.
///
/// # Errors
/// Checked runs and files cause no error; the signature is that of their checks.
pub fn ahead(run: &Run, file: &ManipulatorFile, delay_s: f64) -> Result<(Run, GoesWith), ContinuumError> {
    let samples = corrected(run, file)?;
    let samples = samples.samples();
    let path = shapes(file.params(), samples, way(file), &[])?;
    let times_s: Vec<f64> = samples.iter().map(|sample| sample.time_s).collect();
    let frame = file.tables().markers.unwrap_or_default();
    let moved = samples.iter().zip(moved_m(&times_s, &path, delay_s)).map(|(sample, moved_m)| {
        let places = sample.marker_m.iter().zip(moved_m);
        places.map(|([x_m, y_m], [ahead_x_m, ahead_y_m])| frame.measured([x_m + ahead_x_m, y_m + ahead_y_m])).collect()
    });
    let how = if delay_s > 0.0 { "late" } else { "early" };
    let fault = GoesWith {
        signal: "marker",
        with: "reference_delay",
        share: None,
        parameters: numbers_of(&[], &[("delay_s", delay_s)]),
        sentence: format!(
            "All markers are {:.2} s {how} against the forces over the whole run, and are compared without that. Take their time stamps from the clock of \
             the gratings.",
            delay_s.abs()
        ),
    };
    Ok((run.with_markers(moved.collect()), fault))
}

fn numbers_of(markers: &[usize], others: &[(&str, f64)]) -> Numbers {
    #[expect(clippy::cast_precision_loss, reason = "small counts")]
    let markers = markers.iter().zip(1..).map(|(marker, place)| (format!("marker_{place}"), *marker as f64));
    Numbers(markers.chain(others.iter().map(|(name, value)| ((*name).to_owned(), *value))).collect())
}

/// Returns the stretches, from their first to their last sample, in which a marker has the same place although the tension changes, where that is too rare in
/// the rest of the run to be chance.
fn frozen(samples: &[RunSample], marker: usize) -> Vec<[usize; 2]> {
    let greatest_n = samples.iter().map(|sample| sample.tension_base_n).fold(0.0, f64::max);
    let place_m =
        |sample: &RunSample| sample.marker_m.get(marker).copied().filter(|[x_m, y_m]| (x_m + y_m).is_finite());
    let is_still: Vec<Option<bool>> = samples
        .windows(2)
        .map(|pair| Some(place_m(pair.first()?)?.map(f64::to_bits) == place_m(pair.last()?)?.map(f64::to_bits)))
        .collect();
    let mut stretches: Vec<[usize; 2]> = Vec::new();
    let mut first = 0;
    for stretch in is_still.chunk_by(|one, other| one == other) {
        let change_n = samples[first..=first + stretch.len()].iter().map(|sample| sample.tension_base_n);
        let (least_n, most_n) =
            change_n.fold((f64::INFINITY, 0.0_f64), |(least, most), one| (least.min(one), most.max(one)));
        if stretch.first() == Some(&Some(true))
            && stretch.len() >= LEAST_STILL
            && most_n - least_n > LEAST_CHANGE_RATIO * greatest_n
        {
            stretches.push([first, first + stretch.len()]);
        }
        first += stretch.len();
    }
    let is_other = |place: &usize| !stretches.iter().any(|[from, to]| (*from..*to).contains(place));
    let others: Vec<bool> = is_still
        .iter()
        .enumerate()
        .filter(|(place, _)| is_other(place))
        .filter_map(|(_, is_still)| *is_still)
        .collect();
    if others.len() < LEAST_OTHERS {
        return Vec::new();
    }
    #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
    let count = |count: usize| count as f64;
    let probability = count(others.iter().filter(|is_still| **is_still).count() + 1) / count(others.len() + 1);
    let chance = |[from, to]: &[usize; 2]| count(samples.len()) * probability.powf(count(to - from));
    stretches.retain(|stretch| chance(stretch) < CHANCE);
    stretches
}

/// Returns the run with two markers exchanged in the samples where neighbouring markers are further apart than disks can be, and where these two are the only
/// ones whose exchange mends that.
fn exchanged_back(run: &Run, pitch_m: &[f64]) -> (Run, Option<GoesWith>) {
    let is_possible = |marker_m: &[[f64; 2]]| {
        let pairs = marker_m.windows(2).zip(pitch_m.iter().skip(1));
        pairs.into_iter().all(|(pair, pitch_m)| {
            let apart_m = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            apart_m.is_nan() || apart_m < APART_RATIO * pitch_m
        })
    };
    let with = |sample: &RunSample, [one, other]: [usize; 2]| {
        let mut marker_m = sample.marker_m.clone();
        marker_m.swap(one, other);
        marker_m
    };
    let count = run.disk_count();
    let pairs = (0..count).flat_map(|one| (one + 1..count).map(move |other| [one, other]));
    let is_wrong: Vec<bool> = run.samples().iter().map(|sample| !is_possible(&sample.marker_m)).collect();
    if is_wrong.iter().filter(|is_wrong| **is_wrong).count() < LEAST_EXCHANGED {
        return (run.clone(), None);
    }
    let wrong = || run.samples().iter().zip(&is_wrong).filter(|(_, is_wrong)| **is_wrong).map(|(sample, _)| sample);
    let mends = |pair: &[usize; 2]| wrong().all(|sample| is_possible(&with(sample, *pair)));
    let found: Vec<[usize; 2]> = pairs.filter(mends).collect();
    let [pair] = found[..] else { return (run.clone(), None) };
    let rows = run.samples().iter().zip(&is_wrong);
    let marker_m = rows.map(|(sample, is_wrong)| if *is_wrong { with(sample, pair) } else { sample.marker_m.clone() });
    let times_s: Vec<f64> = run.samples().iter().map(|sample| sample.time_s).collect();
    let intervals = intervals_s(&times_s, is_wrong.iter().copied());
    let [from_s, to_s] =
        [intervals.first().map_or(f64::NAN, |one| one[0]), intervals.last().map_or(f64::NAN, |one| one[1])];
    let [one, other] = pair.map(|place| place + 1);
    let fault = GoesWith {
        signal: "marker",
        with: "exchanged",
        share: None,
        parameters: numbers_of(&[one, other], &[("from_s", from_s), ("to_s", to_s)]),
        sentence: format!(
            "Markers {one} and {other} are exchanged from {from_s} s to {to_s} s, because neighbours would be further apart there than their disks, and are \
             compared exchanged back."
        ),
    };
    (run.with_markers(marker_m.collect()), Some(fault))
}
