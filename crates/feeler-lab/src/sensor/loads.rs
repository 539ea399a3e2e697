//! Calibration loads on disk: a CSV file with the forces on the elements, and the images or recordings it refers to.

use super::SensorGeometry;
use super::recorded::{NamedFrame, NamedFrames, files_of};
use feeler::sensor::calibration::{
    COLUMNS, Calibration, ELEMENT_RANGE, ForceAxes, LoadCheckError, LoadedImage, LoadsError,
    RecordBuilder, check_axes_of_recordings, check_magnitude, check_numbers, check_offsets,
    check_outliers, check_unloaded, read_loads,
};
use feeler::sensor::image::ProjectedElement;
use feeler::sensor::moments::ElementMoments;
use glam::DVec3;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Error of a file of loads or of the images that it refers to.
#[derive(Debug, thiserror::Error)]
pub enum LoadsFileError {
    /// The file cannot be read.
    #[error("{}: {source}; expected a CSV file of {}", csv.display(), COLUMNS.join(","))]
    File {
        /// Path of the CSV file.
        csv: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a valid table of loads.
    #[error("{}: {source}", csv.display())]
    Loads {
        /// Path of the CSV file.
        csv: PathBuf,
        /// Error of the loads.
        source: LoadsError,
    },
    /// The images contradict the loads.
    #[error("{}: {source}", csv.display())]
    Contradicted {
        /// Path of the CSV file.
        csv: PathBuf,
        /// Contradiction between images and loads.
        source: LoadCheckError,
    },
    /// An image that the file refers to cannot be used.
    #[error("{}: line {line}: picture = {picture:?}: {what}", csv.display())]
    Picture {
        /// Path of the CSV file.
        csv: PathBuf,
        /// Line number in the CSV file of the first row that names the image.
        line: u64,
        /// Name of the image, as in the file.
        picture: String,
        /// Description of the problem and the expected content.
        what: String,
    },
}

/// A file of loads: the forces on the elements in each image.
pub struct LoadsFile {
    csv: PathBuf,
    pictures: Vec<LoadedImage>,
}

impl LoadsFile {
    /// Reads the file of loads at `csv` for a sensor with the elements `seen`. `axes` assigns columns, with signs, to
    /// the axes x, y and z of an element.
    ///
    /// # Errors
    /// If the file cannot be read or is invalid.
    pub fn read(
        csv: &Path,
        seen: &[ProjectedElement],
        axes: ForceAxes,
    ) -> Result<Self, LoadsFileError> {
        let csv = csv.to_path_buf();
        let file = match File::open(&csv) {
            Ok(file) => file,
            Err(source) => return Err(LoadsFileError::File { csv, source }),
        };
        match read_loads(file, seen, axes) {
            Ok(pictures) => Ok(Self { csv, pictures }),
            Err(source) => Err(LoadsFileError::Loads { csv, source }),
        }
    }

    /// Returns the path as text.
    pub fn name(&self) -> String {
        self.csv.display().to_string()
    }

    /// Returns all input files: the file of loads, and the images and recordings it refers to.
    pub fn files(&self) -> Vec<PathBuf> {
        files_of(&self.csv, self.picture_names())
    }

    /// Number of images.
    pub fn picture_count(&self) -> usize {
        self.pictures.len()
    }

    /// Calls `loaded` with each loaded element and the force on it in its frame (N).
    pub fn each_force(&self, mut loaded: impl FnMut(usize, DVec3)) {
        for picture in &self.pictures {
            for (element, force) in picture.forces.iter().enumerate() {
                if let Some(force) = force.filter(|&force| force != DVec3::ZERO) {
                    loaded(element, force);
                }
            }
        }
    }

    /// Rejects loads that are too large for a soft element or too small to be visible.
    ///
    /// # Errors
    /// If the largest load is out of range. The error suggests the likely unit.
    pub fn check_magnitude(&self) -> Result<(), LoadsFileError> {
        let forces = self.pictures.iter().flat_map(|picture| &picture.forces);
        let forces = forces.copied().flatten();
        self.checked(check_magnitude("an element", forces, ELEMENT_RANGE))
    }

    /// Rejects loads that contradict the images in the number of elements, signs, axes or the zero offsets of
    /// recordings.
    ///
    /// # Errors
    /// If there is a contradiction. The error suggests its likely cause.
    pub fn check(&self, measured: &RecordBuilder) -> Result<(), LoadsFileError> {
        let pictures = measured.pictures();
        self.checked(check_numbers(pictures))?;
        self.checked(check_axes_of_recordings(pictures, self.picture_names()))?;
        self.checked(check_unloaded(pictures, self.picture_names()))
    }

    /// Rejects loads that contradict the `calibration` fitted to them: a single outlier that exceeds all other loads,
    /// or constant offsets that differ between recordings. Returns a single outlier of ordinary size as a warning.
    ///
    /// # Errors
    /// If there is a contradiction. The error contains the load and its prediction, or the column, the recordings and
    /// their difference.
    pub fn check_fit(
        &self,
        measured: &RecordBuilder,
        calibration: &Calibration,
    ) -> Result<Option<LoadsFileError>, LoadsFileError> {
        let pictures = measured.pictures();
        let doubtful = check_outliers(calibration, pictures, self.picture_names());
        let doubtful = self.checked(doubtful)?;
        self.checked(check_offsets(calibration, pictures, self.picture_names()))?;
        Ok(doubtful.map(|source| self.contradicted(source)))
    }

    fn checked<T>(&self, result: Result<T, LoadCheckError>) -> Result<T, LoadsFileError> {
        result.map_err(|source| self.contradicted(source))
    }

    fn contradicted(&self, source: LoadCheckError) -> LoadsFileError {
        LoadsFileError::Contradicted {
            csv: self.csv.clone(),
            source,
        }
    }

    fn picture_names(&self) -> impl Iterator<Item = &str> {
        self.pictures.iter().map(|loaded| loaded.picture.as_str())
    }

    /// Computes the moments of all images, and reads those of recordings at the given times. Calls `measured` after
    /// each one.
    ///
    /// # Errors
    /// If an image cannot be used. The error contains its line and the expected content.
    pub fn measure(
        &self,
        sensor: &SensorGeometry,
        mut measured: impl FnMut(),
    ) -> Result<RecordBuilder, LoadsFileError> {
        let elements = sensor.kernel.element_count();
        let mut builder = RecordBuilder::new(elements);
        let mut moments = vec![ElementMoments::default(); elements];
        let mut frames = NamedFrames::new(&self.csv, sensor.size);
        for loaded in &self.pictures {
            let frame = frames.get(&loaded.picture, &mut moments);
            let taken = frame.and_then(|frame| match frame {
                NamedFrame::Sensed => Ok(()),
                NamedFrame::Picture(picture) => {
                    let taken = sensor.kernel.measure(&picture, &mut moments);
                    taken.map_err(|e| e.to_string())
                }
            });
            taken.map_err(|what| LoadsFileError::Picture {
                csv: self.csv.clone(),
                line: loaded.line,
                picture: loaded.picture.clone(),
                what,
            })?;
            builder.add(&loaded.forces, &moments);
            measured();
        }
        Ok(builder)
    }
}
