//! `feeler score-slip RECORDINGS LABELS`: compares detectors with the labels of recordings.

use super::collected::{Collected, Found};
use super::notes::Notes;
use super::options::SlipScoreOptions;
use super::page::{PAGE, make_folder};
use super::said::{say, wrong};
use super::scores::{SCORES, applicable_detectors, scores_csv};
use feeler_console::{CommandError, Outcome, Outputs, print_json};
use feeler_lab::grasps::{Calibrated, Confusion, Detector, calibrate, timing, transfer};
use feeler_lab::sweep::analysis::Estimate;
use feeler_report::pages::{
    GraspDetector, GraspProbability, GraspSlipPage, GraspTransfer, Roc, grasp_slip_page,
};
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Other recordings, from which thresholds are chosen, and their name.
struct Others {
    name: String,
    collected: Collected,
}

pub fn score(options: &SlipScoreOptions, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let recorded = &options.recorded;
    let mut notes = Notes::default();
    let labels = options.labels.as_deref();
    let found = Found::new(Path::new(&options.source), labels, recorded, &mut notes)?;
    let [other_path, other_labels] = match recorded.thresholds_from.as_slice() {
        [path, labels] => [Some(path.as_path()), Some(labels.as_path())],
        _ => [None; 2],
    };
    let others = other_path.zip(other_labels);
    let others = others.map(|(path, labels)| Found::others(path, labels, recorded, &mut notes));
    let others = others.transpose()?;
    if others
        .as_ref()
        .is_some_and(|others| others.of_frames != found.of_frames)
    {
        let message = "--thresholds-from: one side labels recordings, the other frames; expected the same kind of labels for both";
        return Err(message.into());
    }
    make_folder(options)?;
    let inputs = found.inputs().chain(others.iter().flat_map(Found::inputs));
    let inputs = inputs
        .chain(labels)
        .chain(other_labels)
        .chain(recorded.layout.as_deref());
    let mut outputs = Outputs::new(options.force, inputs.map(Some));
    let (page_path, scores_path) = (options.out.join(PAGE), options.out.join(SCORES));
    // Opened first, because scoring takes a long time.
    let page_file = outputs.create(&page_path, "--out")?;
    let scores_file = outputs.create(&scores_path, "--out")?;

    let (unit, of_frames) = (found.unit(), found.of_frames);
    let told = |result: Result<Collected, CommandError>, notes: &Notes| {
        result.inspect_err(|_| notes.tell())
    };
    let collected = found.collect(&mut notes);
    let mut collected = told(collected, &notes)?;
    collected.normalize();
    let others = match (others, other_path) {
        (Some(found), Some(path)) => {
            let found = found.collect(&mut notes);
            let mut collected = told(found, &notes)?;
            collected.normalize_each();
            collected.score_images(None);
            let name = path.display().to_string();
            Some(Others { name, collected })
        }
        _ => None,
    };
    collected.score_images(others.as_ref().map(|others| &others.collected));
    let page = judge(
        &mut collected,
        others.as_ref(),
        unit,
        of_frames,
        options,
        &mut notes,
    );
    notes.tell();
    let scores = scores_csv(&collected.scored, of_frames, others.is_some());
    scores_file.finish(scores.as_bytes())?;
    page_file.finish(grasp_slip_page(&page).as_bytes())?;
    if options.json {
        let (labelled, slips, groups) = page.counts;
        let scored = json!({
            "page": page_path, "scores": scores_path, "of": page.of, "labelled": labelled, "slips": slips,
            "groups": groups, "detectors": page.detectors, "notes": page.notes,
        });
        print_json(&scored, out)?;
        return Ok(Outcome::Done);
    }
    say(&page, out)?;
    writeln!(out, "{}\n{}", page_path.display(), scores_path.display())?;
    Ok(Outcome::Done)
}

