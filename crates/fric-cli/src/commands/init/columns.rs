//! Guesses the signals of a CSV log's columns from their names and units, in English and German.

use std::cmp::Reverse;

use fric_core::robot::file::{POSE_COLUMNS, TIME_COLUMN, WRENCH_COLUMNS};
use fric_log::units::{Head, Quantity, Unit, stated_unit};

use super::draft::{ColumnGuess, Draft, FORCE, LENGTH, Offer, REFERENCE, is_one};

/// What the header and the rows of a log tell of its columns.
#[derive(Debug, Clone, Copy)]
pub struct Table<'a> {
    pub names: &'a [String],
    /// The units that the log states apart from the names, empty if there are none.
    pub units: &'a [String],
    /// Of each column, whether it has dates or times of day.
    pub dated: &'a [bool],
    /// Of each column, whether all rows say the same.
    pub unchanging: &'a [bool],
}

impl<'a> Table<'a> {
    fn unit(&self, place: usize) -> &'a str {
        self.units.get(place).map_or("", String::as_str)
    }

    fn has_dates(&self, place: usize) -> bool {
        self.dated.get(place).copied().unwrap_or(false)
    }

    fn never_changes(&self, place: usize) -> bool {
        self.unchanging.get(place).copied().unwrap_or(false)
    }
}

/// Words in column names that indicate the content if no unit does.
const WORDS: [(&str, Quantity); 34] = [
    ("time", Quantity::Time),
    ("timestamp", Quantity::Time),
    ("datetime", Quantity::Time),
    ("stamp", Quantity::Time),
    ("zeit", Quantity::Time),
    ("uhrzeit", Quantity::Time),
    ("zeitstempel", Quantity::Time),
    ("t", Quantity::Time),
    ("force", Quantity::Force),
    ("tension", Quantity::Force),
    ("load", Quantity::Force),
    ("effort", Quantity::Force),
    ("kraft", Quantity::Force),
    ("seilkraft", Quantity::Force),
    ("f", Quantity::Force),
    ("fref", Quantity::Force),
    ("fplat", Quantity::Force),
    ("length", Quantity::Length),
    ("len", Quantity::Length),
    ("position", Quantity::Length),
    ("pos", Quantity::Length),
    ("displacement", Quantity::Length),
    ("stroke", Quantity::Length),
    ("encoder", Quantity::Length),
    ("weg", Quantity::Length),
    ("hub", Quantity::Length),
    ("länge", Quantity::Length),
    ("laenge", Quantity::Length),
    ("l", Quantity::Length),
    ("speed", Quantity::Speed),
    ("velocity", Quantity::Speed),
    ("geschwindigkeit", Quantity::Speed),
    ("vel", Quantity::Speed),
    ("v", Quantity::Speed),
];
/// Words that mark a force at the platform.
const REFERENCE_WORDS: [&str; 8] =
    ["ref", "reference", "referenz", "platform", "plattform", "payload", "fref", "fplat"];
/// Words that name no cable.
const OTHER_WORDS: [&str; 16] = [
    "cable", "seil", "winch", "winde", "motor", "cell", "zelle", "sensor", "raw", "filtered", "of", "the", "des",
    "der", "at", "in",
];
/// Words that mark what was measured, not commanded or computed.
const MEASURED_WORDS: [&str; 4] = ["ist", "actual", "measured", "gemessen"];
/// Words beside the axis of a column of the pose.
const POSE_WORDS: [&str; 13] = [
    "pose",
    "position",
    "pos",
    "platform",
    "plattform",
    "tcp",
    "tool",
    "ee",
    "translation",
    "p",
    "rigid",
    "body",
    "trans",
];
const ORIENTATION_WORDS: [&str; 8] = ["q", "quat", "quaternion", "orientation", "orient", "rotation", "rot", "ori"];
/// Words that mark what was commanded, not measured, and beginnings of such words.
const COMMAND_WORDS: [&str; 8] = ["set", "setpoint", "target", "command", "commanded", "cmd", "desired", "demand"];
const COMMAND_BEGINNING: &str = "soll";
/// Words of a place on the earth, which is no length of a cable.
const GEOGRAPHIC_WORDS: [&str; 8] = ["latitude", "longitude", "altitude", "lat", "lon", "alt", "east", "north"];
/// Words of what goes with the force where no sensor shows it: torques, and currents.
const TORQUE_WORDS: [&str; 5] = ["torque", "tau", "moment", "drehmoment", "motormoment"];
const CURRENT_WORDS: [&str; 3] = ["current", "strom", "motorstrom"];

