//! Guesses the signals of a CSV log's columns from their names and units, in English and German.

use fric_core::robot::file::{POSE_COLUMNS, TIME_COLUMN, WRENCH_COLUMNS};

use super::draft::{ColumnGuess, Draft, FORCE, LENGTH, is_one};

/// The possible content of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Time,
    Force,
    Length,
    Speed,
}

/// Units in brackets, or after the last underscore.
const UNITS: [(&str, Kind, f64); 22] = [
    ("s", Kind::Time, 1.0),
    ("sec", Kind::Time, 1.0),
    ("ms", Kind::Time, 1e-3),
    ("us", Kind::Time, 1e-6),
    ("µs", Kind::Time, 1e-6),
    ("ns", Kind::Time, 1e-9),
    ("n", Kind::Force, 1.0),
    ("kn", Kind::Force, 1e3),
    ("mn", Kind::Force, 1e-3),
    ("kg", Kind::Force, 9.80665),
    ("kgf", Kind::Force, 9.80665),
    ("g", Kind::Force, 9.80665e-3),
    ("lbf", Kind::Force, 4.448_221_615_260_5),
    ("m", Kind::Length, 1.0),
    ("cm", Kind::Length, 1e-2),
    ("mm", Kind::Length, 1e-3),
    ("µm", Kind::Length, 1e-6),
    ("um", Kind::Length, 1e-6),
    ("m/s", Kind::Speed, 1.0),
    ("mm/s", Kind::Speed, 1e-3),
    ("m_per_s", Kind::Speed, 1.0),
    ("mm_per_s", Kind::Speed, 1e-3),
];

/// Words in column names that indicate the content if no unit does.
const WORDS: [(&str, Kind); 34] = [
    ("time", Kind::Time),
    ("timestamp", Kind::Time),
    ("datetime", Kind::Time),
    ("stamp", Kind::Time),
    ("zeit", Kind::Time),
    ("uhrzeit", Kind::Time),
    ("zeitstempel", Kind::Time),
    ("t", Kind::Time),
    ("force", Kind::Force),
    ("tension", Kind::Force),
    ("load", Kind::Force),
    ("effort", Kind::Force),
    ("kraft", Kind::Force),
    ("seilkraft", Kind::Force),
    ("f", Kind::Force),
    ("fref", Kind::Force),
    ("fplat", Kind::Force),
    ("length", Kind::Length),
    ("len", Kind::Length),
    ("position", Kind::Length),
    ("pos", Kind::Length),
    ("displacement", Kind::Length),
    ("stroke", Kind::Length),
    ("encoder", Kind::Length),
    ("weg", Kind::Length),
    ("hub", Kind::Length),
    ("länge", Kind::Length),
    ("laenge", Kind::Length),
    ("l", Kind::Length),
    ("speed", Kind::Speed),
    ("velocity", Kind::Speed),
    ("geschwindigkeit", Kind::Speed),
    ("vel", Kind::Speed),
    ("v", Kind::Speed),
];
/// Words that mark a force at the platform.
const REFERENCE_WORDS: [&str; 8] =
    ["ref", "reference", "referenz", "platform", "plattform", "payload", "fref", "fplat"];
/// Words that name no cable.
const OTHER_WORDS: [&str; 20] = [
    "cable", "seil", "winch", "winde", "motor", "cell", "zelle", "sensor", "ist", "actual", "measured", "gemessen",
    "raw", "filtered", "of", "the", "des", "der", "at", "in",
];
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
/// Units of what is none of the signals.
const OTHER_UNITS: [&str; 26] = [
    "nm", "ncm", "rev", "rpm", "1/min", "u/min", "deg", "°", "rad", "deg/s", "°/s", "rad/s", "v", "mv", "mv/v", "a",
    "ma", "w", "°c", "k", "%", "hz", "bar", "pa", "counts", "inc",
];

