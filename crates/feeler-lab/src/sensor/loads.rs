//! Loads on disk: pictures, or recordings of what was sensed, and the CSV that says what was on the
//! elements in each.

use super::SensorGeometry;
use feeler::sensor::calibration_fit::ElementRecord;
use feeler::sensor::loads::{COLUMNS, LoadedPicture, LoadsError, RecordBuilder, read_loads};
use feeler::sensor::moments::ElementMoments;
use feeler_record::{Moments, read_moments};
use feeler_sources::picture::read_picture;
use glam::DVec2;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Why loads on disk cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LoadsFileError {
    /// The file could not be read.
    #[error("{}: {source}; expected a CSV file of {}", csv.display(), COLUMNS.join(","))]
    File {
        /// The file.
        csv: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is no file of loads.
    #[error("{}: {source}", csv.display())]
    Loads {
        /// The file.
        csv: PathBuf,
        /// What is wrong with it.
        source: LoadsError,
    },
    /// A picture that it names cannot be used.
    #[error("{}: line {line}: picture = {picture:?}: {what}", csv.display())]
    Picture {
        /// The file.
        csv: PathBuf,
        /// Line of the picture's first row.
        line: u64,
        /// The picture, as the file names it.
        picture: String,
        /// What was found and what was expected.
        what: String,
    },
}

/// A file of loads, with what was on the elements in each picture that it names.
pub struct LoadsFile {
    csv: PathBuf,
    pictures: Vec<LoadedPicture>,
}

impl LoadsFile {
    /// Reads the file of loads at `csv`, on a sensor of `elements` elements.
    ///
    /// # Errors
    /// When it cannot be read, or is no such file.
    pub fn read(csv: &Path, elements: usize) -> Result<Self, LoadsFileError> {
        let csv = csv.to_path_buf();
        let file = match File::open(&csv) {
            Ok(file) => file,
            Err(source) => return Err(LoadsFileError::File { csv, source }),
        };
        match read_loads(file, elements) {
            Ok(pictures) => Ok(Self { csv, pictures }),
            Err(source) => Err(LoadsFileError::Loads { csv, source }),
        }
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

    /// Number of pictures.
    pub fn picture_count(&self) -> usize {
        self.pictures.len()
    }

    /// Takes the moments of all pictures, and of the recordings at their times, with `sensor`; calls `measured` after each. One
    /// record for each element.
    ///
    /// # Errors
    /// Names the line of the picture that cannot be used, and what was expected.
    pub fn measure(
        &self,
        sensor: &SensorGeometry,
        mut measured: impl FnMut(),
    ) -> Result<Vec<ElementRecord>, LoadsFileError> {
        let elements = sensor.kernel.element_count();
        let mut builder = RecordBuilder::new(elements);
        let mut moments = vec![ElementMoments::default(); elements];
        let mut recordings = HashMap::new();
        for loaded in &self.pictures {
            let read = match recorded(&loaded.picture) {
                Some((file, time)) => recorded_frames(&mut recordings, self.folder().join(file))
                    .and_then(|frames| take_recorded(frames, time, &mut moments)),
                None => measure(&self.folder().join(&loaded.picture), sensor, &mut moments),
            };
            read.map_err(|what| LoadsFileError::Picture {
                csv: self.csv.clone(),
                line: loaded.line,
                picture: loaded.picture.clone(),
                what,
            })?;
            builder.add(&loaded.forces, &moments);
            measured();
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