/// A column that may be a signal.
struct Candidate {
    place: usize,
    guess: ColumnGuess,
}

/// Guesses the signals of the columns of a log.
pub fn guess(table: &Table<'_>, draft: &mut Draft) {
    let Table { names, .. } = *table;
    let (mut found, positions) = pose(table, draft);
    let (candidates, unknown) = candidates(table, &positions);
    let mut keys: Vec<&str> = Vec::new();
    for Candidate { guess, .. } in &candidates {
        if !keys.contains(&guess.key.as_str()) && !found.iter().any(|known| known.key == guess.key) {
            keys.push(&guess.key);
        }
    }
    // Forces come first, because the other signals go with them.
    keys.sort_by_key(|key| !key.ends_with(FORCE));
    let mut chosen: Vec<&Candidate> = Vec::new();
    for key in keys {
        let cable = key.rsplit_once('.').map_or("", |(cable, _)| cable);
        let force = chosen.iter().find(|one| one.guess.key == format!("{cable}{FORCE}"));
        let force_words = force.map_or_else(Vec::new, |force| telling_words(&force.guess.column));
        let mut of_key: Vec<&Candidate> = candidates.iter().filter(|one| one.guess.key == key).collect();
        if key.ends_with(LENGTH) {
            // One that is called so by its key is meant, whatever it shows.
            let is_still = |one: &&Candidate| table.never_changes(one.place) && one.guess.column != key;
            for Candidate { guess, .. } in of_key.iter().copied().filter(is_still) {
                draft.notes.push(format!("{key}: column {:?} never changes, and so is no length", guess.column));
            }
            of_key.retain(|one| !is_still(one));
        }
        of_key.sort_by_key(|one| {
            let words = telling_words(&one.guess.column);
            Reverse(words.iter().filter(|word| force_words.contains(word)).count())
        });
        let mut of_key = of_key.into_iter();
        chosen.extend(of_key.next());
        let reference = format!("{cable}{REFERENCE}");
        let is_free = key.ends_with(FORCE) && !candidates.iter().any(|one| one.guess.key == reference);
        for Candidate { guess, .. } in of_key {
            if is_free && !draft.offers.iter().any(|offer| offer.guess.key == reference) {
                let guess = ColumnGuess { key: reference.clone(), ..guess.clone() };
                draft.offers.push(Offer {
                    guess,
                    condition: "if this is the force at the platform; if it is the other one, exchange them",
                });
            } else {
                draft.notes.push(format!("{key}: column {:?} could be meant too", guess.column));
            }
        }
    }
    chosen.sort_by_key(|one| one.place);
    for Candidate { place, guess } in chosen {
        if let Some(unit) = unknown_unit(&guess.column, table.unit(*place)).filter(|_| !table.has_dates(*place)) {
            let ColumnGuess { key, column, .. } = guess;
            draft.notes.push(format!(
                "{key}: the unit {unit:?} of column {column:?} is not known; state its `factor` to that of the key"
            ));
        }
        found.push(guess.clone());
    }
    add_cables(&found, draft);
    offer_drives(table, &unknown, draft);
    let has_references = found.iter().any(|guess| guess.key.ends_with(REFERENCE));
    match draft.offers.iter().find(|offer| offer.guess.key.ends_with(REFERENCE)) {
        Some(Offer { guess: ColumnGuess { key, column, .. }, .. }) => draft.notes.push(format!(
            "{key}: column {column:?} is a second force; if it is that at the platform, remove the `# ?` in front of it"
        )),
        None if !has_references => draft.notes.push(
            "reference: no column looks like a force at the platform; name it under [log.columns] as NAME.reference_n, or a \
             known load under [log], such as reference = { constant_n = 49.05 } or reference = { hanging_mass_kg = 5.0 }"
                .to_owned(),
        ),
        None => {}
    }
    let has_pose_column = names.iter().any(|name| name == POSE_COLUMNS[0]);
    draft.has_pose = has_pose_column || found.iter().any(|guess| guess.key == POSE_COLUMNS[0]);
    if !draft.has_pose && positions.is_empty() {
        draft.notes.push("pose: no columns pose.x_m to pose.qw; a bench needs none".to_owned());
    }
    if !unknown.is_empty() {
        let unknown: Vec<&str> = unknown.iter().filter_map(|place| names.get(*place)).map(String::as_str).collect();
        draft.notes.push(format!("not used: {}", unknown.join(", ")));
    }
    // A reference of a cable without a force is dropped.
    found.retain(|guess| {
        let is_of_cable = || draft.cables.iter().any(|cable| guess.key.starts_with(&format!("{cable}.")));
        guess.key == TIME_COLUMN || POSE_COLUMNS.contains(&guess.key.as_str()) || is_of_cable()
    });
    found.retain(|guess| guess.key != guess.column || !is_one(guess.factor));
    draft.columns = found;
}