/// Guesses the signals of columns with these names and, if the log states them apart from the names, units.
pub fn guess(names: &[String], units: &[String], draft: &mut Draft) {
    let has = |name: &str| names.iter().any(|known| known == name);
    let unit_of = |place: usize| units.get(place).map_or("", String::as_str);
    let mut unknown = Vec::new();
    let (mut found, positions) = pose(names, &unit_of, draft);
    let are_labels = has_labels(names, &unit_of);
    for (place, name) in names.iter().enumerate() {
        let is_of_pose = POSE_COLUMNS.contains(&name.as_str()) || positions.contains(&place);
        if is_of_pose || WRENCH_COLUMNS.contains(&name.as_str()) {
            continue;
        }
        let Some((key, factor)) = signal(name, unit_of(place)) else {
            unknown.push(name.clone());
            continue;
        };
        let key = match label(name).filter(|_| are_labels) {
            Some(label) => key.replacen("cable1.", &format!("{label}."), 1),
            None => key,
        };
        if found.iter().any(|guess| guess.key == key) {
            draft.notes.push(format!("{key}: column {name:?} could be meant too"));
            continue;
        }
        let states_unit = name.contains(['[', '(']) || units.get(place).is_some_and(|unit| !unit.is_empty());
        found.push(ColumnGuess { key, column: name.clone(), factor, states_unit });
    }
    let quantity = |guess: &ColumnGuess, quantity: &str| {
        guess.key.rsplit_once('.').filter(|(_, of)| *of == quantity).map(|(cable, _)| cable.to_owned())
    };
    let cables_with = |of: &str| -> Vec<String> { found.iter().filter_map(|guess| quantity(guess, of)).collect() };
    let (forces, lengths) = (cables_with("force_n"), cables_with("length_m"));
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
    if cables_with("reference_n").is_empty() {
        draft.notes.push(
            "reference: no column looks like a force at the platform; name it under [log.columns] as NAME.reference_n, or a \
             known load under [log], such as reference = { constant_n = 49.05 }"
                .to_owned(),
        );
    }
    draft.has_pose = has(POSE_COLUMNS[0]) || found.iter().any(|guess| guess.key == POSE_COLUMNS[0]);
    if !draft.has_pose && positions.is_empty() {
        draft.notes.push("pose: no columns pose.x_m to pose.qw; a bench needs none".to_owned());
    }
    if !unknown.is_empty() {
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

/// Returns the columns of a pose with other names, and the places of all that belong to it.
fn pose<'a>(names: &[String], unit_of: &dyn Fn(usize) -> &'a str, draft: &mut Draft) -> (Vec<ColumnGuess>, Vec<usize>) {
    let mut found: Vec<(usize, ColumnGuess)> = Vec::new();
    for (place, name) in names.iter().enumerate() {
        if let Some((key, factor)) = of_pose(name, unit_of(place))
            && !found.iter().any(|(_, guess)| guess.key == key)
        {
            let states_unit = name.contains(['[', '(']) || !unit_of(place).is_empty();
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
fn of_pose(name: &str, stated_unit: &str) -> Option<(String, f64)> {
    let lower = name.to_lowercase();
    let stated_unit = stated_unit.trim_matches(['[', ']', '(', ')', ' ']).to_lowercase();
    let (words, unit) = parts(&lower);
    let unit = unit.or_else(|| Some(stated_unit.as_str()).filter(|unit| !unit.is_empty()));
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
        Some(unit) if !is_turn => UNITS.iter().find(|(of, kind, _)| *of == unit && *kind == Kind::Length)?.2,
        Some(unit) => Some(1.0).filter(|_| ["1", "-", ""].contains(&unit))?,
    };
    let key = POSE_COLUMNS.get(place).filter(|_| (is_turn || axis != b'w') && beside.iter().all(is_plain))?;
    Some(((*key).to_owned(), factor))
}

/// Whether the columns tell the cables apart by a word in place of a number: each word stands once at a force and once at a length.
fn has_labels<'a>(names: &[String], unit_of: &dyn Fn(usize) -> &'a str) -> bool {
    let labels = |end: &str| -> Vec<Option<String>> {
        let of_kind = names.iter().enumerate().filter(|(place, name)| {
            signal(name, unit_of(*place)).is_some_and(|(key, _)| key == format!("cable1{end}"))
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
    let lower = name.to_lowercase();
    let (words, _) = parts(&lower);
    let is_known = |word: &&String| {
        WORDS.iter().any(|(of, _)| of == word)
            || REFERENCE_WORDS.contains(&word.as_str())
            || OTHER_WORDS.contains(&word.as_str())
    };
    if words.iter().any(|word| word.bytes().all(|byte| byte.is_ascii_digit())) {
        return None;
    }
    let rest: Vec<&str> = words.iter().filter(|word| !is_known(word)).map(String::as_str).collect();
    (!rest.is_empty()).then(|| rest.join("_"))
}

/// Returns the probable signal of a column, and the factor to its unit, which the name or the line of units states. One with a unit of something else is
/// none.
fn signal(name: &str, stated_unit: &str) -> Option<(String, f64)> {
    if name == TIME_COLUMN {
        return Some((name.to_owned(), 1.0));
    }
    let stated_unit = stated_unit.trim_matches(['[', ']', '(', ')', ' ']).to_lowercase();
    if let Some((cable, quantity)) = name.rsplit_once('.')
        && ["force_n", "length_m", "speed_m_per_s", "reference_n"].contains(&quantity)
        && !cable.is_empty()
    {
        // The name has a unit of its own, which the line of units may contradict.
        let factor = UNITS.iter().find(|(of, ..)| *of == stated_unit).map_or(1.0, |(_, _, factor)| *factor);
        return Some((name.to_owned(), factor));
    }
    let lower = name.to_lowercase();
    let (words, unit) = parts(&lower);
    let unit = unit.or_else(|| Some(stated_unit.as_str()).filter(|unit| !unit.is_empty()));
    let is_of_command = |word: &String| COMMAND_WORDS.contains(&word.as_str()) || word.starts_with(COMMAND_BEGINNING);
    if words.iter().any(is_of_command) || unit.is_some_and(|unit| OTHER_UNITS.contains(&unit)) {
        return None;
    }
    let by_word = || words.iter().find_map(|word| WORDS.iter().find(|(of, _)| of == word));
    let by_unit = unit.and_then(|unit| UNITS.iter().find(|(of, ..)| *of == unit));
    let (kind, factor) = match by_unit {
        Some((_, kind, factor)) => (*kind, *factor),
        None => (by_word()?.1, 1.0),
    };
    let number = words.iter().rev().find(|word| word.bytes().all(|byte| byte.is_ascii_digit()));
    let cable = format!("cable{}", number.map_or("1", String::as_str));
    let is_reference = words.iter().any(|word| REFERENCE_WORDS.contains(&word.as_str()));
    let key = match kind {
        Kind::Time => TIME_COLUMN.to_owned(),
        Kind::Force if is_reference => format!("{cable}.reference_n"),
        Kind::Force => format!("{cable}.force_n"),
        Kind::Length => format!("{cable}.length_m"),
        Kind::Speed => format!("{cable}.speed_m_per_s"),
    };
    Some((key, factor))
}

/// Returns the words of a name, with numbers separate, and its unit: in brackets, or after an underscore.
fn parts(name: &str) -> (Vec<String>, Option<&str>) {
    let brackets = name.find(['[', '(']).and_then(|open| {
        let inside = name.get(open + 1..)?.split([']', ')']).next()?;
        Some((name.get(..open)?, inside.trim()))
    });
    let suffix = || {
        let fits =
            |(unit, ..): &&(&'static str, Kind, f64)| name.strip_suffix(unit).is_some_and(|rest| rest.ends_with('_'));
        let (unit, ..) = UNITS.iter().filter(fits).max_by_key(|(unit, ..)| unit.len())?;
        Some((name.strip_suffix(unit)?, *unit))
    };
    let (words, unit) = match brackets.or_else(suffix) {
        Some((words, unit)) => (words, Some(unit)),
        None => (name, None),
    };
    let mut found: Vec<String> = Vec::new();
    let mut last = None;
    for character in words.chars() {
        let class = (character.is_alphabetic(), character.is_ascii_digit());
        if class != (false, false) {
            match found.last_mut().filter(|_| last == Some(class)) {
                Some(word) => word.push(character),
                None => found.push(character.to_string()),
            }
        }
        last = Some(class);
    }
    (found, unit)
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
            ("F4", "cable4.force_n", 1.0),
            ("platform force 4 [N]", "cable4.reference_n", 1.0),
            ("winch.length_m", "winch.length_m", 1.0),
            ("Force (filtered) 1", "cable1.force_n", 1.0),
            ("Kraft des Seils 2 [N]", "cable2.force_n", 1.0),
            ("Zeit [hh:mm:ss]", "time_s", 1.0),
        ] {
            assert_eq!(signal(name, ""), Some((key.to_owned(), factor)), "{name}");
        }
        for name in ["note", "temperature [°C]", "Position [rev]", "load torque [Nm]", "F_soll", "target speed [m/s]"]
        {
            assert_eq!(signal(name, ""), None, "{name}");
        }
    }

    fn drafted(names: &[&str]) -> Draft {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let mut draft = Draft::new("log".to_owned());
        guess(&names, &[], &mut draft);
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
    fn a_line_of_units_counts_where_the_name_has_none() {
        assert_eq!(signal("Kraft", "kN"), Some(("cable1.force_n".to_owned(), 1e3)));
        assert_eq!(signal("Weg 2", "[mm]"), Some(("cable2.length_m".to_owned(), 1e-3)));
        assert_eq!(signal("Weg 2 [m]", "mm"), Some(("cable2.length_m".to_owned(), 1.0)));
        assert_eq!(signal("Weg", ""), Some(("cable1.length_m".to_owned(), 1.0)));
        assert_eq!(signal("Position", "rev"), None);
        assert_eq!(signal("winch.length_m", "mm"), Some(("winch.length_m".to_owned(), 1e-3)));
    }
}
