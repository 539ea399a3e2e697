//! Reads data sets of recordings labelled with slip.

use crate::league::data::{DataSet, Recording, Slip, Truth};
use crate::league::definition::SlipData;
use crate::score_slip::{Found, Label, Notes, RecordedOptions};
use feeler_console::CommandError;
use feeler_lab::grasps::ContactReference;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

/// Reads the data set in `folder`, and applies feeler's slip detectors. Adds the files to `files`.
///
/// # Errors
/// If no labelled recording can be read.
pub fn read(
    data: &SlipData,
    folder: &Path,
    files: &mut Vec<PathBuf>,
) -> Result<DataSet, CommandError> {
    let options = options(data, folder);
    let path = folder.join(&data.recordings);
    let labels = data.labels.as_ref().map(|labels| folder.join(labels));
    let mut notes = Notes::default();
    let found = Found::new(&path, labels.as_deref(), &options, &mut notes)?;
    files.extend(found.inputs().map(Path::to_owned).chain(labels.clone()));
    let mut unit = found.unit();
    let mut kept = Vec::new();
    let mut has_normal = false;
    let collected = found.collect_with(&mut notes, |name, group, recording, label| {
        if matches!(recording.untouched, ContactReference::LocatedPattern(_)) {
            unit = "px";
        }
        has_normal |= recording
            .frames
            .iter()
            .any(|frame| !frame.normal.is_empty());
        let count = recording.frames.len();
        let truth = match label {
            Label::Whole(slip) => Truth::Slip(*slip),
            Label::Frames(rows) => {
                Truth::SlipRows((0..count).map(|row| rows.get(&row).copied()).collect())
            }
        };
        let rows = recording.frames.iter().map(|frame| {
            let elements = frame.shear.iter().enumerate();
            let values = elements.flat_map(|(element, shear)| {
                let normal = frame.normal.get(element).copied();
                shear.to_array().into_iter().chain(normal)
            });
            values.collect()
        });
        let recording = Recording {
            name: name.to_owned(),
            group: 0,
            times: recording.frames.iter().map(|frame| frame.stamp).collect(),
            rows: rows.collect(),
            truth,
        };
        kept.push((group.to_owned(), recording));
    });
    let mut collected = collected?;
    collected.normalize();
    collected.score_images(None);
    let groups: BTreeSet<_> = kept.iter().map(|(group, _)| group.clone()).collect();
    let groups: Vec<_> = groups.into_iter().collect();
    let recordings = kept.into_iter().map(|(group, mut recording)| {
        recording.group = groups.binary_search(&group).unwrap_or(0);
        recording
    });
    let recordings: Vec<Recording> = recordings.collect();
    let names = recordings
        .iter()
        .enumerate()
        .map(|(index, r)| (r.name.as_str(), index));
    let by_name: HashMap<_, _> = names.collect();
    let slips = collected.scored.iter().filter_map(|scored| {
        Some(Slip {
            recording: *by_name.get(scored.recording.as_str())?,
            row: scored.frame,
            slip: scored.slip,
            scores: scored.scores.to_vec(),
        })
    });
    Ok(DataSet {
        columns: if has_normal {
            &["x", "y", "z"]
        } else {
            &["x", "y"]
        },
        unit: unit.into(),
        slips: slips.collect(),
        recordings,
        groups,
        digest: String::new(),
        notes: notes.sentences(),
    })
}

fn options(data: &SlipData, folder: &Path) -> RecordedOptions {
    let beside = |name: &String| match folder.join(name) {
        path if path.is_file() => path.to_string_lossy().into_owned(),
        _ => name.clone(),
    };
    RecordedOptions {
        taxels: data.taxels.as_ref().map(beside),
        prefixes: data.prefixes.clone(),
        sequence: data.sequence.clone(),
        tables: data.tables.clone(),
        layout: data.layout.as_ref().map(|layout| folder.join(layout)),
        rate: data.rate,
        untouched: data.untouched,
        group: data.group.clone(),
        frame_labels: data.frame_labels.clone(),
        thresholds_from: Vec::new(),
    }
}
