//! `fit`: the parameters of the friction model from the log of an identification run.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS};
use fric_core::robot::edit::{CableEdit, EffectEdit, FrictionEdit, rewrite};
use fric_core::robot::unknown_name;
use fric_lab::fit::{
    CableFit, FitOptions, Measurements, Parameter, Progress, Reference, Termination, Weighing, WrenchFit, fit_cables,
    fit_wrench,
};
use fric_log::output::OutputFile;
use fric_log::recording::Recording;
use fric_log::signals::{Role, SignalReader};

use crate::arguments::{FitArguments, ReferenceName};
use crate::failure::{Failure, Outcome};
use crate::model::{self, Model};
use crate::output::{self, JsonTarget};
use crate::progress::{self, STRIDE};
use crate::readiness::{self, Holdings, Readiness};
use crate::result::{FitResult, LeftOut};
use crate::warnings::{warn, warn_all};
use crate::{identification, interrupt};

/// How often the bar moves and Ctrl-C is looked at while all cores compute.
const WATCH_INTERVAL: Duration = Duration::from_millis(20);

/// Runs the command.
pub fn run(arguments: &FitArguments) -> Outcome {
    let FitArguments { logs, model, output, reference, parameters, huber, result } = arguments;
    let json_file = result.json.as_deref().filter(|path| !output::is_stdout(path));
    output::check_distinct(&[Some(output), json_file])?;
    check_named_once(logs)?;
    let options = FitOptions {
        parameters: parameters.as_deref().map(named).transpose()?,
        weighing: if *huber { Weighing::Huber } else { Weighing::LeastSquares },
    };
    let mut inputs = logs.clone();
    inputs.extend(model.clone());
    let model = find_model(model.as_deref(), logs)?;
    let json = JsonTarget::prepare(result.json.as_deref(), &inputs, result.force)?;
    let fitted_file = OutputFile::create(output, &inputs, result.force)?;

    let (fits, readiness) = match reference {
        ReferenceName::Forces => {
            let (measurements, holdings) = read(logs, &model, Reference::Forces)?;
            let readiness = readiness::by_forces(&model, &holdings);
            readiness.check()?;
            (Fits::Forces(watched(|progress| fit_cables(&measurements, &options, progress))?), readiness)
        }
        ReferenceName::Wrench => {
            // The robot file alone can rule it out.
            readiness::geometry(&model).map_or(Ok(()), |lack| Err(Failure::from(lack)))?;
            let (measurements, holdings) = read(logs, &model, Reference::Wrench)?;
            let readiness = readiness::by_wrench(&model, &holdings);
            readiness.check()?;
            (Fits::Wrench(watched(|progress| fit_wrench(&measurements, &options, progress))?), readiness)
        }
    };
    let outcome = identification::result(&model.robot, &fits);
    check_used(&outcome)?;
    warn_about(&outcome, fits.cables(), &readiness);
    let text = rewritten(&model, fits.cables())?;
    fitted_file.finish_with(&text)?;
    json.show(&identification::describe(&outcome))?;
    json.write(&outcome)
}

/// What was fitted to what.
pub enum Fits {
    Forces(Vec<CableFit>),
    Wrench(WrenchFit),
}

impl Fits {
    pub fn cables(&self) -> &[CableFit] {
        match self {
            Self::Forces(cables) => cables,
            Self::Wrench(fit) => &fit.cables,
        }
    }
}

/// Makes sure that no sample counts twice.
fn check_named_once(logs: &[PathBuf]) -> Outcome {
    for (count, log) in logs.iter().enumerate() {
        let is_same =
            |other: &PathBuf| log.canonicalize().is_ok_and(|path| other.canonicalize().is_ok_and(|of| of == path));
        if logs.iter().take(count).any(is_same) {
            return Err(Failure::usage(format!("{} is named twice, and its samples would count twice", log.display()))
                .advise("Name each log once."));
        }
    }
    Ok(())
}

