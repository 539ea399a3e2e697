//! `feeler score-slip`

use super::part_file::{Outputs, Overwrite};
use super::progress::Steps;
use super::{CommandError, Outcome};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::slip_bench::{DETECTORS, Sample, trial};
use feeler_lab::sweep::slip_score::{operating_point, roc, tune};
use feeler_report::slip_page::{COLUMNS, SlipPage, slip_page};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Name of the page.
const PAGE: &str = "slip.html";

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// An experiment file, or the name of a built-in experiment: its fingertip of finger 0, noise and thresholds.
    #[arg(default_value = "cap-closing")]
    experiment: String,
    /// Number of trials to score; as many others choose the thresholds.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    trials: u64,
    /// Set any value of the experiment, as in sim.direct_sensing.shear_noise=0.005.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Random seed.
    #[arg(long, default_value_t = 0, value_parser = crate::trials::parse_seed)]
    seed: u64,
    /// The page's folder.
    #[arg(short, long, value_name = "DIR", default_value = "slip")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
}

pub fn score_slip(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.settings)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|e| format!("--out {}: {e}; expected a folder", arguments.out.display()))?;
    let path = arguments.out.join(PAGE);
    let inputs = [Some(Path::new(&arguments.experiment))];
    // Opened first: scoring takes its time.
    let file = Outputs::new(arguments.overwrite, inputs).create(&path, "--out")?;
    let bar = Steps::new(2 * arguments.trials as usize);
    let run = |part: u64| -> Result<Vec<Vec<Sample>>, CommandError> {
        (0..arguments.trials)
            .map(|number| {
                // Even seeds are for choosing thresholds, odd ones for scoring: no trial is both.
                let seed = arguments.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
                let samples = trial(&experiment, seed.wrapping_add(2 * number + part))?;
                bar.advance();
                Ok(samples)
            })
            .collect()
    };
    let (chosen_on, scored) = (run(0)?, run(1)?);
    drop(bar);
    let paper = experiment.config.control.slip_threshold;
    let tuned = (0..DETECTORS.len()).map(|detector| (detector, tune(&chosen_on, detector)));
    let points = [(0, paper)].into_iter().chain(tuned);
    let samples = scored.iter().flatten();
    let page = SlipPage {
        name: arguments.experiment.clone(),
        seed: arguments.seed,
        trials: arguments.trials,
        touch_force: experiment.config.control.touch_force,
        counts: (
            samples.clone().count(),
            samples.filter(|s| s.slipped).count(),
        ),
        points: points
            .map(|(detector, threshold)| operating_point(&scored, detector, threshold))
            .collect(),
        curves: (0..DETECTORS.len())
            .map(|detector| roc(&scored, detector))
            .collect(),
    };
    file.finish(slip_page(&page).as_bytes())?;
    for point in &page.points {
        writeln!(out, "{}", point.name)?;
        for (column, field) in COLUMNS.iter().zip(point.fields()) {
            writeln!(out, "  {column:<22} {field}")?;
        }
    }
    writeln!(out, "{}", path.display())?;
    Ok(Outcome::Done)
}
