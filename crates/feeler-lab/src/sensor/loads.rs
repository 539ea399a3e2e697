//! Loads on disk: pictures, or recordings of what was sensed, and the CSV that says what was on the
//! elements in each.

use super::SensorGeometry;
use super::recorded::{NamedFrame, NamedFrames, files_of};
use feeler::sensor::calibration::Calibration;
use feeler::sensor::live_calibration::ForceAxes;
use feeler::sensor::load_check::{
    ELEMENT_RANGE, LoadCheckError, check_axes_of_recordings, check_magnitude, check_numbers,
    check_offsets, check_outliers, check_unloaded,
};
use feeler::sensor::loads::{COLUMNS, LoadedPicture, LoadsError, RecordBuilder, read_loads};
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::seen::SeenElement;
use glam::DVec3;
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
    /// The pictures contradict it.
    #[error("{}: {source}", csv.display())]
    Contradicted {
        /// The file.
        csv: PathBuf,
        /// What they contradict.
        source: LoadCheckError,
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
    /// Reads the file of loads at `csv`, on a sensor whose elements are `seen` so; `axes` are the columns, with their signs, that are x, y and
    /// z of an element.
    ///
    /// # Errors
    /// When it cannot be read, or is no such file.
    pub fn read(csv: &Path, seen: &[SeenElement], axes: ForceAxes) -> Result<Self, LoadsFileError> {
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

    /// The file's name.
    pub fn name(&self) -> String {
        self.csv.display().to_string()
    }

    /// All files that are read: the file of loads, and the pictures and recordings that it names.
    pub fn files(&self) -> Vec<PathBuf> {
        files_of(&self.csv, self.picture_names())
    }

    /// Number of pictures.
    pub fn picture_count(&self) -> usize {
        self.pictures.len()
    }

    /// Calls `loaded` with each element that was loaded, and the force on it in its frame, N.
    pub fn each_force(&self, mut loaded: impl FnMut(usize, DVec3)) {
        for picture in &self.pictures {
            for (element, force) in picture.forces.iter().enumerate() {
                if let Some(force) = force.filter(|&force| force != DVec3::ZERO) {
                    loaded(element, force);
                }
            }
        }
    }

    /// Refuses loads that no soft element bears, or that no picture shows.
    ///
    /// # Errors
    /// Names the largest load and the likely unit.
    pub fn check_magnitude(&self) -> Result<(), LoadsFileError> {
        let forces = self.pictures.iter().flat_map(|picture| &picture.forces);
        let forces = forces.copied().flatten();
        self.checked(check_magnitude("an element", forces, ELEMENT_RANGE))
    }

    /// Refuses loads that the pictures contradict: numbers of elements, signs and axes, zeros of recordings.
    ///
    /// # Errors
    /// Names what they contradict, and the likely cause.
    pub fn check(&self, measured: &RecordBuilder) -> Result<(), LoadsFileError> {
        let pictures = measured.pictures();
        self.checked(check_numbers(pictures))?;
        self.checked(check_axes_of_recordings(pictures, self.picture_names()))?;
        self.checked(check_unloaded(pictures, self.picture_names()))
    }

    /// Refuses loads that contradict the `calibration` fitted to them: a single one that the others do not predict and that exceeds them all,
    /// and those that are off by another constant in one recording than in another. Returns a single one that the others do not predict but
    /// that is of their size.
    ///
    /// # Errors
    /// Names the load and what is predicted, or column, recordings and the difference.
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

    /// Takes the moments of all pictures, and of the recordings at their times, with `sensor`; calls `measured` after each.
    ///
    /// # Errors
    /// Names the line of the picture that cannot be used, and what was expected.
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
