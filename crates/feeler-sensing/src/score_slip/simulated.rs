//! `feeler score-slip [EXPERIMENT]`: compares detectors with the simulator's ground truth.

use super::options::SlipScoreOptions;
use super::page::{PAGE, make_folder};
use feeler_console::{CommandError, Outcome, Outputs, Steps, print_json};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::slip_bench::{DETECTORS, Sample, trial};
use feeler_lab::sweep::analysis::{operating_point, roc, tune};
use feeler_report::pages::{COLUMNS, SlipPage, slip_page};
use serde_json::json;
use std::io::Write;
use std::path::Path;

pub fn score(options: &SlipScoreOptions, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&options.source, &options.settings)?;
    make_folder(options)?;
    let path = options.out.join(PAGE);
    let inputs = [Some(Path::new(&options.source))];
    // Opened first, because scoring takes a long time.
    let file = Outputs::new(options.force, inputs).create(&path, "--out")?;
    let bar = Steps::new(2 * options.trials as usize);
    let run = |part: u64| -> Result<Vec<Vec<Sample>>, CommandError> {
        (0..options.trials)
            .map(|number| {
                // Even seeds choose thresholds, odd seeds are scored, so no trial does both.
                let seed = options.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
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
        name: options.source.clone(),
        seed: options.seed,
        trials: options.trials,
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
    if options.json {
        let scored = json!({ "page": path, "frames": page.counts.0, "slips": page.counts.1, "detectors": page.points });
        print_json(&scored, out)?;
        return Ok(Outcome::Done);
    }
    for point in &page.points {
        writeln!(out, "{}", point.name)?;
        for (column, field) in COLUMNS.iter().zip(point.fields()) {
            writeln!(out, "  {column:<22} {field}")?;
        }
    }
    writeln!(out, "{}", path.display())?;
    Ok(Outcome::Done)
}
