//! What is worth knowing about a log that was read, on stderr.

use std::io::Write as _;

use fric_core::robot::file::{CableTable, EffectTable, RobotFile};
use fric_core::{CableStatus, effects};
use fric_lab::replay::Replay;
use fric_log::recording::{Overlap, Recording};
use fric_log::signals::{Role, SignalPaths, SignalReader, TrackCounts};

/// One line on stderr.
pub fn warn(text: &str) {
    // Nothing can be done about a stderr that is gone.
    let _ = writeln!(std::io::stderr(), "warning: {text}");
}

/// What could not be read, and what came late.
pub fn about_recording(recording: &Recording) {
    for line in recording.damage().to_string().lines() {
        warn(line);
    }
    let start_nanos = recording.log_time_range_nanos().map_or(0, |(start, _)| start);
    for Overlap { earlier, later, log_time_nanos: (from, to) } in recording.overlaps() {
        #[expect(clippy::cast_precision_loss, reason = "for people")]
        let after_start_s = |nanos: u64| nanos.saturating_sub(start_nanos) as f64 * 1e-9;
        warn(&format!(
            "`{}` and `{}` both hold the time from {:.3} s to {:.3} s after the start, but several files are read as the \
             parts of one split recording; name recordings of their own in runs of their own",
            earlier.display(),
            later.display(),
            after_start_s(from),
            after_start_s(to),
        ));
    }
    if recording.late_count() > 0 {
        #[expect(clippy::cast_precision_loss, reason = "for people")]
        let most_s = recording.most_late_nanos() as f64 * 1e-9;
        warn(&format!(
            "{} messages stand too far from their time in the file to be put in order, by up to {most_s:.3} s",
            recording.late_count()
        ));
    }
}

/// Effects of the robot file that change nothing.
pub fn about_effects(robot: &RobotFile) {
    let is_idle = |effect: &EffectTable| {
        effects::row(&effect.kind).is_some_and(|row| {
            let neutral = |key: &str| row.parameters.iter().find(|row| row.key == key).map(|row| row.neutral);
            effect.parameters.iter().all(|(key, value)| neutral(key) == Some(*value))
        })
    };
    for row in effects::CATALOGUE {
        let has_idle =
            |effects: &[EffectTable]| effects.iter().any(|effect| effect.kind == row.kind && is_idle(effect));
        let cables = robot.options().cable.iter().filter(|cable| has_idle(&cable.effects));
        let names: Vec<&str> = cables.map(|cable| cable.name.as_str()).collect();
        if !names.is_empty() {
            warn(&format!(
                "the effect `{}` of {} has only neutral values and does nothing; give it others, or take it out of the \
                 robot file",
                row.kind,
                names.join(", ")
            ));
        }
    }
}

/// What the signals' topics did.
pub fn about_signals(reader: &SignalReader, paths: &SignalPaths) {
    for role in Role::ALL {
        let Some(path) = paths.get(role) else { continue };
        let counts = reader.counts(role);
        if matches!(role, Role::Length | Role::Speed) && counts.message_count == 0 {
            warn(&format!(
                "the log has nothing on `{path}`, named as `{}` under `[log]`: without it nothing is compensated",
                role.key()
            ));
        }
        let remarks = remarks(counts);
        if !remarks.is_empty() {
            warn(&format!("{} signal `{path}`: {}", role.key(), remarks.join(", ")));
        }
        if let Some(problem) = reader.first_problem(role) {
            warn(&format!("{} signal `{path}`: some messages cannot be used; the first: {problem}", role.key()));
        }
    }
}

/// Cables that the robot file or the log says too little of, and those that the compensator flagged.
pub fn about_cables(robot: &RobotFile, replay: &Replay) {
    let tables = &robot.options().cable;
    let frictionless = |cable: &&CableTable| cable.friction.mu == 0.0 && cable.friction.viscous_n_s_per_m == 0.0;
    let names: Vec<&str> = tables.iter().filter(frictionless).map(|cable| cable.name.as_str()).collect();
    if !names.is_empty() {
        warn(&format!("the robot file gives no `friction` for {}: nothing is compensated there", names.join(", ")));
    }
    // Cables with the same trouble share a line.
    let mut flagged: Vec<(u64, u32, Vec<&str>)> = Vec::new();
    for (name, cable) in robot.cable_names().into_iter().zip(replay.cables()) {
        match flagged.iter_mut().find(|(count, flags, _)| (*count, *flags) == (cable.flagged_count, cable.flags)) {
            Some((.., names)) => names.push(name),
            None if cable.flagged_count > 0 => flagged.push((cable.flagged_count, cable.flags, vec![name])),
            None => {}
        }
    }
    let silent = CableStatus::SENSOR_NOT_FINITE | CableStatus::MOTION_NOT_FINITE;
    for (count, flags, names) in flagged {
        if count == replay.cycle_count() && CableStatus::from_bits(flags) == silent {
            warn(&format!("the log has no signal of {}; compare the names in it", names.join(", ")));
            continue;
        }
        let (names, flags) = (names.join(", "), CableStatus::from_bits(flags));
        warn(&format!("{count} of {} samples are flagged {flags}: {names}", replay.cycle_count()));
    }
}

/// What a topic did out of the ordinary, in words.
pub fn remarks(counts: &TrackCounts) -> Vec<String> {
    let TrackCounts { duplicate_count, late_count, clock_step_count, gap_count, undecodable_count, .. } = *counts;
    let all = [
        (gap_count, "gap", "gaps"),
        (duplicate_count, "message with a stamp used before", "messages with a stamp used before"),
        (late_count, "late message left out", "late messages left out"),
        (clock_step_count, "clock step backwards", "clock steps backwards"),
        (undecodable_count, "unusable message", "unusable messages"),
    ];
    let said = all.into_iter().filter(|(count, ..)| *count > 0);
    said.map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many })).collect()
}
