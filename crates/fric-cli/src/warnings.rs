//! What is worth knowing about a log that was read, on stderr.

use std::io::Write as _;

use fric_core::effects;
use fric_core::robot::file::{EffectTable, RobotFile};
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

/// A cable signal at another pace than the robot file says.
pub fn about_cycle(reader: &SignalReader, robot: &RobotFile) {
    let interval_s = reader.counts(Role::Cable).interval_nanos * 1e-9;
    let cycle_s = robot.options().cycle_s;
    if interval_s > 0.0 && !(0.8..=1.25).contains(&(interval_s / cycle_s)) {
        warn(&format!(
            "the cable signal comes every {interval_s:.6} s, but `cycle_s` in the robot file is {cycle_s}; delays and \
             the check for a frozen sensor count cycles of the robot file; friction itself does not depend on the rate"
        ));
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
