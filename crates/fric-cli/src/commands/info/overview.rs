//! The page of `info --report`.

use fric_work::provenance::Provenance;
use fric_work::report::SignalSeries;
use fric_work::report::info::{self, InfoTable, Overview};

use super::{InfoResult, SignalResult};
use crate::steps::StepResult;

/// Returns the page of a log.
pub fn page(result: &InfoResult, cables: &[&str], series: Option<SignalSeries>, provenance: &Provenance) -> String {
    let number =
        |value: Option<f64>, digits: usize| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"));
    let milliseconds = |value: Option<f64>| number(value.map(|seconds| seconds * 1e3), 3);
    let topics = result.topics.iter().map(|topic| {
        vec![
            topic.topic.clone(),
            topic.schema.clone(),
            topic.encoding.clone(),
            topic.messages.to_string(),
            number(topic.pace.rate_hz, 1),
            milliseconds(topic.pace.jitter_s),
            milliseconds(topic.pace.longest_interval_s),
            number(Some(topic.from_s), 3),
            number(Some(topic.to_s), 3),
        ]
    });
    let signals = result.signals.iter().map(|signal| {
        let SignalResult { path, messages, gaps, remarks, .. } = signal;
        vec![signal.signal.to_owned(), path.clone(), messages.to_string(), gaps.to_string(), remarks.join(", ")]
    });
    let columns = result.columns.iter().map(super::columns::ColumnResult::cells);
    let tables = vec![
        InfoTable {
            title: "Topics",
            heads: vec![
                "topic",
                "schema",
                "encoding",
                "messages",
                "rate [Hz]",
                "jitter [ms]",
                "longest gap [ms]",
                "from [s]",
                "to [s]",
            ],
            rows: topics.collect(),
        },
        InfoTable {
            title: "Columns",
            heads: vec!["column", "signal", "factor", "offset"],
            rows: columns.map(Vec::from).collect(),
        },
        InfoTable {
            title: "Signals",
            heads: vec!["signal", "path", "messages used", "gaps", "remarks"],
            rows: signals.collect(),
        },
    ];
    let overview = Overview {
        model: result.robot.as_deref(),
        tables,
        steps: result.steps.iter().map(StepResult::on_page).collect(),
        cables: cables.to_vec(),
        series,
    };
    info::page(&overview, provenance)
}