/// Returns the columns that may be signals, and the places of those that are none. `positions` are of a pose.
fn candidates(table: &Table<'_>, positions: &[usize]) -> (Vec<Candidate>, Vec<usize>) {
    let (mut candidates, mut unknown) = (Vec::new(), Vec::new());
    let are_labels = has_labels(table);
    for (place, name) in table.names.iter().enumerate() {
        let is_of_pose = POSE_COLUMNS.contains(&name.as_str()) || positions.contains(&place);
        if is_of_pose || WRENCH_COLUMNS.contains(&name.as_str()) {
            continue;
        }
        let unit = table.unit(place);
        let Some((key, factor)) = signal(name, unit) else {
            // A separator at the end of the lines makes a column without a name.
            if !name.is_empty() {
                unknown.push(place);
            }
            continue;
        };
        let key = match label(name).filter(|_| are_labels) {
            Some(label) => key.replacen("cable1.", &format!("{label}."), 1),
            None => key,
        };
        // A date says by itself what it is.
        let is_date = key == TIME_COLUMN && table.has_dates(place);
        let factor = if is_date { 1.0 } else { factor };
        let states_unit = is_date || Head::of(name).unit.is_some() || stated_unit(unit).is_some();
        candidates.push(Candidate { place, guess: ColumnGuess { key, column: name.clone(), factor, states_unit } });
    }
    (candidates, unknown)
}

/// Adds the cables of the signals found, and notes what they lack.
fn add_cables(found: &[ColumnGuess], draft: &mut Draft) {
    let cables_with = |end: &str| -> Vec<String> {
        found.iter().filter_map(|guess| guess.key.strip_suffix(end)).map(ToOwned::to_owned).collect()
    };
    let (forces, lengths) = (cables_with(FORCE), cables_with(LENGTH));
    for cable in forces.iter().chain(&lengths) {
        if !draft.cables.contains(cable) {
            draft.cables.push(cable.clone());
        }
    }
    if draft.cables.is_empty() {
        draft.notes.push("cables: no column looks like a force or a length; one cable stands for all".to_owned());
        draft.cables.push("cable1".to_owned());
    }
    if !found.iter().any(|guess| guess.key == TIME_COLUMN) {
        draft.notes.push(format!("{TIME_COLUMN}: no column looks like the time; name it under [log.columns]"));
    }
    for cable in &draft.cables {
        for (of, cables) in [(FORCE, &forces), (LENGTH, &lengths)] {
            if !cables.contains(cable) {
                draft.notes.push(format!("{cable}{of}: no column looks like it; name it under [log.columns]"));
                draft.missing.push(format!("{cable}{of}"));
            }
        }
    }
    let is_second = |cable: &&String| forces.contains(cable) && !lengths.contains(cable) && !lengths.is_empty();
    if let Some(second) = draft.cables.iter().find(is_second) {
        draft.notes.push(format!(
            "{second}.force_n: if this is the force at the far end of another cable, name its column there as NAME.reference_n, \
             and remove this cable"
        ));
    }
}

