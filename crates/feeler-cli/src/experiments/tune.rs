//! The `feeler tune` subcommand.

use super::init::missing;
use super::trials::{jobs, parse_seed};
use crate::options::Overwrite;
use crate::{CommandError, Outcome};
use feeler_console::{Outputs, Search, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_lab::identify::{Identified, estimate, probe, probing};
use feeler_lab::tune::hand::{plausible, read_identified};
use feeler_lab::tune::outcome::{TuneOptions, tune as tuned};
use feeler_lab::tune::search::{Budget, GENERATION};
use feeler_report::pages::{TunePage, percent, tune_page};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Maximum duration of a search (s): one week.
const MAX_SECONDS: f64 = 604_800.0;

const EXAMPLES: &str = "\
docs/tuning.md explains the tuning rules. The written experiment differs from the given one only in the tuned values, each with a comment that
states its origin. A search simulates the experiment's [sim]; a report with the predicted success is written next to the output. Ctrl-C ends a
search and keeps the best settings so far.

Examples:
  feeler tune cap-closing -o tuned.toml                                             tune to the simulated hand
  feeler tune my.toml --identified identified.toml -o tuned.toml
  feeler tune my.toml --identified identified.toml --search 60 -o tuned.toml
  feeler tune my.toml --identified identified.toml --evaluations 6000 -o tuned.toml     reproducible search";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Experiment file with [task.screw], or name of a built-in experiment.
    experiment: String,
    /// Identified values of the experiment's hand, written by `feeler identify` [default: identify the simulated
    /// hand]
    #[arg(long, value_name = "FILE")]
    identified: Option<PathBuf>,
    /// Improve the settings by a search in simulation for this time (s).
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    search: Option<f64>,
    /// Limit the search to this number of simulated runs, which makes it reproducible.
    #[arg(long, value_name = "RUNS", value_parser = clap::value_parser!(u64).range(GENERATION..=1_000_000_000))]
    evaluations: Option<u64>,
    /// Rated force of a sensing element (N) [default: the force of equal elastic energy, 0.505 N at 205 N/m]
    #[arg(long, value_name = "N", value_parser = force)]
    rated_force: Option<f64>,
    /// Random seed.
    #[arg(long, default_value_t = 0, value_parser = parse_seed)]
    seed: u64,
    /// Number of runs to simulate in parallel [default: number of cores]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: Option<u64>,
    /// Tuned experiment file to write; a report is written next to it.
    #[arg(short, long, value_name = "FILE.toml")]
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
}

fn seconds(text: &str) -> Result<f64, String> {
    let number = text
        .parse()
        .ok()
        .filter(|s: &f64| *s > 0.0 && *s <= MAX_SECONDS);
    number.ok_or_else(|| format!("expected a duration above 0 s, at most {MAX_SECONDS} s"))
}

fn force(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|f: &f64| *f > 0.0 && *f <= 1e3);
    number.ok_or_else(|| "expected a force above 0 N, at most 1000 N".to_string())
}

/// Identifies the simulated hand with a probing run.
fn probed(experiment: &Experiment) -> Result<Identified, CommandError> {
    let trace = probe(&probing(experiment)?)?;
    let config = &experiment.config;
    let (identified, _) = estimate(&trace, &config.name, config.seed)?;
    plausible(&identified).map_err(|what| {
        format!(
            "{}: the values identified by probing are {what}",
            config.name
        )
    })?;
    Ok(identified)
}

pub fn tune(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let output = &arguments.output;
    let page_path = output.with_extension("html");
    if page_path == *output {
        let output = output.display();
        return Err(format!("--output {output}: expected a name that ends in .toml").into());
    }
    let experiment = Experiment::load(&arguments.experiment, &[])?;
    let file = arguments.identified.as_deref();
    let identified = match file {
        Some(file) => read_identified(file, &experiment)?,
        None => probed(&experiment)?,
    };
    let inputs = [Some(Path::new(&arguments.experiment)), file];
    let mut outputs = Outputs::new(arguments.overwrite.force, inputs);
    let calibrations = missing(output, &experiment.calibration_texts()?)?;
    let file = outputs.create(output, "--output")?;
    let page_file = outputs.create(&page_path, "--output")?;
    let stop = watch_for_interrupt()?;
    let bar = Search::new(arguments.search, arguments.evaluations);
    let mut show = |runs, score| bar.show(runs, score);
    let tuned = tuned(
        &experiment,
        &identified,
        &options(arguments),
        &stop,
        &mut show,
    )?;
    drop(bar);
    for (path, text) in &calibrations {
        outputs
            .create(path, "calibration")?
            .finish(text.as_bytes())?;
    }
    page_file.finish(tune_page(&tuned.page).as_bytes())?;
    file.finish(tuned.experiment.toml.as_bytes())?;
    print(&tuned.page, out)?;
    for path in calibrations
        .iter()
        .map(|(path, _)| path)
        .chain([output, &page_path])
    {
        writeln!(out, "{}", path.display())?;
    }
    if tuned.interrupted {
        writeln!(out, "interrupted: the best settings so far are kept")?;
        return Ok(Outcome::GivenUp);
    }
    Ok(Outcome::Done)
}

fn options(arguments: &Arguments) -> TuneOptions {
    let (time, runs) = (arguments.search, arguments.evaluations);
    let searches = time.is_some() || runs.is_some();
    TuneOptions {
        rated_force: arguments.rated_force,
        search: searches.then(|| Budget {
            time: time.map(Duration::from_secs_f64),
            runs,
        }),
        seed: arguments.seed,
        jobs: jobs(arguments.jobs),
    }
}

/// Prints the settings and the predicted success.
fn print(page: &TunePage, out: &mut dyn Write) -> std::io::Result<()> {
    for row in &page.settings {
        writeln!(
            out,
            "{} = {} {} (was {})",
            row.key, row.after, row.unit, row.before
        )?;
    }
    if let Some(predicted) = page.predicted() {
        writeln!(out, "predicted success: {}", percent(predicted))?;
    }
    Ok(())
}
