//! Finds wrong numbers of bending, loads and measurement in a file, from tensions and markers together.
//!
//! Candidates enter one after the other, each time the one that decreases the joint cost most. Every entered candidate is then tested again for
//! removal and for replacement. Friction of holes, drifts and wrong lines take part as candidates so that nothing else is named in their place; the
//! search on the tensions names them. A gain that is negligible, or smaller than the rest, gives no name. Candidates that explain the run equally
//! well, within the model's own error, are reported together.

pub mod candidate;
pub mod joint;
mod naming;

use fric_lab::fit::Progress;
use fric_lab::numbers::Numbers;
use fric_tendon::file::{ManipulatorFile, ManipulatorTables};
use rayon::prelude::*;

use self::candidate::Candidate;
use self::joint::{Jacobian, Joint, Point, Set, Units};
use crate::discover::case::thinned_to;
use crate::discover::friction::naming::LEAST_EVIDENCE;
use crate::discover::noise::PRACTICAL_RATIO;
use crate::identify::errors::MODEL_TENSION_RATIO;
use crate::identify::unknown::Unknown;
use crate::run::{Run, RunSample};

/// Maximum number of samples to compare in the search. Shapes are quasi-static, and turning points are kept. But between so few samples a lag is only
/// interpolated, and a step has no exact time, so the last fit has the whole run.
const MOST_SAMPLES: usize = 200;
/// Number of candidates with a name, and of others, that are fitted in each step, in the order of their predicted gains.
const MOST_TRIALS: usize = 4;
const MOST_OTHER_TRIALS: usize = 3;
const MOST_CANDIDATES: usize = 4;
/// Remaining squares per number above which a fit counts as stuck, and the points from which it is restarted, in widest intervals.
const STUCK_RATIO: f64 = 2.0;
const RESTARTS: [f64; 6] = [-6.0, -4.0, -2.0, 2.0, 4.0, 6.0];
/// Error of the way that the disks go while the markers are late, as a fraction of it: the holes differ. At half of it a delay of 0.4 s in a single pull passes
/// for a precurvature too; at twice, what moves the tip less than a fiftieth of that way has no name beside a delay.
const PATH_RATIO: f64 = 0.01;
/// Candidates that promise this fraction of the best one's evidence are fitted completely before they are compared.
const NEAR_RATIO: f64 = 0.8;

/// The findings of the search.
pub struct Machine {
    pub named: Vec<Named>,
    /// The tables of the file with the findings.
    pub tables: ManipulatorTables,
    /// Errors of each grating's line, in standard errors of its constant and slope.
    pub lines: Vec<[f64; 2]>,
    /// Time by which all markers are late, s; 0 unless it is clear.
    pub marker_lag_s: f64,
    /// Holes, counted from 0, that differ in a way which neither another bending of a segment nor the like explains as well.
    pub rough: Vec<usize>,
    /// μ of each hole, as far as the run distinguishes it from the shared one; empty if the file has no friction with memory.
    pub mu: Vec<f64>,
}

impl Machine {
    /// Returns empty findings.
    pub fn none(file: &ManipulatorFile) -> Self {
        Self {
            named: Vec::new(),
            tables: file.tables().clone(),
            lines: vec![[0.0; 2]; file.tables().disk_count],
            marker_lag_s: 0.0,
            rough: Vec::new(),
            mu: Vec::new(),
        }
    }
}

/// A named candidate.
#[derive(Clone, Debug)]
pub struct Named {
    pub candidate: Candidate,
    pub parameters: Numbers,
    pub standard_errors: Numbers,
    pub delta_bic: f64,
    pub gap_closed: f64,
    /// The best other candidate in its place, and its evidence.
    pub runner_up: Option<(Candidate, f64)>,
    /// Candidates that the run does not distinguish from it.
    pub alike: Vec<Candidate>,
}

/// A fitted candidate.
struct Trial {
    candidate: Candidate,
    at: Place,
    /// Decrease of the cost.
    gain: f64,
    /// BIC with the candidate minus BIC without it, assuming white noise.
    delta_bic: f64,
}

/// A candidate that entered, with the alternatives tried in its place.
#[derive(Clone)]
struct Entry {
    candidate: Candidate,
    gain: f64,
    delta_bic: f64,
    runner_up: Option<(Candidate, f64)>,
    alike: Vec<Candidate>,
}

