//! The text of the robot file under construction.

use std::fmt::Write as _;

use fric_core::parameters::{FRICTION, ParameterRow, SIGMA};
use fric_core::robot::file::TIME_COLUMN;
use fric_core::text_file::name_problem;
use fric_lab::text::wrapped;

/// Stiffness before a cable slides, per force: friction of 3 % of the force builds up over 0.3 mm, as on the robot of the paper.
const SIGMA_PER_FORCE_1_PER_M: f64 = 100.0;
/// Force that is assumed where none is known, N.
const USUAL_FORCE_N: f64 = 10.0;

/// Ends of the keys of a cable's signals.
pub const FORCE: &str = ".force_n";
pub const LENGTH: &str = ".length_m";
pub const REFERENCE: &str = ".reference_n";

/// A column of a CSV log and its probable signal.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnGuess {
    /// The key under `[log.columns]`.
    pub key: String,
    pub column: String,
    pub factor: f64,
    /// Whether the header states its unit beside the name.
    pub states_unit: bool,
}

impl ColumnGuess {
    /// Returns its line under `[log.columns]`.
    fn entry(&self) -> String {
        let Self { key, column, factor, .. } = self;
        let factor = if is_one(*factor) { String::new() } else { format!(", factor = {factor:?}") };
        format!("{key:?} = {{ column = {column:?}{factor} }}")
    }
}

/// A column that may be a signal, as a comment beside the columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Offer {
    pub guess: ColumnGuess,
    /// When to take it.
    pub condition: &'static str,
}

/// The known content so far.
#[derive(Debug, Clone)]
pub struct Draft {
    name: String,
    interval_s: Option<f64>,
    /// Stiffness before the cable slides, from the size of the forces, N/m.
    sigma_n_per_m: f64,
    /// Names of the cables.
    pub cables: Vec<String>,
    /// Keys and values under `[log]`.
    pub paths: Vec<(&'static str, String)>,
    pub columns: Vec<ColumnGuess>,
    pub offers: Vec<Offer>,
    /// Keys of the forces and lengths without a column.
    pub missing: Vec<String>,
    pub has_pose: bool,
    /// Signals that could not be guessed, as comments.
    pub notes: Vec<String>,
}

impl Draft {
    /// Creates a draft for a robot of this name, if the name is valid.
    pub fn new(name: String) -> Self {
        let name = if name.is_empty() || name_problem(&name).is_some() { "robot".to_owned() } else { name };
        Self {
            name,
            interval_s: None,
            sigma_n_per_m: SIGMA_PER_FORCE_1_PER_M * USUAL_FORCE_N,
            cables: Vec::new(),
            paths: Vec::new(),
            columns: Vec::new(),
            offers: Vec::new(),
            missing: Vec::new(),
            has_pose: false,
            notes: Vec::new(),
        }
    }

    /// Whether the header states the unit of the time.
    pub fn time_states_its_unit(&self) -> bool {
        let time = self.columns.iter().find(|guess| guess.key == TIME_COLUMN);
        time.is_none_or(|time| time.states_unit || time.column.ends_with("_s") || time.column.ends_with("_sec"))
    }

    /// Returns the draft with a factor for the column of the time.
    pub fn with_time_factor(&self, factor: f64) -> Self {
        let mut draft = self.clone();
        let column = draft.columns.iter().position(|guess| guess.key == TIME_COLUMN);
        let column = column.map_or_else(|| TIME_COLUMN.to_owned(), |place| draft.columns.remove(place).column);
        draft.notes.push(format!(
            "{TIME_COLUMN}: column {column:?} does not look like seconds; a factor of {factor:?} is taken"
        ));
        draft.columns.insert(0, ColumnGuess { key: TIME_COLUMN.to_owned(), column, factor, states_unit: false });
        draft
    }

    /// Returns the draft with the cable's other signal, else the time, in place of each one without a column, so that the samples can be read.
    pub fn with_stand_ins(&self) -> Self {
        let mut draft = self.clone();
        for key in &self.missing {
            let other = match key.strip_suffix(FORCE) {
                Some(cable) => format!("{cable}{LENGTH}"),
                None => key.replace(LENGTH, FORCE),
            };
            let stand_in = if self.missing.contains(&other) { TIME_COLUMN } else { other.as_str() };
            let guess = self.columns.iter().find(|guess| guess.key == stand_in);
            let column = guess.map_or(stand_in, |guess| guess.column.as_str()).to_owned();
            draft.columns.push(ColumnGuess { key: key.clone(), column, factor: 1.0, states_unit: true });
        }
        draft
    }

