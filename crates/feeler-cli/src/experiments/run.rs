//! The `feeler run` subcommand.

use super::sweep::one_trial;
use super::throttle::{Throttle, Timing, parse_speed};
use super::watcher::Watcher;
use crate::emulated::EmulatedBus;
#[cfg(not(feature = "top"))]
use crate::no_screen::Screen;
use crate::options::{FlushArguments, SettingArguments};
use crate::view::{LiveRun, ServerArguments};
use crate::{CommandError, Outcome, emulated};
use feeler::pace::Punctuality;
use feeler_console::watch_for_interrupt;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::recorded_run::{RecordedRun, RunError, record_options, session};
use feeler_lab::experiment::{Session, run_folder};
use feeler_record::RecordOptions;
use feeler_report::run::REPORT;
use feeler_rig::print_outcome;
#[cfg(feature = "top")]
use feeler_watch::Screen;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file or name of a built-in experiment (see `feeler list`).
    #[arg(required_unless_present = "trial")]
    experiment: Option<String>,
    /// Rerun one trial of a sweep, given by the sweep's folder and the trial's number.
    #[arg(long, num_args = 2, value_names = ["SWEEP", "TRIAL"], conflicts_with_all = ["experiment", "seed", "sensing", "settings"])]
    trial: Option<Vec<String>>,
    #[command(flatten)]
    changes: SettingArguments,
    /// Output folder; must not contain a run [default: runs/NAME-SENSING-seedN, or -trialN]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Record the camera images too, for `feeler replay --from frames` and Foxglove.
    ///
    /// An image takes about 0.15 MB: 30 MB per simulated second for two fingers at 100 Hz.
    #[arg(long)]
    record_frames: bool,
    #[command(flatten)]
    flush: FlushArguments,
    /// Move the fingers with servos on an emulated bus, connected to the simulated world.
    ///
    /// Uses the servos of the experiment's [drives], or suitable defaults. Runs in real time unless --speed max is
    /// given.
    #[arg(long, value_name = "SERVOS", value_parser = ["emulated"])]
    drives: Option<String>,
    /// Simulation speed relative to real time, or `max` [default: max; with --top, --view or --drives: 1]
    #[arg(long, value_name = "FACTOR", value_parser = parse_speed)]
    speed: Option<f64>,
    /// Watch the run in the terminal, full-screen: flags, forces, torque, phase, programs.
    #[arg(long)]
    top: bool,
    /// Watch the run in the browser: hand, fingertips, forces, torque, with buttons to stop and resume.
    #[arg(long)]
    view: bool,
    #[command(flatten)]
    server: ServerArguments,
}

impl Arguments {
    /// Returns the speed relative to real time; infinite for `max`.
    fn speed(&self) -> f64 {
        let unasked = if self.top || self.view || self.drives.is_some() {
            1.0
        } else {
            f64::INFINITY
        };
        self.speed.unwrap_or(unasked)
    }
}

pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    if arguments.top {
        Screen::check()?;
    }
    if !arguments.view {
        check_unviewed(&arguments.server)?;
    }
    let experiment = load(arguments)?;
    let options = record_options(&experiment, arguments.record_frames);
    let mut options = options.map_err(|error| match error {
        RunError::NoPictures => format!("--record-frames: {error}").into(),
        error => CommandError::from(error),
    })?;
    options.flush_interval = arguments.flush.flush_interval;
    options.felt = arguments.view;
    options.efforts = arguments.drives.is_some() && experiment.config.measures_efforts();
    // Set up before creating a folder, so that an invalid experiment leaves none.
    let set_up = match arguments.drives {
        Some(_) => {
            let (session, bus) = emulated::session(&experiment, arguments.speed())?;
            (session, Some(bus))
        }
        None => (session(&experiment, &options)?, None),
    };
    // Installed before the page's address is printed: an interrupt from then on leaves a report.
    let interrupted = watch_for_interrupt()?;
    let page = arguments
        .view
        .then(|| LiveRun::open(&experiment, (&arguments.server).into(), out));
    let mut page = page.transpose()?;
    let ran = watched_run(
        arguments,
        (&experiment, set_up),
        &options,
        page.as_mut(),
        &interrupted,
        out,
    );
    if let Some(page) = page {
        page.leave(ran.as_ref().err());
    }
    ran
}