/// The parameters that the command line names.
fn named(names: &[String]) -> Outcome<Vec<Parameter>> {
    let mut parameters = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        let parameter = Parameter::named(name).ok_or_else(|| {
            let known: Vec<String> = Parameter::all().map(|parameter| parameter.to_string()).collect();
            let problem = unknown_name("parameter", name, known.iter().map(String::as_str));
            Failure::usage(format!("--parameters: {problem}"))
        })?;
        if parameters.contains(&parameter) {
            return Err(Failure::usage(format!("--parameters: `{name}` is named twice; name it once")));
        }
        parameters.push(parameter);
    }
    Ok(parameters)
}

/// The robot file named, or else the first that is attached to a log.
fn find_model(named: Option<&Path>, logs: &[PathBuf]) -> Outcome<Model> {
    for log in logs {
        if let Some(model) = Model::find(named, &Recording::open(&[log])?)? {
            return Ok(model);
        }
    }
    Err(model::missing())
}

/// Reads all logs, each by itself.
fn read<'a>(logs: &[PathBuf], model: &'a Model, reference: Reference) -> Outcome<(Measurements<'a>, Holdings)> {
    // What is not compared with is not even read.
    let (unread, compared) = match reference {
        Reference::Forces => (Role::Wrench, Role::Reference),
        Reference::Wrench => (Role::Reference, Role::Wrench),
    };
    let paths = model.signal_paths()?.with(unread, None);
    warn_all(&model.robot.warnings());
    let names = model.robot.cable_names();
    let mut measurements = Measurements::new(&model.robot.params(), reference);
    let mut all: Option<Holdings> = None;
    for log in logs {
        measurements.start_log();
        let mut reader = SignalReader::new(Recording::open(&[log])?, paths.clone(), &names);
        let holdings = read_one(&mut reader, &mut measurements, names.len())?;
        warn_all(reader.cycle_warning(&model.robot).as_slice());
        let has_compared = holdings.has_reference() || holdings.wrenched > 0;
        match &mut all {
            Some(all) => all.join(&holdings),
            None => all = Some(holdings),
        }
        if logs.len() > 1 && !has_compared {
            let (log, key) = (log.display(), compared.key());
            warn(&format!("`{log}` has nothing to compare with on the signal `{key}`"));
        }
    }
    let holdings = all.unwrap_or_else(|| Holdings::new(names.len()));
    Ok((measurements, holdings))
}

fn read_one(reader: &mut SignalReader, measurements: &mut Measurements<'_>, cable_count: usize) -> Outcome<Holdings> {
    let mut holdings = Holdings::new(cable_count);
    let bar = progress::bytes(reader.recording().total_bytes());
    let end = loop {
        if holdings.rows.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(reader.recording().bytes_read());
        }
        match reader.next_row() {
            Ok(Some(sample)) => {
                holdings.add(&sample);
                measurements.add(&sample);
            }
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        }
    };
    bar.finish_and_clear();
    warn_all(&reader.recording().warnings());
    end?;
    warn_all(&reader.warnings());
    Ok(holdings)
}

/// Runs a fit beside a bar, until it is done or Ctrl-C is pressed.
fn watched<T: Send>(fit: impl FnOnce(&Progress) -> T + Send) -> Outcome<T> {
    let progress = Progress::new();
    let bar = progress::steps();
    let fitted = thread::scope(|scope| {
        let worker = scope.spawn(|| fit(&progress));
        while !worker.is_finished() {
            if interrupt::check().is_err() {
                progress.stop();
            }
            let (done, total) = progress.steps();
            bar.set_length(total as u64);
            bar.set_position(done as u64);
            thread::sleep(WATCH_INTERVAL);
        }
        worker.join()
    });
    bar.finish_and_clear();
    interrupt::check()?;
    fitted.map_err(|_| Failure::new("the fit broke off: this is a defect of fric; please report it with the log"))
}

/// Fails where not one sample could be used.
fn check_used(outcome: &FitResult) -> Outcome {
    let Some(first) = outcome.cables.first().filter(|_| outcome.cables.iter().all(|cable| cable.samples == 0)) else {
        return Ok(());
    };
    let (cause, advice) = why_unused(&first.left_out);
    Err(Failure::new(format!("no sample can be used: {cause}")).advise(advice))
}

