//! Reads data sets of images with measured values.

use super::targets::read_targets;
use crate::league::data::{DataSet, Recording, Truth};
use crate::league::definition::{ImageData, Reference, Target};
use crate::score_slip::in_order;
use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::forces::ElementReading;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, ReferencePicture, locate};
use feeler::sensor::track::MarkerTracker;
use feeler::sensor::wrench::moments::usable;
use feeler::sensor::wrench::recordings::recordings;
use feeler_console::CommandError;
use feeler_lab::sensor::SensorGeometry;
use feeler_sources::read_picture;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Columns of tracked markers (px).
const TRACKED: &[&str] = &["u_x", "u_y"];
/// Columns of moments: integrated gray value and centroid (px).
const MOMENTS: &[&str] = &["gray", "x", "y"];
/// Number of images that are processed as one unit of work.
const CHUNK: usize = 16;

/// Reads the data set in `folder`. Adds the files to `files`.
///
/// # Errors
/// If the table or the reference cannot be read, or no image can.
pub fn read(
    data: &ImageData,
    targets: &[Target],
    folder: &Path,
    files: &mut Vec<PathBuf>,
) -> Result<DataSet, CommandError> {
    let table = folder.join(&data.table);
    let measured = read_targets(&table, &data.column, targets, None)?;
    let path_of = |name: &String| folder.join(&data.folder).join(name);
    let paths: Vec<_> = measured.keys.iter().map(path_of).collect();
    let reference: Vec<_> = match &data.reference {
        Reference::First(count) => paths.iter().take(*count).cloned().collect(),
        Reference::Files(names) => names.iter().map(|name| folder.join(name)).collect(),
    };
    let pictures: Vec<_> = reference
        .iter()
        .map(|path| picture(path))
        .collect::<Result<_, _>>()?;
    let located = locate(
        &ReferencePicture::mean(&pictures)?,
        &LocateConfig::default(),
    )?;
    let layout = LocatedLayout::new(&located);
    let columns = if data.track { TRACKED } else { MOMENTS };

    let mut unreadable = Vec::new();
    let mut values = Vec::new();
    let chunks: Vec<_> = paths.chunks(CHUNK).collect();
    in_order(
        &chunks,
        |paths| Elements::new(&layout, data.track).map(|mut own| own.of_all(paths)),
        |_, read| -> Result<(), String> {
            values.extend(read?);
            Ok(())
        },
    )?;
    let names = measured.keys.iter().map(String::as_str);
    let (names, places) = recordings(names);
    let mut by_recording: BTreeMap<(usize, u64, usize), Vec<f64>> = BTreeMap::new();
    for (row, (place, values)) in places.into_iter().zip(values).enumerate() {
        match values {
            Ok(values) => drop(by_recording.insert((place.0, place.1, row), values)),
            Err(error) => unreadable.push(error),
        }
    }
    let mut all: Vec<_> = names.into_iter().map(empty).collect();
    for ((recording, _, row), values) in by_recording {
        let own = &mut all[recording];
        own.times.push(own.times.len() as f64);
        own.rows.push(values);
        if let Truth::Values(truth) = &mut own.truth {
            truth.push(measured.values[row].clone());
        }
    }
    all.retain(|recording| !recording.rows.is_empty());
    if all.is_empty() {
        let first = unreadable
            .first()
            .map_or("the table is empty", String::as_str);
        return Err(format!("{}: no image can be used: {first}", table.display()).into());
    }
    all.sort_by(|a, b| a.name.cmp(&b.name));
    for (group, recording) in all.iter_mut().enumerate() {
        recording.group = group;
    }
    files.extend(paths);
    files.push(table);
    Ok(DataSet {
        columns,
        unit: "px".into(),
        groups: all.iter().map(|recording| recording.name.clone()).collect(),
        recordings: all,
        slips: Vec::new(),
        digest: String::new(),
        notes: unreadable
            .into_iter()
            .map(|error| format!("skipped: {error}"))
            .collect(),
    })
}

fn empty(name: String) -> Recording {
    Recording {
        name,
        group: 0,
        times: Vec::new(),
        rows: Vec::new(),
        truth: Truth::Values(Vec::new()),
    }
}

fn picture(path: &Path) -> Result<Picture, String> {
    read_picture(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// Measures the elements of images.
enum Elements {
    Tracked(Box<MarkerTracker>),
    Moments(Box<(feeler::sensor::forces::SensingChain, Vec<ElementReading>)>),
}

impl Elements {
    fn new(layout: &LocatedLayout, track: bool) -> Result<Self, String> {
        if track {
            let tracker = MarkerTracker::new(layout).map_err(|e| e.to_string())?;
            return Ok(Self::Tracked(Box::new(tracker)));
        }
        let geometry = SensorGeometry::of_layout(layout).map_err(|e| e.to_string())?;
        let chain = geometry.sensing_chain().map_err(|e| e.to_string())?;
        let readings = vec![ElementReading::default(); chain.element_count()];
        Ok(Self::Moments(Box::new((chain, readings))))
    }

    /// Returns the values of all elements in each image, or the error of an image.
    fn of_all(&mut self, paths: &[PathBuf]) -> Vec<Result<Vec<f64>, String>> {
        let of = |path: &PathBuf| {
            let picture = picture(path)?;
            self.of(&picture)
                .map_err(|e| format!("{}: {e}", path.display()))
        };
        paths.iter().map(of).collect()
    }

    /// Returns the values of all elements in an image; NaN if a marker is lost, or an element is dark or saturated.
    fn of(&mut self, picture: &Picture) -> Result<Vec<f64>, String> {
        match self {
            Self::Tracked(tracker) => {
                let markers = tracker.match_picture(picture).map_err(|e| e.to_string())?;
                let displacement =
                    |marker: &feeler::sensor::track::TrackedMarker| match marker.confidence > 0.0 {
                        true => marker.displacement.to_array(),
                        false => [f64::NAN; 2],
                    };
                Ok(markers.iter().flat_map(displacement).collect())
            }
            Self::Moments(own) => {
                let (chain, readings) = &mut **own;
                chain.sense(picture, readings).map_err(|e| e.to_string())?;
                let moments = |reading: &ElementReading| match usable(reading) {
                    Some(moments) => {
                        let [x, y] = moments.centroid.to_array();
                        [moments.integrated_gray, x, y]
                    }
                    None => [f64::NAN; 3],
                };
                Ok(readings.iter().flat_map(moments).collect())
            }
        }
    }
}