/// A minimum with its slopes.
#[derive(Clone)]
struct Place {
    point: Point,
    set: Set,
    jacobian: Jacobian,
    units: Units,
}

/// Searches for wrong numbers. Returns `None` if tensions and markers cannot be compared, or `progress` is stopped.
pub fn search(file: &ManipulatorFile, run: &Run, progress: &Progress) -> Option<Machine> {
    let candidates = Candidate::all(file.tables(), run.has_markers());
    let kept = thinned_to(run.samples(), MOST_SAMPLES);
    let samples: Vec<RunSample> = kept.iter().filter_map(|place| run.samples().get(*place)).cloned().collect();
    let few = Run::new(samples, run.disk_count()).ok()?;
    let mut search = Search { joint: Joint::new(file, &few, &candidates, progress)?, candidates };
    let start = search.joint.start()?;
    let (common, units) = (search.joint.common(), search.joint.units(&start));
    let jacobian = search.joint.jacobian(&start)?;
    let point = search.joint.fitted(&start, &common, &jacobian, &[Unknown::SharedMu], units)?;
    let mut before = search.settled(point, common)?;
    let mut entries: Vec<Entry> = Vec::new();
    let mut now = before.clone();
    while entries.len() < MOST_CANDIDATES {
        let chosen: Vec<Candidate> = entries.iter().map(|entry| entry.candidate).collect();
        let Some((entry, place)) = search.enter(&mut now, &chosen) else { break };
        entries.push(entry);
        now = place;
    }
    if entries.len() > 1 {
        (entries, now) = search.reconsidered(entries, now, &before)?;
    }
    if !entries.is_empty() && run.samples().len() > kept.len() {
        // A step that the file states has its time.
        let is_stepping = entries.iter().any(|entry| entry.candidate == Candidate::Temperature)
            && file.tables().gratings.as_ref().is_none_or(|table| table.common_step_nm.is_none());
        let step_nm = is_stepping.then(|| search.joint.found(&now.point, Unknown::CommonShift));
        let near_s = search.joint.step_s();
        let step_s =
            step_nm.zip(near_s).and_then(|(step_nm, near_s)| step_time_s(run, &kept, near_s, step_nm)).or(near_s);
        let count = search.count(&now.point);
        search = Search { joint: Joint::new(file, run, &search.candidates, progress)?, ..search };
        search.joint.set_step_s(step_s);
        before = search.settled(search.joint.again(&before.point)?, before.set)?;
        now = search.settled(search.joint.again(&now.point)?, now.set)?;
        let more = search.count(&now.point) / count;
        for entry in &mut entries {
            entry.gain *= more;
        }
    }
    (entries, now) = search.without_guesses(entries, now, &before)?;
    search.named(file, &entries, &before, &now)
}

/// Returns the time of a step of all gratings, s, which is known to within the samples that a search has kept: where the mean shift leaves the straight
/// line between them. No turning point of the tension lies there.
fn step_time_s(run: &Run, kept: &[usize], near_s: f64, step_nm: f64) -> Option<f64> {
    let sample = |place: usize| run.samples().get(place);
    let after = kept.iter().position(|place| sample(*place).is_some_and(|sample| sample.time_s > near_s))?;
    let (from, to) = (*kept.get(after.checked_sub(1)?)?, *kept.get(after)?);
    let shift_nm = |place: usize, grating: usize| sample(place)?.shift_nm.get(grating).copied();
    let is_alive = |grating: &usize| (from..=to).all(|place| shift_nm(place, *grating).is_some_and(f64::is_finite));
    let alive: Vec<usize> = (0..run.disk_count()).filter(is_alive).collect();
    if alive.is_empty() {
        return None;
    }
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let mean_nm = |place: usize| -> f64 {
        alive.iter().filter_map(|grating| shift_nm(place, *grating)).sum::<f64>() / alive.len() as f64
    };
    let time_s = |place: usize| sample(place).map_or(f64::NAN, |sample| sample.time_s);
    let (first_nm, last_nm) = (mean_nm(from), mean_nm(to) - step_nm);
    let straight_nm =
        |place| first_nm + (last_nm - first_nm) * (time_s(place) - time_s(from)) / (time_s(to) - time_s(from));
    let squares = |begin: usize| -> f64 {
        let off = |place: usize| mean_nm(place) - straight_nm(place) - if place >= begin { step_nm } else { 0.0 };
        (from + 1..to).map(off).map(|off_nm| off_nm * off_nm).sum()
    };
    let begin = (from + 1..=to).min_by(|one, other| squares(*one).total_cmp(&squares(*other)))?;
    Some(0.5 * (time_s(begin - 1) + time_s(begin)))
}

