//! `info` on the run of a manipulator: its groups of columns, and what is impossible without the others.

use std::path::Path;

use fric_lab::text::table_with_text;
use fric_log::table::NumberTable;
use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::{Run, columns};
use fric_work::report::info::{self, InfoTable, Overview};
use serde::Serialize;

use super::{Model, about};
use crate::failure::Outcome;
use crate::output::Outputs;
use crate::steps::{StepResult, step_table};
use crate::warnings::warn_all;

/// `fric-continuum-info/1`.
#[derive(Debug, Serialize)]
struct InfoResult {
    format: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    manipulator: Option<String>,
    samples: usize,
    from_s: f64,
    to_s: f64,
    groups: Vec<GroupResult>,
    steps: Vec<StepResult>,
}

#[derive(Debug, Serialize)]
struct GroupResult {
    group: &'static str,
    present: bool,
    columns: usize,
    remarks: Vec<String>,
}

/// Most disks that a file without a model is searched for.
const DISKS: usize = fric_tendon::MAX_DISKS;

/// Shows the content of a run. Without a model the number of disks is that of its columns.
pub fn run(path: &Path, model: Option<&Path>, mut outputs: Outputs) -> Outcome {
    let model = model.map(Model::read).transpose()?;
    let disk_count = model.as_ref().map(Model::disk_count);
    let read = NumberTable::read(path, &columns::of_run(disk_count.unwrap_or(DISKS)))?;
    warn_all(&read.warnings);
    let is_there = |name: &String| read.columns.iter().any(|(other, _)| other == name);
    let disk_count = disk_count.unwrap_or_else(|| {
        let last = |names: Vec<String>, per_disk: usize| {
            names.iter().rposition(is_there).map_or(0, |place| place / per_disk + 1)
        };
        last(columns::shifts(DISKS), 1).max(last(columns::markers(DISKS), 2)).max(1)
    });
    let run = Run::from_columns(&read.columns, disk_count).map_err(|error| about(path, error))?;
    let gratings = model.as_ref().map(|model| Gratings::from_file(&model.file)).transpose()?.flatten();
    let ends =
        run.samples().first().zip(run.samples().last()).map_or((0.0, 0.0), |(one, other)| (one.time_s, other.time_s));
    let outcome = InfoResult {
        format: "fric-continuum-info/1",
        manipulator: model.as_ref().map(|model| model.name().to_owned()),
        samples: run.samples().len(),
        from_s: ends.0,
        to_s: ends.1,
        groups: groups(&run, gratings.as_ref()),
        steps: steps(&run, gratings.as_ref()),
    };
    outputs.write_report(|provenance| info::page(&overview(&outcome), provenance))?;
    outputs.finish(&outcome, &describe(&outcome, path), "")
}

/// Returns the content of the page.
fn overview(result: &InfoResult) -> Overview<'_> {
    let groups = result.groups.iter().map(|group| {
        let columns = if group.present { group.columns.to_string() } else { "–".to_owned() };
        vec![group.group.to_owned(), columns, group.remarks.join(", ")]
    });
    Overview {
        model: result.manipulator.as_deref(),
        tables: vec![InfoTable {
            title: "Groups of columns",
            heads: vec!["group", "columns", "remarks"],
            rows: groups.collect(),
        }],
        steps: result.steps.iter().map(StepResult::on_page).collect(),
        ..Overview::default()
    }
}

fn groups(run: &Run, gratings: Option<&Gratings>) -> Vec<GroupResult> {
    let hidden = |is_bad: &dyn Fn(&fric_tendon_lab::RunSample) -> bool| {
        run.samples().iter().filter(|sample| is_bad(sample)).count()
    };
    let hidden_markers = hidden(&|sample| sample.marker_m.iter().flatten().any(|one| !one.is_finite()));
    let mut grating_remarks = Vec::new();
    if let Some(measured) = gratings.filter(|_| run.has_shifts()).and_then(|gratings| gratings.read(run).ok()) {
        let bridged = fric_tendon_lab::result::BridgedGrating::all(run, &measured);
        let text = |one: &fric_tendon_lab::result::BridgedGrating| {
            format!("grating {} dead in {} samples", one.grating, one.samples)
        };
        grating_remarks.extend(bridged.iter().map(text));
    }
    let marker_remarks =
        if hidden_markers > 0 { vec![format!("hidden markers in {hidden_markers} samples")] } else { Vec::new() };
    let group = |group, present: bool, columns: usize, remarks: Vec<String>| GroupResult {
        group,
        present,
        columns: if present { columns } else { 0 },
        remarks,
    };
    let count = run.disk_count();
    vec![
        group("tension at the base", run.has_tension(), 1, Vec::new()),
        group("gratings", run.has_shifts(), count, grating_remarks),
        group("grating without load", run.has_reference(), 1, Vec::new()),
        group("markers", run.has_markers(), 2 * count, marker_remarks),
    ]
}

fn steps(run: &Run, gratings: Option<&Gratings>) -> Vec<StepResult> {
    let no_tension = (!run.has_tension()).then(|| "no `tension_base_n`".to_owned());
    let no_shifts = (!run.has_shifts()).then(|| "no gratings (`shift_1_nm` …)".to_owned());
    let no_lines = gratings
        .is_none()
        .then(|| "no calibrated gratings: name a manipulator file with `[gratings]` by --model".to_owned());
    let no_markers = (!run.has_markers()).then(|| "no markers (`marker_1_x_m` …) to compare with".to_owned());
    let measured: Vec<String> = [&no_shifts, &no_lines].into_iter().flatten().cloned().collect();
    let by_tension: Vec<String> = no_tension.iter().cloned().collect();
    let friction: Vec<String> =
        measured.iter().cloned().chain(no_tension.as_ref().map(|reason| format!("{reason}: not at hole 1"))).collect();
    let thermal: Vec<String> = [
        no_shifts.clone(),
        (!run.has_reference()).then(|| "no grating without load (`shift_reference_nm`)".to_owned()),
        gratings
            .is_none_or(|gratings| gratings.wavelengths_nm().is_none())
            .then(|| "no `wavelength_nm` under `[gratings]` in the manipulator file".to_owned()),
    ]
    .into_iter()
    .flatten()
    .collect();
    let step = StepResult::new;
    vec![
        step("friction at the holes", measured.is_empty(), friction),
        step("shape: none, coulomb, history", by_tension.is_empty(), by_tension),
        step("shape: measured", measured.is_empty(), measured),
        step("errors of the shapes", run.has_markers(), no_markers.into_iter().collect()),
        step("temperature taken off", thermal.is_empty(), thermal),
    ]
}

fn describe(result: &InfoResult, path: &Path) -> String {
    let groups: Vec<_> = result
        .groups
        .iter()
        .map(|group| {
            let columns = if group.present { group.columns.to_string() } else { "–".to_owned() };
            [group.group.to_owned(), columns, group.remarks.join(", ")]
        })
        .collect();
    let manipulator = result.manipulator.as_ref().map_or_else(String::new, |name| format!(", manipulator {name}"));
    format!(
        "{}: {} samples, {} … {} s{manipulator}\n\n{}\n{}",
        path.display(),
        result.samples,
        result.from_s,
        result.to_s,
        table_with_text(&["group", "columns", ""], 1, &groups),
        step_table("the run allows", &result.steps)
    )
}
