//! A path of goals: the tensions that follow it, and the simulated manipulator's tip on it.

use std::fmt::Write as _;

use fric_lab::text::{number, table, wrapped};
use fric_tendon::GoalStatus;
use serde::Serialize;

use super::millimetres;
use crate::follow::{FollowedGoal, Goals};
use crate::shape_errors::Way;
use crate::simulate::track::{Track, TrackOptions, TrackedGoal};

/// Maximum number of goals in the table for people.
const MOST_ROWS: usize = 12;

/// `fric-continuum-track/1`. Lists have one entry per goal. Tensions are those that the sensor at the base shows, and positions are in the frame of the
/// markers, if the manipulator file states them.
#[derive(Clone, Debug, Serialize)]
pub struct TrackResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Name of the manipulator.
    pub manipulator: String,
    /// The friction model.
    pub way: Way,
    /// Number of goals.
    pub goals: usize,
    /// Number of goals that the commands reach.
    pub reached: usize,
    /// Times, s, if the path states them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<Vec<f64>>,
    /// Wanted bends, rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wanted_bend_rad: Option<Vec<f64>>,
    /// Wanted positions of the tip, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wanted_tip_m: Option<Vec<[f64; 2]>>,
    /// Tensions to set at the base, N: first and second tendon.
    pub tension_base_n: Vec<[f64; 2]>,
    /// Predicted bends, rad.
    pub bend_rad: Vec<f64>,
    /// Predicted positions of the tip, m.
    pub tip_m: Vec<[f64; 2]>,
    /// Status of each command: `ok`, or the names of its flags separated by `|`.
    pub status: Vec<String>,
    /// The path on the simulated manipulator.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<TrackSimulation>,
}

/// The path on a simulated manipulator, by each friction model.
#[derive(Clone, Debug, Serialize)]
pub struct TrackSimulation {
    /// Seed.
    pub seed: u64,
    /// Maximum relative difference of each hole's μ from the stated one.
    pub mu_spread_ratio: f64,
    /// The friction models.
    pub ways: Vec<TrackErrors>,
}

/// Distances of the simulated manipulator's tip from its goals, with the commands of one friction model.
#[derive(Clone, Debug, Serialize)]
pub struct TrackErrors {
    /// Name of the friction model.
    pub way: Way,
    /// Mean distance, mm.
    pub mean_mm: f64,
    /// Greatest distance, mm.
    pub max_mm: f64,
    /// Mean distance along the tip's curve, mm.
    pub mean_along_mm: f64,
    /// Mean difference from the wanted bend, rad, if the goals are bends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_bend_error_rad: Option<f64>,
    /// Distance at each goal, mm.
    pub error_mm: Vec<f64>,
    /// Distance beyond each goal along the tip's curve, mm.
    pub along_mm: Vec<f64>,
    /// Tension at the base at each goal, N.
    pub tension_base_n: Vec<f64>,
    /// Bend at each goal, rad.
    pub bend_rad: Vec<f64>,
}

impl TrackSimulation {
    /// Creates the result of a path on the simulated manipulator.
    #[must_use]
    pub fn new(options: &TrackOptions, tracks: &[Track]) -> Self {
        let errors = |track: &Track| {
            let each = |of: &dyn Fn(&TrackedGoal) -> f64| track.goals.iter().map(of).collect::<Vec<f64>>();
            let error_mm = each(&|goal| 1e3 * goal.error_m());
            TrackErrors {
                way: track.way,
                mean_mm: 1e3 * track.mean_error_m(),
                max_mm: error_mm.iter().copied().fold(0.0, f64::max),
                mean_along_mm: 1e3 * track.mean_along_m(),
                mean_bend_error_rad: track.mean_bend_error_rad(),
                error_mm,
                along_mm: each(&|goal| 1e3 * goal.along_m),
                tension_base_n: each(&|goal| goal.tension_base_n),
                bend_rad: each(&|goal| goal.bend_rad),
            }
        };
        let TrackOptions { seed, mu_spread_ratio, .. } = *options;
        Self { seed, mu_spread_ratio, ways: tracks.iter().map(errors).collect() }
    }

    /// Returns a table for people, at most 80 columns wide.
    #[must_use]
    pub fn table(&self) -> String {
        let has_bends = self.ways.iter().any(|way| way.mean_bend_error_rad.is_some());
        let row = |way: &TrackErrors| {
            let name = if way.way == Way::None { "no friction" } else { way.way.name() };
            let mut row = vec![name.to_owned()];
            row.extend([way.mean_mm, way.max_mm, way.mean_along_mm].map(|value| millimetres(Some(value))));
            row.extend(way.mean_bend_error_rad.map(|rad| format!("{:.2}", rad.to_degrees())));
            row
        };
        let rows: Vec<Vec<String>> = self.ways.iter().map(row).collect();
        let mut heads = vec!["", "mean\n[mm]", "greatest\n[mm]", "along its\ncurve [mm]"];
        if has_bends {
            heads.push("bend\n[°]");
        }
        let title = format!(
            "Simulated manipulator (seed {}, μ of its holes within {} % of the file's), distance of the tip from its goal by the friction \
             model of the commands:",
            self.seed,
            number(100.0 * self.mu_spread_ratio, 0)
        );
        let bends = if has_bends {
            " bend: mean difference from the wanted bend. The tip's goal is its place at that bend of a single pull, where it does not come \
             back to after a reversal, because friction of both directions bends the manipulator unevenly."
        } else {
            ""
        };
        let legend = format!(
            "along its curve: mean part of the distance in the direction in which a pull moves the tip; no tension corrects the rest.{bends}"
        );
        format!("{}\n{}\n{}", wrapped("", &title), table(&heads, 1, &rows), wrapped("", &legend))
    }
}