/// Offers torques and currents for the forces that are missing, those that are measured first.
fn offer_drives(table: &Table<'_>, unknown: &[usize], draft: &mut Draft) {
    let is_any = |words: &[String], of: &[&str]| words.iter().any(|word| of.contains(&word.as_str()));
    let mut drives: Vec<(&String, Vec<String>)> = unknown
        .iter()
        .filter(|place| !table.never_changes(**place))
        .filter_map(|place| table.names.get(*place))
        .map(|name| (name, words_of(name)))
        .filter(|(_, words)| is_any(words, &TORQUE_WORDS) || is_any(words, &CURRENT_WORDS))
        .filter(|(_, words)| !is_command(words))
        .collect();
    // A torque is nearer to the force than the current that makes it.
    drives.sort_by_key(|(_, words)| (!is_any(words, &MEASURED_WORDS), is_any(words, &CURRENT_WORDS)));
    for (name, words) in drives {
        let key = format!("{}{FORCE}", numbered_cable(&words));
        if draft.missing.contains(&key) && !draft.offers.iter().any(|offer| offer.guess.key == key) {
            let guess = ColumnGuess { key, column: name.clone(), factor: 1.0, states_unit: true };
            draft.offers.push(Offer {
                guess,
                condition: "with a `factor` to newtons: of a torque 1 over the radius of the drum in m",
            });
        }
    }
}

/// Returns the columns of a pose with other names, and the places of all that belong to it.
fn pose(table: &Table<'_>, draft: &mut Draft) -> (Vec<ColumnGuess>, Vec<usize>) {
    let mut found: Vec<(usize, ColumnGuess)> = Vec::new();
    for (place, name) in table.names.iter().enumerate() {
        let unit = table.unit(place);
        if let Some((key, factor)) = of_pose(name, unit)
            && !found.iter().any(|(_, guess)| guess.key == key)
        {
            let states_unit = Head::of(name).unit.is_some() || stated_unit(unit).is_some();
            found.push((place, ColumnGuess { key, column: name.clone(), factor, states_unit }));
        }
    }
    let has = |key: &&str| found.iter().any(|(_, guess)| guess.key == **key);
    if !POSE_COLUMNS[..3].iter().all(&has) {
        // One axis is the way of a bench.
        return (Vec::new(), Vec::new());
    }
    let places = found.iter().map(|(place, _)| *place).collect();
    if POSE_COLUMNS.iter().all(&has) {
        return (found.into_iter().map(|(_, guess)| guess).collect(), places);
    }
    let names: Vec<&str> = found.iter().map(|(_, guess)| guess.column.as_str()).collect();
    draft
        .notes
        .push(format!("pose: {} look like a position; a pose needs a quaternion too, qx to qw", names.join(", ")));
    (Vec::new(), places)
}

/// Returns the key of a column of a pose, and the factor to its unit.
fn of_pose(name: &str, unit: &str) -> Option<(String, f64)> {
    let (words, unit) = (words_of(name), Head::of(name).unit.or(stated_unit(unit)));
    let (last, beside) = words.split_last()?;
    let (is_turn, axis) = match last.as_bytes() {
        [axis @ (b'x'..=b'z' | b'w')] => (beside.iter().any(|word| ORIENTATION_WORDS.contains(&word.as_str())), *axis),
        [b'q', axis @ (b'x'..=b'z' | b'w')] => (true, *axis),
        [b'p', axis @ b'x'..=b'z'] => (false, *axis),
        _ => return None,
    };
    let is_plain =
        |word: &String| POSE_WORDS.contains(&word.as_str()) || is_turn && ORIENTATION_WORDS.contains(&word.as_str());
    let place = [b'x', b'y', b'z', b'w'].iter().position(|one| *one == axis)?;
    let place = if is_turn { place + 3 } else { place };
    let factor = match unit {
        None => 1.0,
        Some(unit) => match Unit::of(unit) {
            Some(Unit::Of(Quantity::Length, factor)) if !is_turn => factor,
            _ => Some(1.0).filter(|_| is_turn && stated_unit(unit).is_none())?,
        },
    };
    let key = POSE_COLUMNS.get(place).filter(|_| (is_turn || axis != b'w') && beside.iter().all(is_plain))?;
    Some(((*key).to_owned(), factor))
}

/// Whether the columns tell the cables apart by a word in place of a number: each word stands once at a force and once at a length.
fn has_labels(table: &Table<'_>) -> bool {
    let labels = |end: &str| -> Vec<Option<String>> {
        let of_kind = table.names.iter().enumerate().filter(|(place, name)| {
            signal(name, table.unit(*place)).is_some_and(|(key, _)| key == format!("cable1{end}"))
        });
        let mut labels: Vec<Option<String>> = of_kind.map(|(_, name)| label(name)).collect();
        labels.sort();
        labels
    };
    let (forces, lengths) = (labels(FORCE), labels(LENGTH));
    let are_different = forces.iter().zip(forces.iter().skip(1)).all(|(one, next)| one != next);
    forces.len() > 1 && are_different && forces.iter().all(Option::is_some) && forces == lengths
}

