//! `feeler run`

use super::interrupt::watch_for_interrupt;
use super::report::print_outcome;
use super::screen::Screen;
use super::sweep::one_trial;
use super::throttle::{Throttle, parse_speed};
use super::watcher::Watcher;
use super::{CommandError, Outcome, run_folder};
use feeler::control::controller::Controller;
use feeler::control::phase::Phase;
use feeler_lab::config::{Experiment, Sensing};
use feeler_lab::experiment::{Session, run_facts};
use feeler_record::{RecordOptions, Recorder, RunEnd, RunLog, RunState};
use feeler_report::make::{RECORDING, ReportOutcome, make};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// An experiment file, or the name of a built-in experiment (see `feeler list`).
    #[arg(required_unless_present = "trial")]
    experiment: Option<String>,
    /// Run one trial of a sweep again: the sweep's folder and the trial's number.
    #[arg(long, num_args = 2, value_names = ["SWEEP", "TRIAL"], conflicts_with_all = ["experiment", "seed", "sensing", "settings"])]
    trial: Option<Vec<String>>,
    /// Random seed.
    #[arg(long, value_parser = crate::trials::parse_seed)]
    seed: Option<u64>,
    /// Where forces come from: rendered camera pictures, or the feelers themselves plus noise.
    #[arg(long, value_parser = ["image", "direct"])]
    sensing: Option<String>,
    /// Set any value of the experiment, as in control.slip_threshold=2.5.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// The run's folder, which must not hold a run yet [default: runs/NAME-SENSING-seedN, or -trialN]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Record the camera pictures, too, for `feeler replay --from frames` and Foxglove: about 0.3 MB each, 60 MB
    /// for every simulated second of two fingers at 100 Hz.
    #[arg(long)]
    record_frames: bool,
    /// Simulated seconds per second, or `max` [default: max; with --top: 1]
    #[arg(long, value_name = "FACTOR", value_parser = parse_speed)]
    speed: Option<f64>,
    /// Watch the run full-screen in the terminal: flags, forces, torque, phase, programs.
    #[arg(long)]
    top: bool,
}

impl Arguments {
    /// Simulated seconds in a real second; infinite for as many as possible.
    fn speed(&self) -> f64 {
        let unasked = if self.top { 1.0 } else { f64::INFINITY };
        self.speed.unwrap_or(unasked)
    }
}

pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    if arguments.top {
        Screen::check()?;
    }
    let experiment = load(arguments)?;
    let options = record_options(arguments, &experiment)?;
    let mut session = Session::new(&experiment)?;
    let trial = arguments.trial.as_deref().and_then(|trial| trial.last());
    let folder = make_folder(arguments.out.as_deref(), &experiment, trial)?;
    let facts = session.facts(&experiment.config);
    let file = folder.join(RECORDING);
    let recorder = Recorder::create_with(file, &facts, &experiment.toml, &options)?;
    let mut log = RunLog::new(recorder, session.layouts());
    if options.pictures {
        log = log.with_pictures();
    }

    let interrupted = watch_for_interrupt()?;
    let throttle = Throttle::new(experiment.config.control.period, arguments.speed());
    let mut watcher = Watcher::new(
        arguments.top,
        &experiment,
        throttle.is_paced(),
        &interrupted,
    )?;
    let start = Instant::now();
    let ended = simulate(&mut session, &mut log, throttle, &mut watcher, &interrupted);
    let wall_time = start.elapsed().as_secs_f64();
    let was_interrupted = interrupted.load(Ordering::Relaxed);
    let end = run_end(&ended, session.control_loop().controller(), was_interrupted);
    let outcome = Outcome::from(&end);
    // However it ended: what was recorded is kept and reported before anything is said.
    let made = finish(log, wall_time, end, &folder);
    ended?;
    let made = made?;
    watcher.leave(session.control_loop());

    let sim_time = session.control_loop().state().stamp;
    let factor = sim_time / wall_time;
    writeln!(
        out,
        "{sim_time:.2} s simulated in {wall_time:.2} s, {factor:.0} x real time"
    )?;
    print_outcome(&made, out)?;
    Ok(outcome)
}