/// Scores all detectors on the collected recordings.
fn judge(
    collected: &mut Collected,
    others: Option<&Others>,
    unit: &str,
    of_frames: bool,
    options: &SlipScoreOptions,
    notes: &mut Notes,
) -> GraspSlipPage {
    let groups = collected.groups.len();
    let ends = |estimate: Option<Estimate>| estimate.map(|e| e.with_ends(groups));
    let mut detectors = Vec::new();
    for (index, detector) in applicable_detectors(&collected.scored) {
        let labelled = collected.labelled(index);
        let outcome = feeler_lab::grasps::score(&labelled);
        let transfer = others.and_then(|others| {
            let compared = is_comparable(detector, collected, &others.collected);
            compared.then(|| transfer(&others.collected.labelled(index), &labelled))?
        });
        for (number, scored) in collected.scored.iter_mut().enumerate() {
            scored.verdicts[index] = outcome.verdicts[number];
            scored.verdicts_by_others[index] =
                transfer.as_ref().and_then(|t| t.alone.verdicts[number]);
        }
        let timing = timing(&collected.alarms(index));
        let says_nothing = outcome.unknown == labelled.len();
        if says_nothing {
            notes.add(detector.key(), || {
                format!("{} gives no score for any recording", detector.name())
            });
        }
        detectors.push(GraspDetector {
            name: detector.name(),
            meaning: match of_frames {
                true => detector.meaning(unit),
                false => format!("{}: {}", detector.meaning(unit), detector.of_a_recording()),
            },
            auc: ends(outcome.auc),
            accuracy: ends(outcome.accuracy),
            threshold: (!says_nothing).then_some(outcome.threshold),
            confusion: counts(outcome.confusion),
            unknown: outcome.unknown,
            probability: calibrate(&labelled).map(probability),
            timing,
            curve: Roc {
                name: detector.name(),
                points: outcome.curve,
            },
            wrong: wrong(&collected.scored, index),
            transfer: transfer.map(|transfer| GraspTransfer {
                threshold: transfer.threshold,
                alone: ends(transfer.alone.accuracy),
                confusion: counts(transfer.alone.confusion),
                added: ends(transfer.added.accuracy),
            }),
        });
    }
    let slips = collected.scored.iter().filter(|s| s.slip).count();
    let name = Path::new(&options.source).file_name();
    let grouped_by = options.recorded.group.clone();
    GraspSlipPage {
        name: name.map_or_else(
            || options.source.clone(),
            |n| n.to_string_lossy().into_owned(),
        ),
        of: if of_frames { "frames" } else { "recordings" },
        grouped_by: grouped_by.unwrap_or_else(|| "recording".into()),
        counts: (collected.scored.len(), slips, groups),
        detectors,
        others: others.map(|others| {
            let scored = &others.collected.scored;
            let slips = scored.iter().filter(|s| s.slip).count();
            (others.name.clone(), scored.len(), slips)
        }),
        notes: notes.sentences(),
    }
}

/// Returns `true` if the detector's scores have the same unit in both.
///
/// The unit of drag is the standard deviation of the noise, that of image loss the gray level. Load is in spacings of
/// the pattern if both contain marker patterns. All other scores are in the sensor's unit, which is the same if both
/// contain the same kind of taxel array.
fn is_comparable(detector: Detector, one: &Collected, other: &Collected) -> bool {
    match detector {
        Detector::Drag | Detector::ImageLoss => true,
        _ if one.of_taxels && other.of_taxels => true,
        Detector::ContactLoss => one.in_spacings && other.in_spacings,
        _ => false,
    }
}

fn probability(calibrated: Calibrated) -> GraspProbability {
    let Calibrated {
        weights,
        error,
        bins,
    } = calibrated;
    GraspProbability {
        weights,
        error,
        bins,
    }
}

fn counts(confusion: Confusion) -> [usize; 4] {
    let Confusion {
        noticed,
        missed,
        false_alarms,
        quiet,
    } = confusion;
    [noticed, missed, false_alarms, quiet]
}
