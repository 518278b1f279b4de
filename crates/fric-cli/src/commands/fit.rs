//! `fit`: the parameters of the friction model from the log of an identification run.

use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS};
use fric_core::robot::edit::{CableEdit, EffectEdit, FrictionEdit, rewrite};
use fric_lab::fit::{
    CableFit, FitOptions, Measurements, Parameter, Progress, Reference, Termination, Weighing, WrenchFit, fit_cables,
    fit_wrench,
};
use fric_log::output::OutputFile;
use fric_log::recording::Recording;
use fric_log::signals::{Role, SignalPaths, SignalReader};

use crate::arguments::{FitArguments, ReferenceName};
use crate::failure::{Failure, Outcome};
use crate::model::{self, Model};
use crate::output::{self, JsonTarget};
use crate::progress::{self, STRIDE};
use crate::result::FitResult;
use crate::warnings::{warn, warn_all};
use crate::{identification, interrupt};

/// How often the bar moves and Ctrl-C is looked at while all cores compute.
const WATCH_INTERVAL: Duration = Duration::from_millis(20);

/// Runs the command.
pub fn run(arguments: &FitArguments) -> Outcome {
    let FitArguments { log, output, reference, parameters, huber, result } = arguments;
    let json_file = result.json.as_deref().filter(|path| !output::is_stdout(path));
    output::check_distinct(&[Some(output), json_file])?;
    let options = FitOptions {
        parameters: parameters.as_deref().map(named).transpose()?,
        weighing: if *huber { Weighing::Huber } else { Weighing::LeastSquares },
    };
    let [first, ..] = log.logs.as_slice() else { return Err(Failure::usage("no log is named")) };
    let model = Model::find(log.model.as_deref(), &Recording::open(&[first])?)?.ok_or_else(model::missing)?;
    let mut inputs = log.logs.clone();
    inputs.extend(log.model.clone());
    let json = JsonTarget::prepare(result.json.as_deref(), &inputs, result.force)?;
    let fitted_file = OutputFile::create(output, &inputs, result.force)?;

    let compared = match reference {
        ReferenceName::Forces => Reference::Forces,
        ReferenceName::Wrench => Reference::Wrench,
    };
    let measurements = read(&log.logs, &model, compared)?;
    let fits = match compared {
        Reference::Forces => Fits::Forces(by_forces(&model, &measurements, &options)?),
        Reference::Wrench => Fits::Wrench(by_wrench(&model, &measurements, &options)?),
    };
    let outcome = identification::result(&model.robot, &fits);
    warn_about(&outcome, fits.cables());
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

/// The parameters that the command line names.
fn named(names: &[String]) -> Outcome<Vec<Parameter>> {
    let parameter = |name: &String| {
        Parameter::named(name).ok_or_else(|| {
            let known: Vec<String> = Parameter::all().map(|parameter| parameter.to_string()).collect();
            Failure::usage(format!("--parameters: there is no parameter `{name}`"))
                .advise(format!("Known are {}.", known.join(", ")))
        })
    };
    names.iter().map(parameter).collect()
}

/// Reads all logs, each by itself.
fn read<'a>(logs: &[PathBuf], model: &'a Model, reference: Reference) -> Outcome<Measurements<'a>> {
    let paths = match reference {
        // What is not compared with is not even read.
        Reference::Forces => model.signal_paths()?.with(Role::Wrench, None),
        Reference::Wrench => model.signal_paths()?.with(Role::Reference, None),
    };
    let names = model.robot.cable_names();
    let mut measurements = Measurements::new(&model.robot.params(), reference);
    for log in logs {
        measurements.start_log();
        read_one(log, &paths, &names, &mut measurements)?;
    }
    Ok(measurements)
}

fn read_one(log: &PathBuf, paths: &SignalPaths, names: &[&str], measurements: &mut Measurements<'_>) -> Outcome {
    let recording = Recording::open(std::slice::from_ref(log))?;
    let bar = progress::bytes(recording.total_bytes());
    let mut reader = SignalReader::new(recording, paths.clone(), names);
    let mut count = 0_u64;
    let end = loop {
        if count.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(reader.recording().bytes_read());
        }
        count += 1;
        match reader.next_row() {
            Ok(Some(sample)) => measurements.add(&sample),
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        }
    };
    bar.finish_and_clear();
    warn_all(&reader.recording().warnings());
    end?;
    warn_all(&reader.warnings());
    Ok(())
}

fn by_forces(model: &Model, measurements: &Measurements<'_>, options: &FitOptions) -> Outcome<Vec<CableFit>> {
    let fits = watched(|progress| fit_cables(measurements, options, progress))?;
    if fits.iter().all(|fit| fit.errors.reference_n.count() == 0) {
        let topic = &model.robot.options().log.reference;
        return Err(Failure::new(format!(
            "the log has no reference forces on {topic} for any cable of the robot file"
        ))
        .advise("Name their topic as `reference` under `[log]`, or fit without them: --reference wrench."));
    }
    if fits.iter().all(|fit| fit.samples.used == 0) {
        return Err(Failure::new("no sample can be used: the cables do not move, or every sample is flagged")
            .advise("See what is in the log with `fric-cli info`; record the run of `fric-cli excite`."));
    }
    Ok(fits)
}

fn by_wrench(model: &Model, measurements: &Measurements<'_>, options: &FitOptions) -> Outcome<WrenchFit> {
    let robot = model.robot.params();
    if !robot.cables().iter().all(fric_core::CableParams::has_geometry) {
        return Err(Failure::new(format!("{}: not every cable has `base_m` and `platform_m`", model.origin))
            .advise("The wrench needs the attachment of every cable; without it fit to --reference forces."));
    }
    let fit = watched(|progress| fit_wrench(measurements, options, progress))?;
    if !fit.measured {
        let mass_kg = robot.mass_kg();
        let topic = &model.robot.options().log.wrench;
        if mass_kg <= 0.0 {
            return Err(Failure::new(format!("the log has no wrench on {topic}, and the robot file no mass"))
                .advise("Name the topic as `wrench`, or give `mass_kg` under `[platform]`."));
        }
        warn(&format!(
            "the log has no wrench on {topic}: taken from the platform's mass of {mass_kg} kg and the pose, in quiet motion only"
        ));
    }
    if fit.cables.iter().all(|fit| fit.samples.used == 0) {
        return Err(Failure::new("no sample can be used: without a pose, or flagged, or the cables do not move")
            .advise("See what is in the log with `fric-cli info`; record the run of `fric-cli excite`."));
    }
    Ok(fit)
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

/// What people have to know beside the table.
fn warn_about(outcome: &FitResult, fits: &[CableFit]) {
    for (cable, fit) in outcome.cables.iter().zip(fits) {
        match fit.termination {
            Termination::Converged => {}
            Termination::NothingToFit => warn(&format!("{}: nothing to learn from, values kept", cable.name)),
            termination => warn(&format!(
                "{}: the search ended without converging ({}); the values are the best found",
                cable.name,
                termination.name()
            )),
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