/// Why there is not one sample to learn from, and what to do.
fn why_unused(left_out: &LeftOut) -> (&'static str, &'static str) {
    let LeftOut { flagged, without_reference, warm_up, outliers: _ } = *left_out;
    if warm_up >= flagged.max(without_reference) {
        let cause = "the cables move too little to forget the friction stored in them when the log began";
        (cause, "Record longer strokes, best the run of `fric-cli excite`.")
    } else if flagged >= without_reference {
        ("each is flagged, or has no tension on the cable", "See the flags with `fric-cli replay`.")
    } else {
        ("none has anything to compare with while its other signals are there", "See the signals with `fric-cli info`.")
    }
}

/// What people have to know beside the table.
fn warn_about(outcome: &FitResult, fits: &[CableFit], readiness: &Readiness) {
    // Cables with the same trouble share a line.
    let mut unused: Vec<(&str, Vec<&str>)> = Vec::new();
    let told = |place: &usize| readiness.is_lacking(*place);
    for (_, cable) in outcome.cables.iter().enumerate().filter(|(place, cable)| cable.samples == 0 && !told(place)) {
        let (cause, _) = why_unused(&cable.left_out);
        match unused.iter_mut().find(|(of, _)| *of == cause) {
            Some((_, names)) => names.push(&cable.name),
            None => unused.push((cause, vec![&cable.name])),
        }
    }
    for (cause, names) in unused {
        warn(&format!("{}: no sample can be used, values kept: {cause}", names.join(", ")));
    }
    for (cable, fit) in outcome.cables.iter().zip(fits) {
        // What is left unfitted is told below the tables.
        if !matches!(fit.termination, Termination::Converged | Termination::NothingToFit) {
            warn(&format!(
                "{}: the search ended without converging ({}); the values are the best found: look at the error that \
                 is left before you use them",
                cable.name,
                fit.termination.name()
            ));
        }
    }
}

/// The robot file with the fitted values; everything else stays as it is written.
fn rewritten(model: &Model, fits: &[CableFit]) -> Outcome<String> {
    let names = model.robot.cable_names();
    let effects: Vec<EffectValues> = fits.iter().map(effects_of).collect();
    let effect_edits: Vec<Vec<EffectEdit<'_>>> = effects
        .iter()
        .map(|of_cable| {
            let set = |(kind, parameters)| EffectEdit::Set { kind, parameters };
            of_cable.iter().map(|(kind, parameters)| set((*kind, parameters.as_slice()))).collect()
        })
        .collect();
    let edits: Vec<CableEdit<'_>> = names
        .into_iter()
        .zip(fits)
        .zip(&effect_edits)
        .map(|((name, fit), effects)| {
            let fitted = |place: usize| {
                fit.fitted.iter().any(|parameter| parameter.place() == place).then_some(fit.values[place])
            };
            let friction = FrictionEdit {
                mu: fitted(MU),
                sigma_n_per_m: fitted(SIGMA).filter(|sigma_n_per_m| *sigma_n_per_m < NO_PRESLIDING_N_PER_M),
                viscous_n_s_per_m: fitted(VISCOUS),
                offset_n: fitted(OFFSET),
            };
            CableEdit { name, friction, effects }
        })
        .collect();
    Ok(rewrite(&model.text, &model.origin, &edits)?)
}

/// Parameters of effects, by kind and key.
type EffectValues = Vec<(&'static str, Vec<(&'static str, f64)>)>;

/// Fitted parameters of each effect.
fn effects_of(fit: &CableFit) -> EffectValues {
    let mut effects = EffectValues::new();
    for parameter in &fit.fitted {
        let Some(kind) = parameter.effect() else { continue };
        let number = (parameter.row().key, fit.values[parameter.place()]);
        match effects.iter_mut().find(|(of, _)| *of == kind) {
            Some((_, numbers)) => numbers.push(number),
            None => effects.push((kind, vec![number])),
        }
    }
    effects
}
