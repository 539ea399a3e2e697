//! `feeler score-slip [EXPERIMENT]`: compares detectors with the simulator's ground truth.

use super::super::json;
use super::super::part_file::Outputs;
use super::super::progress::Steps;
use super::{Arguments, CommandError, Outcome, PAGE, make_folder};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::slip_bench::{DETECTORS, Sample, trial};
use feeler_lab::sweep::slip_score::{operating_point, roc, tune};
use feeler_report::slip_page::{COLUMNS, SlipPage, slip_page};
use serde_json::json;
use std::io::Write;
use std::path::Path;

pub fn score(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.source, &arguments.settings)?;
    make_folder(arguments)?;
    let path = arguments.out.join(PAGE);
    let inputs = [Some(Path::new(&arguments.source))];
    // Opened first, because scoring takes a long time.
    let file = Outputs::new(arguments.overwrite, inputs).create(&path, "--out")?;
    let bar = Steps::new(2 * arguments.trials as usize);
    let run = |part: u64| -> Result<Vec<Vec<Sample>>, CommandError> {
        (0..arguments.trials)
            .map(|number| {
                // Even seeds choose thresholds, odd seeds are scored, so no trial does both.
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
        name: arguments.source.clone(),
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
    if arguments.json.json {
        let scored = json!({ "page": path, "frames": page.counts.0, "slips": page.counts.1, "detectors": page.points });
        json::print(&scored, out)?;
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
