//! Signals recorded at other times than the cable signal, usually because their stamps come from another clock.

use std::fmt;

use super::{Role, SignalReader};

/// A signal whose messages are all before the first or all after the last time of the cable signal, so that no row contains it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimesApart {
    /// The signal.
    pub role: Role,
    message_count: u64,
    times: Times,
    cable_times: Times,
}

/// The time range of a signal's messages.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Times {
    first_nanos: i64,
    last_nanos: i64,
    /// Whether these are stamps in the messages; otherwise they are log times.
    is_stamped: bool,
}

impl TimesApart {
    /// What to do, one sentence without its full stop.
    pub const ADVICE: &str =
        "Record both at the same time and stamp them by one clock; a stamp of zero counts as the log time";

    /// Returns the reason why work that needs the signal cannot start.
    #[must_use]
    pub fn cause(&self) -> String {
        format!("no message of the {} signal is of a time of the cable signal", self.role.key())
    }
}

/// Writes both ranges and what to do.
impl fmt::Display for TimesApart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { message_count, times, cable_times, .. } = self;
        let advice = Self::ADVICE;
        write!(f, "none of its {message_count} messages is of a time of the cable signal: it is {times}, ")?;
        write!(f, "the cable signal {cable_times}. {advice}")
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let how = if self.is_stamped { "stamped" } else { "logged, without stamps," };
        #[expect(clippy::cast_precision_loss, reason = "for people")]
        let [first_s, last_s] = [self.first_nanos, self.last_nanos].map(|nanos| nanos as f64 * 1e-9);
        write!(f, "{how} {first_s:.3} … {last_s:.3} s")
    }
}

impl SignalReader {
    /// Returns the ranges if no row can contain a signal because its times do not overlap those of the cable signal; complete when all rows have been
    /// read.
    #[must_use]
    pub fn times_apart(&self, role: Role) -> Option<TimesApart> {
        let times = |role: Role| {
            let (first_nanos, last_nanos) = self.counts(role).stamps_nanos?;
            Some(Times { first_nanos, last_nanos, is_stamped: self.is_stamped(role) })
        };
        let (times, cable_times) = (times(role)?, times(Role::Cable)?);
        let is_apart = times.last_nanos < cable_times.first_nanos || times.first_nanos > cable_times.last_nanos;
        let message_count = self.counts(role).message_count;
        is_apart.then_some(TimesApart { role, message_count, times, cable_times })
    }
}