/// Returns the words of a column's name that say neither what it is nor its number.
fn label(name: &str) -> Option<String> {
    let words = words_of(name);
    let is_known = |word: &&String| says_quantity(word) || OTHER_WORDS.contains(&word.as_str());
    if words.iter().any(|word| word.bytes().all(|byte| byte.is_ascii_digit())) {
        return None;
    }
    let rest: Vec<&str> = words.iter().filter(|word| !is_known(word)).map(String::as_str).collect();
    (!rest.is_empty()).then(|| rest.join("_"))
}

/// Whether a word says what a column is, and not of which cable.
fn says_quantity(word: &str) -> bool {
    WORDS.iter().any(|(of, _)| *of == word) || REFERENCE_WORDS.contains(&word) || MEASURED_WORDS.contains(&word)
}

/// Returns the words by which columns of one cable are known as such.
fn telling_words(name: &str) -> Vec<String> {
    let mut words = words_of(name);
    words.retain(|word| !says_quantity(word) && !word.bytes().all(|byte| byte.is_ascii_digit()));
    words
}

fn is_command(words: &[String]) -> bool {
    words.iter().any(|word| COMMAND_WORDS.contains(&word.as_str()) || word.starts_with(COMMAND_BEGINNING))
}

/// Returns the cable of a column by the last number among its words.
fn numbered_cable(words: &[String]) -> String {
    let number = words.iter().rev().find(|word| word.bytes().all(|byte| byte.is_ascii_digit()));
    format!("cable{}", number.map_or("1", String::as_str))
}

/// Returns the probable signal of a column, and the factor to its unit, which the name or the line of units states. One with a unit of something else is
/// none.
fn signal(name: &str, unit: &str) -> Option<(String, f64)> {
    if name == TIME_COLUMN {
        return Some((name.to_owned(), 1.0));
    }
    if let Some((cable, quantity)) = name.rsplit_once('.')
        && ["force_n", "length_m", "speed_m_per_s", "reference_n"].contains(&quantity)
        && !cable.is_empty()
    {
        // The name has a unit of its own, which the line of units may contradict.
        let factor = match stated_unit(unit).and_then(Unit::of) {
            Some(Unit::Of(_, factor)) => factor,
            _ => 1.0,
        };
        return Some((name.to_owned(), factor));
    }
    let words = words_of(name);
    if is_command(&words) || words.iter().any(|word| GEOGRAPHIC_WORDS.contains(&word.as_str())) {
        return None;
    }
    let by_word = words.iter().find_map(|word| WORDS.iter().find(|(of, _)| of == word)).map(|(_, quantity)| *quantity);
    let by_unit = Head::of(name).unit.or(stated_unit(unit)).and_then(Unit::of);
    let (quantity, factor) = match by_unit {
        Some(Unit::Other) => return None,
        // `v_ms` is in metres per second.
        Some(Unit::Of(Quantity::Time, _)) if by_word == Some(Quantity::Speed) => (Quantity::Speed, 1.0),
        // The symbol of time, as in `Zeit [t]`, is no tonne.
        Some(Unit::Of(quantity, factor)) if (quantity, by_word) != (Quantity::Force, Some(Quantity::Time)) => {
            (quantity, factor)
        }
        _ => (by_word?, 1.0),
    };
    let cable = numbered_cable(&words);
    let is_reference = words.iter().any(|word| REFERENCE_WORDS.contains(&word.as_str()));
    let key = match quantity {
        Quantity::Time => TIME_COLUMN.to_owned(),
        Quantity::Force if is_reference => format!("{cable}{REFERENCE}"),
        Quantity::Force => format!("{cable}{FORCE}"),
        Quantity::Length => format!("{cable}{LENGTH}"),
        Quantity::Speed => format!("{cable}.speed_m_per_s"),
    };
    Some((key, factor))
}