    /// Takes the usual interval of the samples, s, and the mean force, N, if there are samples.
    pub fn set_beginning(&mut self, beginning: Option<(f64, f64)>) {
        if let Some((interval_s, force_n)) = beginning {
            self.interval_s = Some(interval_s);
            if self.missing.iter().any(|key| key.ends_with(FORCE)) {
                return;
            }
            let sigma_n_per_m = one_digit(SIGMA_PER_FORCE_1_PER_M * force_n);
            let ParameterRow { min, max, .. } = FRICTION[SIGMA];
            if (min..=max).contains(&sigma_n_per_m) {
                self.sigma_n_per_m = sigma_n_per_m;
            }
        } else {
            self.notes
                .push("cycle_s could not be found: no two samples could be read with what was guessed".to_owned());
        }
    }

    /// Returns a summary of the guesses for people.
    pub fn summary(&self) -> String {
        let Self { cables, notes, interval_s, .. } = self;
        let rate = interval_s.map_or_else(String::new, |it| format!(", a sample every {} s", rounded(it)));
        let plural = if cables.len() == 1 { "" } else { "s" };
        let mut text = wrapped("", &format!("{} cable{plural}: {}{rate}", cables.len(), cables.join(", ")));
        for note in notes {
            text += &wrapped("  ", note);
        }
        text
    }

    /// Returns the robot file.
    pub fn text(&self) -> String {
        let Self { name, interval_s, sigma_n_per_m, cables, paths, columns, offers, has_pose, notes, .. } = self;
        let mut text = String::from(
            "# A robot file to start from, made of a log. What is marked with `?` is to be checked on the machine.\n",
        );
        for note in notes {
            let _ = writeln!(text, "# ? {}", note.replace('\n', " "));
        }
        let cycle = interval_s.map_or_else(
            || "0.001 # ? cycle time, s".to_owned(),
            |interval_s| format!("{:?} # the usual interval of the log's samples, s", rounded(interval_s)),
        );
        let _ = writeln!(text, "format = \"fric-robot/1\"\nname = {name:?}\ncycle_s = {cycle}\n");
        if *has_pose {
            text += "# ? [platform]\n# ? mass_kg = 1.0\n\n";
        }
        if !paths.is_empty() {
            text += "[log]\n";
            for (key, value) in paths {
                let _ = writeln!(text, "{key} = {value:?}");
            }
            text += "\n";
        }
        if !columns.is_empty() || !offers.is_empty() {
            text += "[log.columns]\n";
            for guess in columns {
                let _ = writeln!(text, "{}", guess.entry());
            }
            for Offer { guess, condition } in offers {
                let _ = writeln!(text, "# ? {} # {condition}", guess.entry());
            }
            text += "\n";
        }
        for cable in cables {
            let _ = writeln!(text, "[[cable]]\nname = {cable:?}");
            if *has_pose {
                text += "# ? base_m = [0.0, 0.0, 0.0]     # where the cable enters the last pulley, base frame\n\
                         # ? platform_m = [0.0, 0.0, 0.0] # its attachment, platform frame\n";
            }
            let _ = writeln!(
                text,
                "pulleys = [ {{ wrap_deg = 90.0 }} ] # ? from the sensor to the platform; {{ wrap_deg = 180.0, sensor = true }} is a sensor pulley\n\
                 friction = {{ mu = 0.02, sigma_n_per_m = {sigma_n_per_m:?}, viscous_n_s_per_m = 0.0 }} # ? to start from: `fric-cli fit` finds them\n"
            );
        }
        text
    }
}

pub fn is_one(factor: f64) -> bool {
    factor.to_bits() == 1.0_f64.to_bits()
}

/// Rounds to one digit, which is all that is known of it.
fn one_digit(number: f64) -> f64 {
    format!("{number:.0e}").parse().unwrap_or(number)
}

/// Rounds to three digits, as cycle times usually are.
fn rounded(interval_s: f64) -> f64 {
    format!("{interval_s:.2e}").parse().unwrap_or(interval_s)
}

#[cfg(test)]
mod tests {
    use super::Draft;

    #[test]
    fn the_stiffness_to_start_from_goes_with_the_force() {
        let text = |force_n| {
            let mut draft = Draft::new("winch".to_owned());
            draft.cables.push("cable1".to_owned());
            draft.set_beginning(Some((1e-3, force_n)));
            draft.text()
        };
        assert!(text(523.0).contains("sigma_n_per_m = 50000.0,"), "{}", text(523.0));
        for force_n in [f64::NAN, 0.0, 1e-9] {
            assert!(text(force_n).contains("sigma_n_per_m = 1000.0,"), "{}", text(force_n));
        }
    }
}
