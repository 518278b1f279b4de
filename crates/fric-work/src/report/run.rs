//! A run of set points, reduced to what a screen can show. Memory does not depend on its length.

use fric_lab::excite::ExcitedCycle;
use fric_lab::trajectory::Phase;

use super::series::Extent;

/// Maximum number of intervals, about the width of a chart in pixels.
const MOST_INTERVALS: u64 = 900;

/// A run, reduced to what a page can show.
#[derive(Debug)]
pub struct RunSeries {
    cycles_per_interval: u64,
    cycles_in_last: u64,
    intervals: Vec<RunInterval>,
    /// Speed, least and greatest force of the last cycle, where the next interval starts.
    last: [f64; 3],
    phases: Vec<PhaseSpan>,
    end_s: f64,
}

/// The range of the motion in one interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunInterval {
    pub start_s: f64,
    /// Speed of the platform, or of the fastest cable without one, m/s.
    pub speed: Extent,
    /// Least and greatest force of the cables, N.
    pub least_n: Extent,
    pub greatest_n: Extent,
    /// Lengths of the cables, m.
    pub length_m: Extent,
}

/// The motion in one phase.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhaseSpan {
    pub phase: Phase,
    pub start_s: f64,
    pub end_s: f64,
    pub fastest: f64,
    pub tension_n: Extent,
}

impl RunSeries {
    /// Creates an empty run of `total_cycles`.
    #[must_use]
    pub fn new(total_cycles: u64) -> Self {
        Self {
            cycles_per_interval: total_cycles.div_ceil(MOST_INTERVALS).max(1),
            cycles_in_last: 0,
            intervals: Vec::new(),
            last: [f64::NAN; 3],
            phases: Vec::new(),
            end_s: 0.0,
        }
    }

    /// Adds a cycle.
    pub fn add(&mut self, cycle: &ExcitedCycle<'_>) {
        let ExcitedCycle { time_s, phase, platform, cables, tensions_n, .. } = *cycle;
        let speed = platform.map_or_else(
            || cables.iter().map(|cable| cable.speed_m_per_s.abs()).fold(0.0, f64::max),
            |set_point| set_point.velocity_m_per_s.norm(),
        );
        let mut tension_n = Extent::NOTHING;
        for force_n in tensions_n.unwrap_or_default() {
            tension_n.add(*force_n);
        }
        self.end_s = time_s;
        if self.cycles_in_last == self.cycles_per_interval || self.intervals.is_empty() {
            let [speed, least_n, greatest_n, length_m] = [Extent::NOTHING; 4];
            self.intervals.push(RunInterval { start_s: time_s, speed, least_n, greatest_n, length_m });
            self.cycles_in_last = 0;
        }
        self.cycles_in_last += 1;
        if let Some(interval) = self.intervals.last_mut() {
            for cable in cables {
                interval.length_m.add(cable.length_m);
            }
        }
        let now = [speed, tension_n.least, tension_n.greatest];
        for [speed, least_n, greatest_n] in [std::mem::replace(&mut self.last, now), now] {
            if let Some(interval) = self.intervals.last_mut() {
                interval.speed.add(speed);
                interval.least_n.add(least_n);
                interval.greatest_n.add(greatest_n);
            }
        }
        if self.phases.last().is_none_or(|last| last.phase != phase) {
            let (start_s, end_s) = (time_s, time_s);
            self.phases.push(PhaseSpan { phase, start_s, end_s, fastest: 0.0, tension_n: Extent::NOTHING });
        }
        if let Some(last) = self.phases.last_mut() {
            last.end_s = time_s;
            last.fastest = last.fastest.max(speed);
            last.tension_n.merge(tension_n);
        }
    }

    /// Returns the range of speeds of the whole run, from 0, m/s.
    pub(crate) fn speed(&self) -> Extent {
        let fastest = self.phases.iter().map(|phase| phase.fastest).fold(0.0, f64::max);
        Extent { least: 0.0, greatest: fastest }
    }

    /// Returns the range of cable forces of the whole run, N, if there are any.
    pub(crate) fn tension_n(&self) -> Option<Extent> {
        let mut all = Extent::NOTHING;
        for phase in &self.phases {
            all.merge(phase.tension_n);
        }
        all.is_something().then_some(all)
    }

    /// Returns the range of the lengths of the whole run over all cables, m.
    pub(crate) fn length_m(&self) -> Extent {
        self.intervals.iter().map(|interval| interval.length_m).fold(Extent::NOTHING, Extent::merged)
    }

    /// Returns the intervals in order.
    pub(crate) fn intervals(&self) -> &[RunInterval] {
        &self.intervals
    }

    /// Returns the phases in order.
    pub(crate) fn phases(&self) -> &[PhaseSpan] {
        &self.phases
    }

    /// Returns the time of the last cycle, s.
    pub(crate) fn end_s(&self) -> f64 {
        self.end_s
    }
}