/// Returns what stands in place of a unit of a column and is not known as one; `None` if it is a word or a number, as in `Force (filtered) [1]`.
fn unknown_unit<'a>(name: &'a str, unit: &'a str) -> Option<&'a str> {
    let unit = Head::of(name).unit.or(stated_unit(unit)).filter(|unit| Unit::of(unit).is_none())?;
    let is_plain = |word: &String| {
        says_quantity(word) || OTHER_WORDS.contains(&word.as_str()) || word.bytes().all(|byte| byte.is_ascii_digit())
    };
    Some(unit).filter(|unit| !split_words(unit).iter().all(is_plain))
}

/// Returns the words of a column's name without its unit, numbers separate.
fn words_of(name: &str) -> Vec<String> {
    split_words(Head::of(name).name)
}

/// Returns the words of a text in lower case, numbers separate.
fn split_words(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut last = None;
    for character in text.to_lowercase().chars() {
        let class = (character.is_alphabetic(), character.is_ascii_digit());
        if class != (false, false) {
            match found.last_mut().filter(|_| last == Some(class)) {
                Some(word) => word.push(character),
                None => found.push(character.to_string()),
            }
        }
        last = Some(class);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_known_by_unit_and_name() {
        for (name, key, factor) in [
            ("time_s", "time_s", 1.0),
            ("Zeit [ms]", "time_s", 1e-3),
            ("Load cell 3 [kg]", "cable3.force_n", 9.80665),
            ("motor_force_n", "cable1.force_n", 1.0),
            ("position_m", "cable1.length_m", 1.0),
            ("wound 2 (mm)", "cable2.length_m", 1e-3),
            ("speed_2_mm_per_s", "cable2.speed_m_per_s", 1e-3),
            ("speed_m_s", "cable1.speed_m_per_s", 1.0),
            ("v_ms", "cable1.speed_m_per_s", 1.0),
            ("F4", "cable4.force_n", 1.0),
            ("platform force 4 [N]", "cable4.reference_n", 1.0),
            ("winch.length_m", "winch.length_m", 1.0),
            ("Force (filtered) 1", "cable1.force_n", 1.0),
            ("Kraft des Seils 2 [N]", "cable2.force_n", 1.0),
            ("Zeit [hh:mm:ss]", "time_s", 1.0),
            ("Zeit [t]", "time_s", 1.0),
            ("ms", "time_s", 1e-3),
            ("Last [MN]", "cable1.force_n", 1e6),
            ("F [mN]", "cable1.force_n", 1e-3),
            ("Seilkraft [daN]", "cable1.force_n", 10.0),
            ("Kran [t]", "cable1.force_n", 9806.65),
            ("F_Winde/kN", "cable1.force_n", 1e3),
            ("l/mm", "cable1.length_m", 1e-3),
            ("v/(mm/s)", "cable1.speed_m_per_s", 1e-3),
        ] {
            assert_eq!(signal(name, ""), Some((key.to_owned(), factor)), "{name}");
        }
        let others = ["note", "temperature [°C]", "Position [rev]", "load torque [Nm]", "F_soll", "target speed [m/s]"];
        for name in others.into_iter().chain(["ground_pos_latitude", "M/Nm"]) {
            assert_eq!(signal(name, ""), None, "{name}");
        }
    }

    fn drafted(names: &[&str]) -> Draft {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let mut draft = Draft::new("log".to_owned());
        guess(&Table { names: &names, units: &[], dated: &[], unchanging: &[] }, &mut draft);
        draft
    }

    /// Whether a signal was found in a column, with this factor.
    fn has(draft: &Draft, key: &str, column: &str, factor: f64) -> bool {
        draft
            .columns
            .iter()
            .any(|guess| (guess.key.as_str(), guess.column.as_str()) == (key, column) && is_one(guess.factor / factor))
    }

    #[test]
    fn cables_are_named_by_words_where_these_pair_up() {
        let draft =
            drafted(&["Zeit [s]", "Kraft links [N]", "Kraft rechts [N]", "Weg links [mm]", "Weg rechts [mm]", "Fref1"]);
        assert_eq!(draft.cables, ["links", "rechts"]);
        assert!(has(&draft, "rechts.length_m", "Weg rechts [mm]", 1e-3), "{draft:?}");
        assert_eq!(drafted(&["t", "F_FL", "F_FR", "F_RL", "L_FL", "L_FR", "L_RL"]).cables, ["fl", "fr", "rl"]);
        // Words that only one of the signals has are no cables.
        assert_eq!(drafted(&["time_s", "motor_force_n", "position_m"]).cables, ["cable1"]);
        assert_eq!(signal("Fref1", ""), Some(("cable1.reference_n".to_owned(), 1.0)));
    }

    #[test]
    fn poses_are_found_whatever_their_prefix() {
        for position in [
            ["x [mm]", "y [mm]", "z [mm]"],
            ["pose_x_mm", "pose_y_mm", "pose_z_mm"],
            ["Platform X (mm)", "Platform Y (mm)", "Platform Z (mm)"],
        ] {
            let draft = drafted(&[&["time_s", "F1", "L1"], &position[..], &["qx", "qy", "qz", "qw"]].concat());
            assert!(draft.has_pose && draft.cables == ["cable1"], "{draft:?}");
            assert!(has(&draft, "pose.z_m", position[2], 1e-3) && has(&draft, "pose.qw", "qw", 1.0), "{draft:?}");
        }
        let draft = drafted(&["time_s", "F1", "L1", "x [m]", "y [m]", "z [m]", "roll", "pitch"]);
        assert!(!draft.has_pose && !draft.columns.iter().any(|guess| guess.column == "x [m]"), "{draft:?}");
        assert!(draft.notes.iter().any(|note| note.contains("needs a quaternion")), "{draft:?}");
        // One axis is the way of a bench.
        assert!(has(&drafted(&["time_s", "F", "x [m]"]), "cable1.length_m", "x [m]", 1.0));
    }

    #[test]
    fn a_unit_that_is_not_known_is_told() {
        let told = |name: &str| {
            drafted(&["t", name]).notes.iter().any(|note| note.contains("is not known; state its `factor`"))
        };
        assert!(told("Kraft [xy]") && told("F (Skt)"));
        assert!(["Kraft [kN]", "Force (filtered)", "F [1]", "Kraft"].iter().all(|name| !told(name)));
    }

    /// The speed of the wind is none of the winch.
    #[test]
    fn of_several_columns_that_is_taken_which_shares_words_with_the_force() {
        let names =
            ["time", "ground_wind_velocity", "kite_pos", "ground_tether_speed", "ground_tether_force", "tether_pos"];
        let draft = drafted(&names);
        assert!(has(&draft, "cable1.speed_m_per_s", "ground_tether_speed", 1.0), "{draft:?}");
        assert!(has(&draft, "cable1.length_m", "tether_pos", 1.0), "{draft:?}");
    }

    #[test]
    fn a_second_force_and_a_torque_are_offered() {
        let offered = |names: &[&str]| -> Vec<(String, String)> {
            drafted(names).offers.into_iter().map(|offer| (offer.guess.key, offer.guess.column)).collect()
        };
        let pair = |key: &str, column: &str| vec![(key.to_owned(), column.to_owned())];
        let forces = ["t [s]", "F Winde [kN]", "F Haken [kN]", "l [mm]"];
        assert_eq!(offered(&forces), pair("cable1.reference_n", "F Haken [kN]"));
        assert_eq!(offered(&["t [s]", "F Winde [kN]", "Fref [kN]", "l [mm]"]), []);
        let drive = ["time", "joint_pos", "tau_rigid", "tau_measured", "current"];
        assert_eq!(offered(&drive), pair("cable1.force_n", "tau_measured"));
        assert_eq!(offered(&["time", "joint_pos", "current", "torque"]), pair("cable1.force_n", "torque"));
        assert_eq!(offered(&["time", "joint_pos", "effort", "torque"]), []);
    }

    #[test]
    fn a_line_of_units_counts_where_the_name_has_none() {
        assert_eq!(signal("Kraft", "kN"), Some(("cable1.force_n".to_owned(), 1e3)));
        assert_eq!(signal("Weg 2", "[mm]"), Some(("cable2.length_m".to_owned(), 1e-3)));
        assert_eq!(signal("Weg 2 [m]", "mm"), Some(("cable2.length_m".to_owned(), 1.0)));
        assert_eq!(signal("Weg", ""), Some(("cable1.length_m".to_owned(), 1.0)));
        assert_eq!(signal("Position", "rev"), None);
        assert_eq!(signal("winch.length_m", "mm"), Some(("winch.length_m".to_owned(), 1e-3)));
    }
}
