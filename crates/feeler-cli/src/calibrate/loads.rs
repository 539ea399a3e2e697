//! Loads on disk: pictures, or recordings of what was sensed, and the CSV that says what was on the
//! elements in each.

use super::CommandError;
use crate::part_file::{Outputs, Overwrite};
use crate::progress::Steps;
use crate::sensor_geometry::SensorGeometry;
use feeler::sensor::calibration_fit::ElementRecord;
use feeler::sensor::fingertip::FingertipConfig;
use feeler::sensor::loads::{COLUMNS, LoadedPicture, RecordBuilder, read_loads};
use feeler::sensor::moments::ElementMoments;
use feeler_record::{Moments, read_moments};
use feeler_sim::calibration_bench::{CalibrationBenchConfig, take_pictures};
use feeler_sim::optics_config::OpticsConfig;
use feeler_sources::picture::read_picture;
use glam::{DVec2, DVec3};
use image::{ExtendedColorType, ImageFormat};
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Name of the file of loads in the folder that simulated loads are written to.
const LOADS: &str = "LOADS.csv";

/// A file of loads, with what was on the elements in each picture that it names.
pub struct Loads {
    csv: PathBuf,
    pictures: Vec<LoadedPicture>,
}

impl Loads {
    /// Reads the file of loads at `csv`.
    pub fn read(csv: &Path, sensor: &SensorGeometry) -> Result<Self, CommandError> {
        let name = csv.display();
        let file = File::open(csv)
            .map_err(|e| format!("{name}: {e}; expected a CSV file of {}", COLUMNS.join(",")))?;
        let pictures = read_loads(file, sensor.kernel.element_count());
        Ok(Self {
            csv: csv.to_path_buf(),
            pictures: pictures.map_err(|e| format!("{name}: {e}"))?,
        })
    }

    /// The file's name.
    pub fn name(&self) -> String {
        self.csv.display().to_string()
    }

    /// All files that are read: the file of loads, and the pictures and recordings that it names.
    pub fn files(&self) -> Vec<PathBuf> {
        let named = self.pictures.iter().map(|loaded| {
            let recorded = recorded(&loaded.picture);
            let file = recorded.map_or(loaded.picture.as_str(), |(file, _)| file);
            self.folder().join(file)
        });
        let files: HashSet<_> = named.chain([self.csv.clone()]).collect();
        files.into_iter().collect()
    }

    fn folder(&self) -> &Path {
        self.csv.parent().unwrap_or(Path::new(""))
    }

    /// Takes the moments of all pictures, and of the recordings at their times.
    pub fn measure(&self, sensor: &SensorGeometry) -> Result<Vec<ElementRecord>, CommandError> {
        let elements = sensor.kernel.element_count();
        let mut builder = RecordBuilder::new(elements);
        let mut moments = vec![ElementMoments::default(); elements];
        let mut recordings = HashMap::new();
        let progress = Steps::new(self.pictures.len());
        for loaded in &self.pictures {
            let read = match recorded(&loaded.picture) {
                Some((file, time)) => recorded_frames(&mut recordings, self.folder().join(file))
                    .and_then(|frames| take_recorded(frames, time, &mut moments)),
                None => measure(&self.folder().join(&loaded.picture), sensor, &mut moments),
            };
            read.map_err(|what| {
                let (name, line, picture) = (self.name(), loaded.line, &loaded.picture);
                format!("{name}: line {line}: picture = {picture:?}: {what}")
            })?;
            builder.add(&loaded.forces, &moments);
            progress.advance();
        }
        Ok(builder.finish())
    }
}

/// The frames of the recording at `path`, which is read once.
fn recorded_frames(
    recordings: &mut HashMap<PathBuf, Vec<Moments>>,
    path: PathBuf,
) -> Result<&[Moments], String> {
    match recordings.entry(path) {
        Entry::Occupied(entry) => Ok(entry.into_mut()),
        Entry::Vacant(entry) => {
            let read = read_moments(entry.key()).map_err(|e| e.to_string())?;
            Ok(entry.insert(read))
        }
    }
}