struct Search<'a> {
    joint: Joint<'a>,
    candidates: Vec<Candidate>,
}

impl Search<'_> {
    fn place(&self, point: Point, set: Set) -> Option<Place> {
        let jacobian = self.joint.jacobian(&point)?;
        let units = self.joint.units(&point);
        Some(Place { point, set, jacobian, units })
    }

    /// Returns the minimum near a point that was found with slopes of another one.
    fn settled(&self, point: Point, set: Set) -> Option<Place> {
        let near = self.place(point, set)?;
        let point = self.joint.fitted(&near.point, &near.set, &near.jacobian, &[], near.units)?;
        let units = self.joint.units(&point);
        Some(Place { point, units, ..near })
    }

    fn set_of(&self, common: &Set, candidates: &[Candidate]) -> Set {
        candidates.iter().fold(common.clone(), |set, candidate| self.joint.with(&set, *candidate))
    }

    /// Returns the candidate that decreases the cost most beside the present ones, if it is significant.
    fn enter(&mut self, now: &mut Place, chosen: &[Candidate]) -> Option<(Entry, Place)> {
        self.begin_step(now, chosen);
        let gram = self.joint.gram(&now.point, &now.jacobian, now.units);
        let count = self.count(&now.point);
        let (own_gain, _) = self.joint.linear(&now.point, &now.set, (&gram.0, &gram.1))?;
        let cost = self.joint.cost(&now.point, &now.set, now.units);
        let promised = |candidate: &Candidate| {
            let set = self.joint.with(&now.set, *candidate);
            let (gain, _) = self.joint.linear(&now.point, &set, (&gram.0, &gram.1))?;
            // A number that is free already costs less with a wider prior.
            let gain = gain + cost - self.joint.cost(&now.point, &set, now.units);
            let score = gain - own_gain - self.joint.numbers(*candidate) * count.ln();
            (score > LEAST_EVIDENCE).then_some((*candidate, set, score))
        };
        let beside = self.candidates.iter().filter(|candidate| !chosen.contains(candidate));
        let mut ranking: Vec<(Candidate, Set, f64)> = beside.filter_map(promised).collect();
        ranking.sort_by(|(.., one), (.., other)| other.total_cmp(one));
        let (named, others): (Vec<_>, Vec<_>) = ranking.into_iter().partition(|(candidate, ..)| candidate.is_named());
        let picked: Vec<(Candidate, Set, f64)> =
            named.into_iter().take(MOST_TRIALS).chain(others.into_iter().take(MOST_OTHER_TRIALS)).collect();
        let least_gain = self.own_error(now, PRACTICAL_RATIO);
        let trial = |(candidate, set, _): (Candidate, Set, f64)| {
            let fresh = candidate.frees(&self.joint.runs.given);
            let point = self.joint.fitted(&now.point, &set, &now.jacobian, &fresh, now.units)?;
            let point = self.restarted(point, &set, &fresh, now.units);
            let gain = cost - self.joint.cost(&point, &set, now.units);
            let delta_bic = self.joint.numbers(candidate) * count.ln() - gain;
            let is_possible = candidate != Candidate::TipLoad || self.has_possible_tip(&point);
            let is_enough = delta_bic < -LEAST_EVIDENCE && gain > least_gain;
            (is_possible && is_enough).then_some((candidate, point, set, delta_bic))
        };
        let trials: Vec<(Candidate, Point, Set, f64)> = picked.into_par_iter().filter_map(trial).collect();
        // Candidates near the best are fitted with their own slopes.
        let best = trials.iter().map(|(.., delta_bic)| *delta_bic).fold(0.0, f64::min);
        let near = trials.into_par_iter().filter(|(.., delta_bic)| *delta_bic <= NEAR_RATIO * best);
        let sharpened = |(candidate, point, set, _): (Candidate, Point, Set, f64)| {
            let at = self.settled(point, set)?;
            let gain = cost - self.joint.cost(&at.point, &at.set, now.units);
            let delta_bic = self.joint.numbers(candidate) * count.ln() - gain;
            Some(Trial { candidate, at, gain, delta_bic })
        };
        let mut trials: Vec<Trial> = near.filter_map(sharpened).collect();
        trials.sort_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic));
        while !trials.is_empty() {
            let place = taken(&trials, self.margin(now));
            let design = self.design(trials.get(place)?);
            let evidence = |trial: &Trial| self.joint.numbers(trial.candidate) * count.ln() - trial.gain / design;
            let trial = trials.get(place)?;
            if evidence(trial) > -LEAST_EVIDENCE {
                trials.remove(place);
                continue;
            }
            // The model's own error b changes the difference D of two costs by up to 2|b|√D.
            let bound = trials.first()?.delta_bic + LEAST_EVIDENCE + 4.0 * self.own_error(now, MODEL_TENSION_RATIO);
            let others = || trials.iter().filter(|other| other.candidate != trial.candidate);
            let mut alike: Vec<Candidate> = Vec::new();
            for other in others().filter(|other| other.candidate.is_named() && other.delta_bic < bound) {
                if alike.iter().all(|one| one.kind() != other.candidate.kind()) {
                    alike.push(other.candidate);
                }
            }
            let entry = Entry {
                candidate: trial.candidate,
                gain: trial.gain,
                delta_bic: evidence(trial),
                runner_up: others().next().map(|other| (other.candidate, evidence(other))),
                alike,
            };
            return Some((entry, trials.swap_remove(place).at));
        }
        None
    }

    /// Returns the ratio of the variance of a candidate's numbers to that under white noise. The gain must be divided by it to be evidence.
    fn design(&self, trial: &Trial) -> f64 {
        let joint = &self.joint;
        let Some(errors) = joint.errors(&trial.at.point, &trial.at.set, &trial.at.jacobian) else {
            return f64::INFINITY;
        };
        let unknowns = trial.candidate.frees(&joint.runs.given);
        let places: Vec<usize> = unknowns.iter().filter_map(|unknown| joint.place(*unknown)).collect();
        let own = errors.iter().filter(|error| places.contains(&error.place));
        own.map(|error| (error.whole / error.white).powi(2)).filter(|ratio| ratio.is_finite()).fold(1.0, f64::max)
    }

    /// Returns a better minimum if a fit got stuck: a manipulator under its weight can fall to another side within the search range. The search
    /// restarts from the values of the file, with the candidate's number at some distances from the stated one.
    fn restarted(&self, point: Point, set: &Set, fresh: &[Unknown], units: Units) -> Point {
        let cost = self.joint.cost(&point, set, units);
        let [unknown] = fresh else { return point };
        if cost < STUCK_RATIO * self.count(&point) {
            return point;
        }
        let given = &self.joint.runs.given;
        let widest = unknown.widest(given, self.joint.runs.greatest_tension_n);
        let at = |share: f64| self.joint.at(*unknown, share * widest);
        let starts: Vec<Point> = RESTARTS.into_par_iter().filter_map(at).collect();
        let by_cost = |one: &&Point, other: &&Point| {
            self.joint.cost(one, set, units).total_cmp(&self.joint.cost(other, set, units))
        };
        let Some(best) = starts.iter().min_by(by_cost) else { return point };
        let settled = self.settled(best.clone(), set.clone()).and_then(|near| self.settled(near.point, near.set));
        match settled {
            Some(other) if self.joint.cost(&other.point, set, units) < cost => other.point,
            _ => point,
        }
    }

    /// Sets the time from which on a common shift of all gratings would explain most, if the file states none.
    fn begin_step(&mut self, now: &mut Place, chosen: &[Candidate]) {
        let Some(shift) = self.joint.place(Unknown::CommonShift) else { return };
        let Some(gratings) = &mut self.joint.runs.given.gratings else { return };
        if gratings.common_step_nm.is_some() || chosen.contains(&Candidate::Temperature) {
            return;
        }
        gratings.common_step_s = None;
        let Some(whole) = self.joint.slope(&now.point, shift) else { return };
        now.jacobian.replace(shift, whole);
        let begin = self.joint.step_begin(&now.point, &now.set, &now.jacobian, now.units).unwrap_or(0);
        let times_s = self.joint.runs.times_s();
        let before = begin.checked_sub(1).and_then(|before| times_s.get(before));
        let Some(gratings) = &mut self.joint.runs.given.gratings else { return };
        gratings.common_step_s = before.zip(times_s.get(begin)).map(|(before, at)| 0.5 * (before + at));
        if let Some(slope) = self.joint.slope(&now.point, shift) {
            now.jacobian.replace(shift, slope);
        }
    }

    /// Tests each candidate again: whether it is significant beside the others, and whether another one is better in its place.
    fn reconsidered(&mut self, mut entries: Vec<Entry>, mut now: Place, before: &Place) -> Option<(Vec<Entry>, Place)> {
        let mut at = 0;
        while at < entries.len() {
            let others: Vec<Candidate> = entries
                .iter()
                .enumerate()
                .filter(|(place, _)| *place != at)
                .map(|(_, entry)| entry.candidate)
                .collect();
            let set = self.set_of(&before.set, &others);
            let fresh: Vec<Unknown> =
                others.iter().flat_map(|candidate| candidate.frees(&self.joint.runs.given)).collect();
            let step_s = self.joint.step_s();
            let point = self.joint.fitted(&now.point, &set, &now.jacobian, &fresh, now.units)?;
            let mut without = self.settled(point, set)?;
            match self.enter(&mut without, &others) {
                None => {
                    entries.remove(at);
                    now = without;
                    continue;
                }
                Some((entry, place)) => {
                    if entry.candidate != entries[at].candidate && others.contains(&Candidate::Temperature) {
                        self.joint.set_step_s(step_s);
                    }
                    now = place;
                    entries[at] = entry;
                }
            }
            at += 1;
        }
        Some((entries, now))
    }

    fn count(&self, point: &Point) -> f64 {
        let sums = self.joint.sums(point);
        (sums.tension_count + sums.marker_count).max(2.0)
    }

    fn has_possible_tip(&self, point: &Point) -> bool {
        self.joint.runs.given.tip.mass_kg + self.joint.found(point, Unknown::TipMass) >= 0.0
    }

    /// Returns what the model's own error makes of the cost if that of the tensions is this fraction of the greatest. A candidate that only stands for this
    /// error gains no more.
    fn own_error(&self, now: &Place, tension_ratio: f64) -> f64 {
        let sums = self.joint.sums(&now.point);
        let tension = tension_ratio * self.joint.runs.greatest_tension_n / now.units.tension_n;
        let lag_s = self.joint.found(&now.point, Unknown::MarkerLag);
        let slope = self
            .joint
            .place(Unknown::MarkerLag)
            .filter(|_| lag_s != 0.0)
            .and_then(|place| self.joint.slope(&now.point, place));
        let path_m =
            slope.unwrap_or_default().into_iter().filter(|one| one.is_finite()).map(|one| PATH_RATIO * lag_s * one);
        let arcs_m2: f64 = self.joint.arc_error_m.iter().copied().chain(path_m).map(|off_m| off_m * off_m).sum();
        sums.tension_count * tension * tension + arcs_m2 / now.units.marker_m.powi(2)
    }

    /// Returns the difference up to which two candidates explain a run equally: chance plus the model's own error.
    fn margin(&self, now: &Place) -> f64 {
        LEAST_EVIDENCE + self.own_error(now, MODEL_TENSION_RATIO)
    }
}

/// Returns the index of the trial that enters; the best trial comes first. Among equal trials it is one without a name here if it is as good, else
/// the one whose stated value is least reliable.
fn taken(trials: &[Trial], margin: f64) -> usize {
    let best = trials.first().map_or(0.0, |trial| trial.delta_bic);
    let is_unnamed = |trial: &Trial| !trial.candidate.is_named() && trial.delta_bic < best + LEAST_EVIDENCE;
    let close = || trials.iter().enumerate().filter(|(_, trial)| trial.delta_bic < best + margin);
    let by_rank = || close().max_by_key(|(place, trial)| (trial.candidate.rank(), std::cmp::Reverse(*place)));
    trials.iter().position(is_unnamed).or_else(|| by_rank().map(|(place, _)| place)).unwrap_or(0)
}
