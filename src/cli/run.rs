//! `feeler run`

use super::report::print_claims;
use super::{CommandError, Outcome};
use crate::config::Experiment;
use crate::control::phase::Phase;
use crate::experiment::Session;
use crate::experiment::log::{RunLog, run_facts};
use crate::record::Recorder;
use crate::report::make::{RECORDING, make};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// An experiment file, or the name of a built-in experiment (see `feeler list`).
    experiment: String,
    /// Drives every random quantity of the run.
    #[arg(long)]
    seed: Option<u64>,
    /// Where forces come from: rendered camera pictures, or the feelers themselves plus noise.
    #[arg(long, value_parser = ["image", "direct"])]
    sensing: Option<String>,
    /// Set any value of the experiment, as in control.slip_threshold=2.5.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// The run's folder, which must not hold a run yet [default: runs/NAME-SENSING-seedN]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &settings(arguments))?;
    let mut session = Session::new(&experiment)?;
    let folder = make_folder(arguments, &experiment)?;
    let facts = run_facts(&experiment.config);
    let recorder = Recorder::create(folder.join(RECORDING), &facts, &experiment.toml)?;
    let mut log = RunLog::new(recorder, session.layout());

    let interrupted = watch_for_interrupt()?;
    let start = Instant::now();
    let mut progress = Progress::new(&experiment);
    while !session.finished() && !interrupted.load(Ordering::Relaxed) {
        let instruments = session.step()?;
        log.write(&session, &instruments)?;
        progress.show(&session, start);
    }
    let wall_time = start.elapsed().as_secs_f64();
    progress.bar.finish_and_clear();
    log.into_recorder().finish(Some(wall_time))?;

    let sim_time = session.control_loop().state().stamp;
    println!(
        "{sim_time:.2} s simulated in {wall_time:.2} s, {:.0} x real time",
        sim_time / wall_time
    );
    print_claims(&make(&folder)?);
    Ok(outcome(&session, interrupted.load(Ordering::Relaxed)))
}

/// What the command line sets, the named flags last.
fn settings(arguments: &Arguments) -> Vec<String> {
    let seed = arguments.seed.map(|seed| format!("seed={seed}"));
    let sensing = arguments.sensing.as_ref().map(|s| format!("sensing={s}"));
    let mut settings = arguments.settings.clone();
    settings.extend(seed.into_iter().chain(sensing));
    settings
}

fn outcome(session: &Session, interrupted: bool) -> Outcome {
    let controller = session.control_loop().controller();
    if let Some(reason) = controller.stop_reason() {
        println!("the hand was stopped: {reason}");
    } else if interrupted {
        println!("interrupted: the report shows the run so far");
    } else if controller.task().phase() != Phase::Done {
        println!("the task was not done when the experiment's time limit was over");
    } else {
        return Outcome::Done;
    }
    Outcome::GivenUp
}

/// Makes the run's folder. Without a name given, one that does not exist yet.
fn make_folder(arguments: &Arguments, experiment: &Experiment) -> Result<PathBuf, CommandError> {
    let create =
        |path: &Path| std::fs::create_dir_all(path).map_err(|e| format!("{}: {e}", path.display()));
    if let Some(out) = &arguments.out {
        if out.join(RECORDING).exists() {
            let out = out.display();
            return Err(
                format!("--out {out}: there is a run already; expected a new folder").into(),
            );
        }
        create(out)?;
        return Ok(out.clone());
    }
    let facts = run_facts(&experiment.config);
    let stem = format!("{}-{}-seed{}", facts.experiment, facts.sensing, facts.seed);
    let numbered = (2..).map(|n| format!("{stem}-{n}"));
    let names = std::iter::once(stem.clone()).chain(numbered);
    for folder in names.map(|name| Path::new("runs").join(name)) {
        if !folder.exists() {
            create(&folder)?;
            return Ok(folder);
        }
    }
    unreachable!("the numbers do not end")
}

/// A flag that Ctrl-C raises, so that the recording is closed and the report made.
fn watch_for_interrupt() -> Result<Arc<AtomicBool>, ctrlc::Error> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))?;
    Ok(interrupted)
}

/// A progress bar over the run's strokes.
struct Progress {
    bar: ProgressBar,
    shown: Instant,
}

impl Progress {
    /// Redrawn this often at most.
    const INTERVAL: Duration = Duration::from_millis(50);
    const PHASES_PER_STROKE: u64 = 4;

    fn new(experiment: &Experiment) -> Self {
        let strokes = u64::from(experiment.config.task.strokes);
        let bar = ProgressBar::new(strokes * Self::PHASES_PER_STROKE);
        let style = ProgressStyle::with_template("{bar:32} {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self {
            bar,
            shown: Instant::now(),
        }
    }

    fn show(&mut self, session: &Session, start: Instant) {
        let now = Instant::now();
        if now - self.shown < Self::INTERVAL {
            return;
        }
        self.shown = now;
        let task = session.control_loop().controller().task();
        let sim_time = session.control_loop().state().stamp;
        let strokes_done = u64::from(task.stroke().saturating_sub(1));
        let phases_done = match task.phase() {
            Phase::Search => 0,
            Phase::Move => 1,
            Phase::Release => 2,
            Phase::Return => 3,
            Phase::Done | Phase::Stopped => 4,
        };
        self.bar
            .set_position(strokes_done * Self::PHASES_PER_STROKE + phases_done);
        self.bar.set_message(format!(
            "{sim_time:5.1} s simulated, stroke {} {}, {:.0} x real time",
            task.stroke(),
            task.phase(),
            sim_time / (now - start).as_secs_f64()
        ));
    }
}