/// Takes the moments of a picture.
fn measure(
    path: &Path,
    sensor: &SensorGeometry,
    moments: &mut [ElementMoments],
) -> Result<(), String> {
    let (width, height) = sensor.size;
    let expected = format!("expected a picture of {width}x{height} px");
    let picture = read_picture(path).map_err(|e| format!("{e}; {expected}"))?;
    if (picture.width, picture.height) != (width, height) {
        let (width, height) = (picture.width, picture.height);
        return Err(format!("it has {width}x{height} px; {expected}"));
    }
    let measured = sensor.kernel.measure(&picture, moments);
    measured.map_err(|e| e.to_string())
}

/// The recording and the time (s) that `FILE.mcap@TIME` names.
fn recorded(picture: &str) -> Option<(&str, f64)> {
    let (file, time) = picture.rsplit_once('@')?;
    let is_recording = Path::new(file).extension()?.eq_ignore_ascii_case("mcap");
    let time = time.parse().ok().filter(|time: &f64| time.is_finite())?;
    is_recording.then_some((file, time))
}

/// The moments of the recorded frame nearest to `time`, s, which must be within half of the time
/// between frames.
fn take_recorded(
    frames: &[Moments],
    time: f64,
    moments: &mut [ElementMoments],
) -> Result<(), String> {
    let off = |frame: &Moments| (frame.stamp - time).abs();
    let nearest = frames.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    let frame = nearest.ok_or("the recording is empty")?;
    let (first, last) = (frames[0].stamp, frames[frames.len() - 1].stamp);
    let spacing = (last - first) / (frames.len() - 1).max(1) as f64;
    // A hair more than half of it, for times that were rounded.
    if off(frame) > 0.501 * spacing + 1e-6 {
        return Err(format!(
            "the nearest frame is at {} s; expected a time from {first} to {last} s",
            frame.stamp
        ));
    }
    if frame.integrated_gray.len() != moments.len()
        || frame.centroid_x.len() != moments.len()
        || frame.centroid_y.len() != moments.len()
    {
        return Err(format!(
            "it was recorded of {} elements; expected {}",
            frame.integrated_gray.len(),
            moments.len()
        ));
    }
    for (element, moments) in moments.iter_mut().enumerate() {
        let centroid = DVec2::new(frame.centroid_x[element], frame.centroid_y[element]);
        *moments = ElementMoments {
            integrated_gray: frame.integrated_gray[element],
            centroid: if centroid.is_finite() {
                centroid
            } else {
                DVec2::ZERO
            },
        };
    }
    Ok(())
}

/// Writes pictures of the simulated fingertip under load, and the file of loads.
pub fn write_simulated(
    folder: &Path,
    fingertip: &FingertipConfig,
    optics: &OpticsConfig,
    bench: &CalibrationBenchConfig,
) -> Result<(), CommandError> {
    let failed = |e: &dyn std::fmt::Display| {
        let folder = folder.display();
        format!("--write-loads {folder}: {e}; expected a new folder that can be written to")
    };
    fs::create_dir_all(folder).map_err(|e| failed(&e))?;
    // Written last: its rows may name pictures only when all are there.
    let keep = Overwrite { force: false };
    let file = Outputs::new(keep, []).create(&folder.join(LOADS), "--write-loads")?;
    let mut rows = csv::Writer::from_writer(Vec::new());
    rows.write_record(COLUMNS).map_err(|e| failed(&e))?;
    let mut number = 0;
    take_pictures(fingertip, optics, bench, |picture, loads| {
        let name = format!("{number:05}.png");
        number += 1;
        let path = folder.join(&name);
        if path.exists() {
            return Err(failed(&format!("there is a {name} already")).into());
        }
        let (width, height) = (picture.width as u32, picture.height as u32);
        let gray = ExtendedColorType::L8;
        let saved = image::save_buffer_with_format(
            path,
            &picture.pixels,
            width,
            height,
            gray,
            ImageFormat::Png,
        );
        saved.map_err(|e| failed(&e))?;
        for (element, load) in loads.iter().enumerate() {
            let DVec3 { x, y, z } = load.force();
            rows.serialize((&name, element, x, y, z))
                .map_err(|e| failed(&e))?;
        }
        Ok::<_, CommandError>(())
    })?;
    file.finish(&rows.into_inner().map_err(|e| failed(&e))?)
}