/// The experiment, or the one that a trial of a sweep is.
fn load(arguments: &Arguments) -> Result<Experiment, CommandError> {
    if let Some([folder, trial]) = arguments.trial.as_deref() {
        return one_trial(Path::new(folder), trial);
    }
    let name = arguments.experiment.as_deref().unwrap_or_default();
    Ok(Experiment::load(name, &settings(arguments))?)
}

/// What is recorded beside what always is: what forces were made of, where they were made of pictures.
fn record_options(
    arguments: &Arguments,
    experiment: &Experiment,
) -> Result<RecordOptions, CommandError> {
    let pictures = arguments.record_frames;
    match experiment.config.sensing {
        Sensing::Image => Ok(RecordOptions {
            calibrations: experiment.calibration_texts()?,
            pictures,
        }),
        Sensing::Direct if pictures => Err(
            "--record-frames: no pictures are taken with sensing = \"direct\"; expected sensing = \"image\""
                .into(),
        ),
        Sensing::Direct => Ok(RecordOptions::default()),
    }
}

/// Makes control steps until the task or the time is over, or Ctrl-C.
fn simulate(
    session: &mut Session,
    log: &mut RunLog,
    mut throttle: Throttle,
    watcher: &mut Watcher,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let failed = session.run(&mut throttle, interrupted, |control_loop, at, tick| {
        if let Err(error) = at.record(control_loop, log) {
            return ControlFlow::Break(error);
        }
        watcher.step(control_loop, at, tick);
        ControlFlow::Continue(())
    })?;
    watcher.run_ended();
    failed.map_or(Ok(()), |error| Err(error.into()))
}

/// What the command line sets, the named flags last.
fn settings(arguments: &Arguments) -> Vec<String> {
    let seed = arguments.seed.map(|seed| format!("seed={seed}"));
    let sensing = arguments.sensing.as_ref().map(|s| format!("sensing={s}"));
    let mut settings = arguments.settings.clone();
    settings.extend(seed.into_iter().chain(sensing));
    settings
}

/// How the run ended that the control loop of `controller` `ended`.
pub fn run_end(
    ended: &Result<(), CommandError>,
    controller: &Controller,
    interrupted: bool,
) -> RunEnd {
    let given_up = |reason: String| RunEnd::because(RunState::GivenUp, reason);
    if let Err(error) = ended {
        RunEnd::because(RunState::Interrupted, error.to_string())
    } else if let Some(reason) = controller.stop_reason() {
        given_up(format!("the hand was stopped: {reason}"))
    } else if controller.phase() == Phase::Done && controller.task().failed() {
        let found = controller.task().outcome().unwrap_or_default();
        given_up(format!(
            "the task ended, but not as it should have: {found}"
        ))
    } else if controller.phase() == Phase::Done {
        RunEnd::DONE
    } else if interrupted {
        RunEnd::because(
            RunState::Interrupted,
            "by Ctrl-C or by the system; the report shows the run so far",
        )
    } else {
        given_up("the task was not done when the experiment's time limit was over".into())
    }
}

/// Closes the recording in `folder` of a run that took `wall_time` (s), and makes its report.
pub fn finish(
    log: RunLog,
    wall_time: f64,
    end: RunEnd,
    folder: &Path,
) -> Result<ReportOutcome, CommandError> {
    let mut recorder = log.into_recorder();
    recorder.set_end(end);
    recorder.finish(Some(wall_time))?;
    Ok(make(folder)?)
}

/// Makes the run's folder. Without a name given, one that does not exist yet, called by the seed or the number of the
/// `trial`.
pub fn make_folder(
    out: Option<&Path>,
    experiment: &Experiment,
    trial: Option<&String>,
) -> Result<PathBuf, CommandError> {
    if let Some(out) = out {
        run_folder::named(out)?;
        return Ok(out.to_path_buf());
    }
    let facts = run_facts(&experiment.config);
    let number = trial.map_or_else(
        || format!("seed{}", facts.seed),
        |trial| format!("trial{trial}"),
    );
    let stem = format!("{}-{}-{number}", facts.experiment, facts.sensing);
    run_folder::new(Path::new("runs"), &stem)
        .map_err(|e| format!("runs/{stem}: {e}; name a folder that can be made with --out").into())
}
