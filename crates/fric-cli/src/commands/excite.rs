//! `excite`: the identification run, or one that was designed for a question, as set points.

use std::path::{Path, PathBuf};

use fric_core::text_file::read_within;
use fric_lab::excite::{
    Excitation, ExcitationError, ExcitationOptions, Experiment, Question, STANDARD_DURATION_S, design,
};
use fric_lab::text::wrapped;
use fric_log::output::OutputFile;
use fric_work::excite::{describe, expectations};
use fric_work::questions::{QuestionError, Request, questions};
use fric_work::report::RunSeries;
use fric_work::report::preview::{self, Purpose};
use fric_work::set_points::SetPointTable;
use fric_work::supervisor::Supervisor as _;

use crate::arguments::{DesignArguments, ExciteArguments};
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::model::Model;
use crate::output::{self, Written};
use crate::progress::{self, STRIDE};
use crate::supervision::Watch;
use crate::warnings::warn;

/// Runs the command.
pub fn run(arguments: &ExciteArguments) -> Outcome {
    output::check_distinct(&[Some(&arguments.output), arguments.preview.as_deref()])?;
    let model = Model::read(&arguments.model)?;
    let options = ExcitationOptions {
        box_m: arguments.box_m.map(|[x0, y0, z0, x1, y1, z1]| [[x0, y0, z0], [x1, y1, z1]]),
        max_speed_m_per_s: arguments.max_speed_m_per_s,
        max_acceleration_m_per_s2: arguments.max_acceleration_m_per_s2,
        min_tension_n: arguments.min_tension_n,
        max_tension_n: arguments.max_tension_n,
    };
    let mut inputs: Vec<PathBuf> = vec![arguments.model.clone()];
    inputs.extend(arguments.design.found.clone());
    let file = OutputFile::create(&arguments.output, &inputs, arguments.force)?;
    let page = arguments.preview.as_ref().map(|path| OutputFile::create(path, &inputs, arguments.force)).transpose()?;

    let (mut excitation, purpose) = match asked(&model, &arguments.design)? {
        Some((command, questions)) => {
            let duration_s = arguments.design.duration_s.unwrap_or(STANDARD_DURATION_S);
            let work = |progress: &_| design(&model.robot, &options, duration_s, &questions, progress);
            let Experiment { excitation, forecasts } =
                Watch::default().compute("designing", "steps", work)?.map_err(refused)?;
            let expectations = expectations(&model.robot.cable_names(), &forecasts);
            (excitation, Some(Purpose { expectations, command }))
        }
        None => (Excitation::new(&model.robot, &options).map_err(refused)?, None),
    };
    excitation.warning().iter().for_each(|text| warn(text));
    let mut table = SetPointTable::new(file);
    table.write_header(&model.robot.cable_names(), &excitation)?;
    let mut series = RunSeries::new(excitation.total_cycles());
    let bar = progress::cycles(excitation.total_cycles());
    let mut done_cycles = 0_u64;
    while let Some(cycle) = excitation.next_cycle()? {
        if done_cycles.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(done_cycles);
        }
        done_cycles += 1;
        table.write(&cycle)?;
        series.add(&cycle);
    }
    progress::finish(&bar);
    let mut files = vec![Written::new(table.complete()?, describe(&excitation, &series))];
    if let Some(page) = page {
        let text = preview::page(&model.robot, &excitation, &series, purpose.as_ref(), &output::provenance(&inputs));
        files.push(Written::new(page.complete_with(&text)?, "the run, drawn"));
    }
    let expectations = purpose.into_iter().flat_map(|purpose| purpose.expectations);
    let told: String = expectations.map(|line| wrapped("  ", &line)).collect();
    output::show_with("", files, &told)
}

/// Returns the questions of the run and the command that answers them, if it is to be designed.
fn asked(model: &Model, arguments: &DesignArguments) -> Outcome<Option<(&'static str, Vec<Question>)>> {
    let DesignArguments { found, separate, determine, cables, noise_n, .. } = arguments;
    let text = found.as_deref().map(read_text).transpose()?;
    let (request, flag) = match (separate, determine, &text) {
        (Some(kinds), ..) => (Request::Separate(kinds), "--separate"),
        (_, Some(names), _) => (Request::Determine(names), "--determine"),
        (_, _, Some(text)) => (Request::Found(text), "--for"),
        _ => return Ok(None),
    };
    let command = request.command();
    match questions(&model.robot, request, cables.as_deref(), *noise_n) {
        Ok(questions) => Ok(Some((command, questions))),
        Err(QuestionError::Names(problem)) => Err(Failure::usage(format!("{flag}: {problem}"))),
        Err(error) => Err(Failure::new(error)
            .in_file(found.as_deref().unwrap_or(Path::new(flag)))
            .advise("Write it with `fric-cli discover LOG --model M.toml --json found.json`, or name the question with --separate or --determine.")),
    }
}

/// Size of a result that is read, bytes; that of a discovery has some hundred kilobytes.
const MOST_FOUND_BYTES: usize = 64 << 20;

fn read_text(path: &Path) -> Outcome<String> {
    read_within(path, MOST_FOUND_BYTES).map_err(|error| {
        Failure::new(fric_log::reason(&error)).in_file(path).advise("Check the path given with --for.")
    })
}

/// Converts an error to a failure; a wrong number is a mistake on the command line, the rest concerns the robot or the run.
fn refused(error: ExcitationError) -> Failure {
    let flag = |key: &str| match key {
        "box_m" => "--box".to_owned(),
        "duration_s" => "--duration".to_owned(),
        key => format!("--{}", key.replace('_', "-")),
    };
    match error {
        ExcitationError::OptionOutOfRange { key, value, min, max } => {
            Failure::usage(format!("{} is {value:?}; allowed is {min} to {max}", flag(key)))
        }
        ExcitationError::BadBox { axis, from, to } => {
            Failure::usage(format!("--box goes from {from} to {to} m along {axis}"))
                .advise("Give the lesser corner first, and at least one edge of 1 mm.")
        }
        ExcitationError::NeedsPlatform { key, cable } => Failure::usage(format!(
            "{} needs a platform, but {cable} has no `base_m` and `platform_m` in the robot file",
            flag(key)
        ))
        .advise("Leave it out, or give every cable both."),
        error => Failure::from(error),
    }
}
