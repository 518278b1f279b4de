//! Warnings about a log that was read, one sentence each.

use fric_core::CableParams;
use fric_core::robot::file::RobotFile;

use crate::recording::{Overlap, Recording};
use crate::signals::{LengthPoses, Role, SignalReader, TrackCounts};

impl Recording {
    /// Returns warnings about unreadable, duplicate and late data, complete when all messages have been read.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings: Vec<String> = self.damage().to_string().lines().map(ToOwned::to_owned).collect();
        let start_nanos = self.log_time_range_nanos().map_or(0, |(start, _)| start);
        for Overlap { earlier, later, log_time_nanos: (from, to) } in self.overlaps() {
            #[expect(clippy::cast_precision_loss, reason = "for people")]
            let after_start_s = |nanos: u64| nanos.saturating_sub(start_nanos) as f64 * 1e-9;
            warnings.push(format!(
                "`{}` and `{}` both hold the time from {:.3} s to {:.3} s after the start, but several files are read as the \
                 parts of one split recording; name recordings of their own in runs of their own",
                earlier.display(),
                later.display(),
                after_start_s(from),
                after_start_s(to),
            ));
        }
        if self.late_count() > 0 {
            #[expect(clippy::cast_precision_loss, reason = "for people")]
            let most_s = self.most_late_nanos() as f64 * 1e-9;
            warnings.push(format!(
                "{} messages stand too far from their time in the file to be put in order, by up to {most_s:.3} s",
                self.late_count()
            ));
        }
        warnings
    }
}

impl SignalReader {
    /// Returns warnings about unusual behaviour of the signals' topics, complete when all rows have been read.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for role in Role::ALL {
            let Some(path) = self.place(role) else { continue };
            let counts = self.counts(role);
            if matches!(role, Role::Length | Role::Speed) && counts.message_count == 0 {
                warnings.push(format!(
                    "the log has nothing on `{path}`, named as `{}` under `[log]`: without it nothing is compensated",
                    role.key()
                ));
            }
            let remarks = counts.remarks();
            if !remarks.is_empty() {
                warnings.push(format!("{} signal `{path}`: {}", role.key(), remarks.join(", ")));
            }
            if let Some(problem) = self.first_problem(role) {
                let signal = role.key();
                warnings.push(format!("{signal} signal `{path}`: some messages cannot be used; the first: {problem}"));
            }
            warnings.extend(self.times_apart(role).map(|apart| format!("{} signal `{path}`: {apart}", role.key())));
        }
        let cables = self.counts(Role::Cable);
        if self.log().column_names().is_some() && cables.late_count > 0 {
            warnings
                .push("the rows are not in the order of their times: sort them, unless the clock was set back; if the files are separate \
                 recordings, name each in a command of its own".into());
        } else if self.log().column_names().is_some() && cables.clock_step_count > 0 {
            warnings.push(
                "the times start again from an earlier one, and what follows is read as a continuation: do not sort the rows, for those of both parts would \
                 be mixed; put separate recordings into files and commands of their own".into(),
            );
        }
        warnings.extend(self.length_poses().iter().flat_map(LengthPoses::warnings));
        warnings
    }

    /// Returns warnings about disagreements between the robot file and the signals, complete when all rows have been read.
    #[must_use]
    pub fn robot_warnings(&self, robot: &RobotFile) -> Vec<String> {
        let mut warnings = Vec::new();
        let has_messages = self.counts(Role::Pose).message_count > 0;
        let from_lengths = self.length_poses();
        let no_pose = match &from_lengths {
            Some(poses) => poses.posed_count == 0,
            None => !has_messages || self.times_apart(Role::Pose).is_some(),
        };
        let needs_pose = robot.params().cables().iter().any(CableParams::needs_pose);
        if no_pose && needs_pose {
            let (nothing, advice) = if has_messages || from_lengths.is_some() {
                ("no row has a", "")
            } else if self.log().column_names().is_some() {
                (
                    "the log has no",
                    "; name the pose's columns, such as `pose.x_m`, under `[log.columns]` in the robot file",
                )
            } else {
                ("the log has no", "; name the pose's topic as `pose` under `[log]` in the robot file")
            };
            warnings.push(format!(
                "{nothing} pose: the wrap of the last pulleys is taken as 90°, and there is no wrench{advice}"
            ));
        }
        warnings.extend(self.cycle_warning(robot));
        warnings
    }

    /// Returns a warning if the rate of the cable signal differs from the robot file.
    #[must_use]
    pub fn cycle_warning(&self, robot: &RobotFile) -> Option<String> {
        cycle_warning(self.counts(Role::Cable).interval_nanos, robot)
    }
}

/// Returns a warning if the usual interval of the samples, ns, differs from the cycle of the robot file.
#[must_use]
pub fn cycle_warning(interval_nanos: f64, robot: &RobotFile) -> Option<String> {
    let interval_s = interval_nanos * 1e-9;
    let cycle_s = robot.options().cycle_s;
    let ratio = interval_s / cycle_s;
    let is_near = |of: f64| (0.8..=1.25).contains(&(ratio / of));
    let thousands = [1e3, 1e6, 1e9].into_iter().any(|times| is_near(times) || is_near(1.0 / times));
    let consequence = if thousands {
        "one of the two has another unit than seconds, and with wrong times speeds and viscous friction are wrong too"
    } else {
        "delays and the check for a frozen sensor count samples, as many as `cycle_s` makes of them; friction itself does not \
         depend on the rate"
    };
    // Six decimals of a time whose unit is wrong would be zeros.
    let interval = if interval_s < 1e-5 { format!("{interval_s:.2e}") } else { format!("{interval_s:.6}") };
    (interval_s > 0.0 && !is_near(1.0)).then(|| {
        format!(
            "the cable signal comes every {interval} s, but `cycle_s` in the robot file is {cycle_s}; {consequence}"
        )
    })
}

impl TrackCounts {
    /// Describes the unusual behaviour of a topic.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let Self { duplicate_count, late_count, clock_step_count, gap_count, undecodable_count, partial_count, .. } =
            *self;
        let all = [
            (gap_count, "gap", "gaps"),
            (duplicate_count, "message with a stamp used before", "messages with a stamp used before"),
            (late_count, "late message left out", "late messages left out"),
            (clock_step_count, "clock step backwards", "clock steps backwards"),
            (undecodable_count, "unusable message", "unusable messages"),
        ];
        let said = all.into_iter().filter(|(count, ..)| *count > 0);
        let counted = said.map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }));
        let partial = (partial_count > 0).then(|| {
            format!(
                "messages name only some of the cables at {partial_count} of their stamps, and the others have no value \
                 there: put all cables into one message, or give the messages of a cycle one stamp"
            )
        });
        counted.chain(partial).collect()
    }
}
