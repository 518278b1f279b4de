//! Time intervals in words. A result counts its times through all its logs; a person looks for them in the log that they are of.

use super::interval;

/// Maximum number of intervals to list.
const MOST_INTERVALS: usize = 12;

/// The logs that the times of a result are of. By default a single one.
#[derive(Clone, Debug, Default)]
pub struct Times<'a> {
    /// Name and start of each log, s; nothing of a single one.
    logs: Vec<(&'a str, f64)>,
}

/// A time interval within one log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch<'a> {
    /// The name of the log; `None` of a single one.
    pub log: Option<&'a str>,
    /// The interval in the time of the log, s since its first sample.
    pub own_s: [f64; 2],
    /// The same in the time of the result, s.
    pub joined_s: [f64; 2],
}

impl<'a> Times<'a> {
    /// Creates those of logs with these names and starts in the time of the result, s.
    pub fn new(logs: impl Iterator<Item = (&'a str, f64)>) -> Self {
        let logs: Vec<(&str, f64)> = logs.collect();
        Self { logs: if logs.len() > 1 { logs } else { Vec::new() } }
    }

    /// Returns the parts of an interval in the logs that it reaches into.
    #[must_use]
    pub fn stretches(&self, interval_s: &[f64; 2]) -> Vec<Stretch<'a>> {
        let [from_s, to_s] = *interval_s;
        let ends_s = self.logs.iter().skip(1).map(|(_, start_s)| *start_s).chain([f64::INFINITY]);
        let of_log = |((name, start_s), end_s): (&(&'a str, f64), f64)| {
            let joined_s = [from_s.max(*start_s), to_s.min(end_s)];
            let is_in = joined_s[0] < joined_s[1] || from_s >= *start_s && to_s < end_s;
            is_in.then(|| Stretch { log: Some(name), own_s: joined_s.map(|time_s| time_s - start_s), joined_s })
        };
        if self.logs.is_empty() {
            return vec![Stretch { log: None, own_s: *interval_s, joined_s: *interval_s }];
        }
        self.logs.iter().zip(ends_s).filter_map(of_log).collect()
    }

    /// Lists intervals, each in the time of its log.
    #[must_use]
    pub fn in_words(&self, intervals_s: &[[f64; 2]]) -> String {
        let all: Vec<Stretch<'_>> = intervals_s.iter().flat_map(|interval_s| self.stretches(interval_s)).collect();
        let shown = all.get(..MOST_INTERVALS).unwrap_or(&all);
        let of_log = |stretches: &[Stretch<'_>]| {
            let own: Vec<String> = stretches.iter().map(|stretch| interval(&stretch.own_s)).collect();
            let log = stretches.first().and_then(|stretch| stretch.log);
            format!("{} s{}", own.join(", "), log.map_or_else(String::new, |name| format!(" of {name}")))
        };
        let by_log: Vec<String> = shown.chunk_by(|one, other| one.log == other.log).map(of_log).collect();
        let shown_in_words = by_log.join("; ");
        match all.len().saturating_sub(MOST_INTERVALS) {
            0 => shown_in_words,
            more => format!("{shown_in_words} and {more} more"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_their_logs() {
        let one = Times::default();
        assert_eq!(one.in_words(&[[310.0, 310.5], [311.0, 312.0]]), "310.0…310.5, 311.0…312.0 s");
        let three = Times { logs: vec![("a.csv", 0.0), ("b.csv", 120.0), ("c.csv", 300.0)] };
        assert_eq!(
            three.in_words(&[[0.5, 1.0], [119.0, 121.0], [310.0, 310.0]]),
            "0.5…1.0, 119.0…120.0 s of a.csv; 0.0…1.0 s of b.csv; 10.00 s of c.csv"
        );
        // What ends where a log begins is not of that log.
        assert_eq!(three.in_words(&[[299.0, 300.0]]), "179.0…180.0 s of b.csv");
        let joined =
            three.stretches(&[299.0, 302.0]).iter().map(|stretch| interval(&stretch.joined_s)).collect::<Vec<_>>();
        assert_eq!(joined, ["299.0…300.0", "300.0…302.0"]);
    }

    #[test]
    fn a_long_list_ends() {
        let many: Vec<[f64; 2]> = (0..15).map(|start| [f64::from(start), f64::from(start) + 0.5]).collect();
        assert!(Times::default().in_words(&many).ends_with("11.0…11.5 s and 3 more"));
    }
}