/// Runs, records and reports a session, with or without a servo bus.
fn watched_run(
    arguments: &Arguments,
    (experiment, (session, bus)): (&Experiment, (Session, Option<EmulatedBus>)),
    options: &RecordOptions,
    page: Option<&mut LiveRun>,
    interrupted: &Arc<AtomicBool>,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let trial = arguments.trial.as_deref().and_then(|trial| trial.last());
    let folder = make_folder(arguments.out.as_deref(), experiment, trial)?;
    let run = RecordedRun::of_session(session, experiment, options, &folder)?;
    let run = match bus {
        Some(_) => run.keeping_time(),
        None => run,
    };

    let (period, speed) = (experiment.config.control.period, arguments.speed());
    let mut timing = match &bus {
        Some(bus) => Timing::Kept(bus.schedule(period)?, bus.is_paced()),
        None => Timing::Held(Throttle::new(period, speed)),
    };
    let mut watcher = Watcher::new(
        arguments.top,
        experiment,
        timing.is_paced(),
        interrupted,
        page,
    )?;
    let mut punctuality = Punctuality::new()?;
    let ran = run.run(&mut timing, interrupted, |control_loop, at, tick| {
        punctuality.record(tick);
        watcher.step(control_loop, at, tick)
    });
    watcher.run_ended();
    let ran = ran.map_err(|error| with_report(error, &folder))?;
    let control_loop = ran.session.control_loop();
    watcher.leave(control_loop, &ran.end);

    let (sim_time, wall_time) = (control_loop.state().stamp, ran.wall_time);
    let factor = sim_time / wall_time;
    writeln!(
        out,
        "{sim_time:.2} s simulated in {wall_time:.2} s, {factor:.0} x real time"
    )?;
    if bus.as_ref().is_some_and(EmulatedBus::is_paced) {
        writeln!(out, "{}", punctuality.summary())?;
    }
    print_outcome(&ran.report, out)?;
    Ok(Outcome::from(&ran.end))
}

/// Appends the path of the report in `folder` to the `error` of a run, if that file exists.
fn with_report(error: RunError, folder: &Path) -> CommandError {
    let report = folder.join(REPORT);
    match report.is_file() {
        true => format!(
            "{error}; the report of the run up to this error: {}",
            report.display()
        )
        .into(),
        false => error.into(),
    }
}

/// Rejects options of the browser view without `--view`.
fn check_unviewed(server: &ServerArguments) -> Result<(), CommandError> {
    let given = [("--port", server.port != 0), ("--no-open", server.no_open)];
    match given.into_iter().find(|(_, given)| *given) {
        Some((option, _)) => Err(format!("{option} requires --view").into()),
        None => Ok(()),
    }
}

/// Loads the experiment, or that of a sweep's trial.
fn load(arguments: &Arguments) -> Result<Experiment, CommandError> {
    if let Some([folder, trial]) = arguments.trial.as_deref() {
        return one_trial(Path::new(folder), trial);
    }
    let name = arguments.experiment.as_deref().unwrap_or_default();
    Ok(Experiment::load(name, &arguments.changes.settings())?)
}

/// Creates the run's folder. Without `out`, its name is new and contains the seed or the number of the `trial`.
pub fn make_folder(
    out: Option<&Path>,
    experiment: &Experiment,
    trial: Option<&String>,
) -> Result<PathBuf, CommandError> {
    if let Some(out) = out {
        run_folder::named(out).map_err(|e| format!("--out {e}"))?;
        return Ok(out.to_path_buf());
    }
    let number = trial.map(|trial| format!("trial{trial}"));
    run_folder::new(Path::new("runs"), &experiment.config, number)
        .map_err(|e| format!("{e}; name one with --out").into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_a_run_names_its_report() {
        let folder = std::env::temp_dir().join(format!("feeler-run-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let error = || RunError::NoPictures;
        let without = with_report(error(), &folder).to_string();
        std::fs::write(folder.join(REPORT), "").expect("a report");
        let with = with_report(error(), &folder).to_string();
        std::fs::remove_dir_all(&folder).expect("the folder");
        assert_eq!(without, error().to_string());
        assert!(
            with.starts_with(&without) && with.contains(REPORT),
            "{with}"
        );
    }
}