impl TrackResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-continuum-track/1";

    /// Creates the result of a followed path.
    #[must_use]
    pub fn new(
        manipulator: &str,
        way: Way,
        time_s: Option<&[f64]>,
        wanted: &Goals,
        followed: &[FollowedGoal],
        simulation: Option<TrackSimulation>,
    ) -> Self {
        let (wanted_bend_rad, wanted_tip_m) = match wanted {
            Goals::BendRad(bend_rad) => (Some(bend_rad.clone()), None),
            Goals::TipM(tip_m) => (None, Some(tip_m.clone())),
        };
        Self {
            format: Self::FORMAT,
            manipulator: manipulator.to_owned(),
            way,
            goals: followed.len(),
            reached: followed.iter().filter(|goal| goal.status.is_reached()).count(),
            time_s: time_s.map(<[f64]>::to_vec),
            wanted_bend_rad,
            wanted_tip_m,
            tension_base_n: followed.iter().map(|goal| goal.tension_base_n).collect(),
            bend_rad: followed.iter().map(|goal| goal.bend_rad).collect(),
            tip_m: followed.iter().map(|goal| goal.tip_m).collect(),
            status: followed.iter().map(|goal| goal.status.to_string()).collect(),
            simulation,
        }
    }

    /// Returns the number of commands with a flag.
    fn count_of(&self, flag: GoalStatus) -> usize {
        let name = flag.to_string();
        self.status.iter().filter(|status| status.split('|').any(|one| one == name)).count()
    }

    /// Returns warnings, one sentence each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let sentences = [
            (
                GoalStatus::OUT_OF_REACH,
                "out of reach, with the nearest command; check the range of the tensions and the goals",
            ),
            (
                GoalStatus::NOT_CONVERGED,
                "without a tension, with the last command again; check stiffness and weight in the file",
            ),
        ];
        let warning = |(flag, what): (GoalStatus, &str)| {
            let count = self.count_of(flag);
            let verb = if count == 1 { "is" } else { "are" };
            (count > 0).then(|| format!("{count} of {} goals {verb} {what}", self.goals))
        };
        sentences.into_iter().filter_map(warning).collect()
    }

    /// Returns a table for people, at most 80 columns wide.
    #[must_use]
    pub fn summary(&self) -> String {
        let counts: Vec<String> = GoalStatus::NAMES
            .iter()
            .map(|(name, flag)| (name, self.count_of(*flag)))
            .filter(|(_, count)| *count > 0)
            .map(|(name, count)| format!("{name} {count}"))
            .collect();
        let flags = if counts.is_empty() { String::new() } else { format!("; {}", counts.join(", ")) };
        let head = format!(
            "{}: by `{}` {} of {} goals reached{flags}",
            self.manipulator,
            self.way.name(),
            self.reached,
            self.goals
        );
        let has_second = self.tension_base_n.iter().any(|[_, second_n]| *second_n > 0.0);
        let mut heads = vec!["", "goal", "tension\n[N]"];
        if has_second {
            heads.push("second\n[N]");
        }
        heads.extend(["bend\n[°]", "status"]);
        let rows: Vec<Vec<String>> = (0..self.goals.min(MOST_ROWS)).map(|place| self.row(place, has_second)).collect();
        let mut text = format!("{}\n{}", wrapped("", &head), table(&heads, 1, &rows));
        if self.goals > MOST_ROWS {
            let _ = writeln!(text, "… and {} more: -o writes all", self.goals - MOST_ROWS);
        }
        if let Some(simulation) = &self.simulation {
            let _ = write!(text, "\n{}", simulation.table());
        }
        text
    }

    fn row(&self, place: usize, has_second: bool) -> Vec<String> {
        let name = match self.time_s.as_ref().and_then(|time_s| time_s.get(place)) {
            Some(time_s) => format!("{time_s:.2} s"),
            None => format!("goal {}", place + 1),
        };
        let bend = self.wanted_bend_rad.as_ref().and_then(|all| all.get(place));
        let tip = self.wanted_tip_m.as_ref().and_then(|all| all.get(place));
        let goal = match (bend, tip) {
            (Some(bend_rad), _) => format!("{:.1}°", bend_rad.to_degrees()),
            (None, Some([x_m, y_m])) => format!("{:.1}, {:.1} mm", 1e3 * x_m, 1e3 * y_m),
            (None, None) => String::new(),
        };
        let [first_n, second_n] = self.tension_base_n.get(place).copied().unwrap_or_default();
        let mut row = vec![name, goal, format!("{first_n:.4}")];
        if has_second {
            row.push(format!("{second_n:.4}"));
        }
        row.push(self.bend_rad.get(place).map_or_else(String::new, |bend_rad| format!("{:.1}", bend_rad.to_degrees())));
        row.push(self.status.get(place).cloned().unwrap_or_default());
        row
    }
}
