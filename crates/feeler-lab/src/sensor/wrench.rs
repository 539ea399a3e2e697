//! Measured wrenches on disk: a CSV file with the wrench on the whole fingertip, and the images or recordings it
//! refers to.

use super::recorded::{NamedFrame, NamedFrames, files_of};
use super::{GeometryError, SensorGeometry};
use crate::config::read_text;
use feeler::sensor::calibration::{FINGERTIP_RANGE, LoadCheckError, check_magnitude};
use feeler::sensor::forces::{ElementReading, SensingChain, SensingError};
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::wrench::forces::{ForcesError, MeasuredForces, MeasuredPicture, read_forces};
use feeler::sensor::wrench::moments::usable;
use feeler::sensor::wrench::taxels::{MeasuredAt, TaxelCalibration};
use feeler::sensor::wrench::{WrenchCalibration, WrenchSample};
use glam::DVec3;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Error of a file of measured wrenches or of the images that it refers to.
#[derive(Debug, thiserror::Error)]
pub enum ForcesFileError {
    /// The file cannot be read.
    #[error("{}: {source}; expected a CSV file of picture,f_x,f_y,f_z,m_x,m_y,m_z", csv.display())]
    File {
        /// Path of the CSV file.
        csv: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a valid table of wrenches.
    #[error("{}: {source}", csv.display())]
    Forces {
        /// Path of the CSV file.
        csv: PathBuf,
        /// Error of the table.
        source: ForcesError,
    },
    /// Moments cannot be computed for the sensor.
    #[error(transparent)]
    Sensing(#[from] SensingError),
    /// No image can be used.
    #[error("none of the images can be used; the first: {reason}")]
    NoPicture {
        /// The problem with the first image.
        reason: String,
    },
}

/// A file of measured wrenches.
pub struct ForcesFile {
    csv: PathBuf,
    forces: MeasuredForces,
}

/// Moments of the images of a file of wrenches.
pub struct MeasuredSamples {
    /// The images that could be read, grouped by recording and ordered by time.
    pub samples: Vec<WrenchSample>,
    /// Name and line number of each sample's image.
    pub pictures: Vec<(String, u64)>,
    /// Messages about the other images: file, line, and the problem.
    pub skipped: Vec<String>,
}

impl ForcesFile {
    /// Reads the file of measured wrenches at `csv`.
    ///
    /// # Errors
    /// If the file cannot be read or is invalid.
    pub fn read(csv: &Path) -> Result<Self, ForcesFileError> {
        let csv = csv.to_path_buf();
        let file = match File::open(&csv) {
            Ok(file) => file,
            Err(source) => return Err(ForcesFileError::File { csv, source }),
        };
        match read_forces(file) {
            Ok(forces) => Ok(Self { csv, forces }),
            Err(source) => Err(ForcesFileError::Forces { csv, source }),
        }
    }

    /// Returns the path of the CSV file as text.
    pub fn name(&self) -> String {
        self.csv.display().to_string()
    }

    /// Names of the recordings.
    pub fn recordings(&self) -> &[String] {
        &self.forces.recordings
    }

    /// Calls `measured` with each force (N) that has all three components.
    pub fn each_force(&self, mut measured: impl FnMut(DVec3)) {
        for picture in &self.forces.pictures {
            if let [Some(x), Some(y), Some(z), ..] = picture.wrench {
                measured(DVec3::new(x, y, z));
            }
        }
    }

    /// Rejects forces that are too large for a soft fingertip or too small to be visible.
    ///
    /// # Errors
    /// If the largest force is out of range. The error suggests the likely unit.
    pub fn check_magnitude(&self) -> Result<(), LoadCheckError> {
        let pictures = self.forces.pictures.iter();
        let forces = pictures.map(|picture| {
            let [x, y, z, ..] = picture.wrench.map(Option::unwrap_or_default);
            DVec3::new(x, y, z)
        });
        check_magnitude("the fingertip", forces, FINGERTIP_RANGE)
    }

    /// Number of images.
    pub fn picture_count(&self) -> usize {
        self.forces.pictures.len()
    }

    /// Returns all input files: the file of wrenches, and the images and recordings it refers to.
    pub fn files(&self) -> Vec<PathBuf> {
        let pictures = self.forces.pictures.iter();
        files_of(
            &self.csv,
            pictures.map(|measured| measured.picture.as_str()),
        )
    }

    /// Path of the file `name`, which the table refers to.
    pub fn path_of(&self, name: &str) -> PathBuf {
        self.csv.parent().unwrap_or(Path::new("")).join(name)
    }

    /// Wrenches measured in the recording of index `recording`, ordered by time. Returns `None` if a row has no time.
    pub fn measured_in(&self, recording: usize) -> Option<Vec<MeasuredAt>> {
        let pictures = self.forces.pictures.iter();
        let own = pictures.filter(|picture| picture.recording == recording);
        let measured = own.map(|picture| {
            Some(MeasuredAt {
                time: picture.time?,
                wrench: picture.wrench,
            })
        });
        measured.collect()
    }

    /// Computes the moments of all images, and reads those of recordings at the given times. Calls `sensed` after each
    /// one. Images that cannot be used are skipped with a message.
    ///
    /// # Errors
    /// If none of the images can be used.
    pub fn sense(
        &self,
        sensor: &SensorGeometry,
        mut sensed: impl FnMut(),
    ) -> Result<MeasuredSamples, ForcesFileError> {
        let elements = sensor.kernel.element_count();
        let mut eye = Eye {
            frames: NamedFrames::new(&self.csv, sensor.size),
            chain: sensor.sensing_chain()?,
            readings: vec![ElementReading::default(); elements],
            moments: vec![ElementMoments::default(); elements],
            tracked: sensor.tracked,
        };
        let mut all = MeasuredSamples {
            samples: Vec::new(),
            pictures: Vec::new(),
            skipped: Vec::new(),
        };
        for measured in &self.forces.pictures {
            let MeasuredPicture { picture, line, .. } = measured;
            match eye.see(picture) {
                Ok(seen) => {
                    all.samples.push(WrenchSample {
                        recording: measured.recording,
                        seen,
                        wrench: measured.wrench,
                    });
                    all.pictures.push((picture.clone(), *line));
                }
                Err(what) => {
                    let csv = self.csv.display();
                    let skipped = format!("{csv}: line {line}: picture = {picture:?}: {what}");
                    all.skipped.push(skipped);
                }
            }
            sensed();
        }
        match all.skipped.first() {
            Some(first) if all.samples.is_empty() => Err(ForcesFileError::NoPicture {
                reason: first.clone(),
            }),
            _ => Ok(all),
        }
    }
}

/// Reads images and recordings and computes their moments.
struct Eye {
    frames: NamedFrames,
    chain: SensingChain,
    readings: Vec<ElementReading>,
    moments: Vec<ElementMoments>,
    /// `true` if markers are tracked, which requires images.
    tracked: bool,
}

impl Eye {
    /// Returns the moments of each element, `None` for elements that are dark or saturated.
    fn see(&mut self, name: &str) -> Result<Vec<Option<ElementMoments>>, String> {
        let NamedFrame::Picture(picture) = self.frames.get(name, &mut self.moments)? else {
            if self.tracked {
                return Err("expected a recording with images, in which markers can be tracked, got only moments; record with `feeler sense --record-frames`".into());
            }
            let lit = |moments: &ElementMoments| {
                (moments.integrated_gray.is_finite() && moments.integrated_gray > 0.0)
                    .then_some(*moments)
            };
            return Ok(self.moments.iter().map(lit).collect());
        };
        let sensed = self.chain.sense(&picture, &mut self.readings);
        sensed.map_err(|e| e.to_string())?;
        Ok(self.readings.iter().map(usable).collect())
    }
}

impl SensorGeometry {
    /// Reads the wrench calibration at `path` and verifies that it was made for this sensor. Sets
    /// [`tracked`](Self::tracked) as in the calibration. Returns `None` if the file is of another kind.
    ///
    /// # Errors
    /// If the file cannot be read, is invalid, or was made for another sensor.
    pub fn read_wrench_calibration(
        &mut self,
        path: &Path,
    ) -> Result<Option<WrenchCalibration>, GeometryError> {
        self.parse_wrench_calibration(&read_text(path)?)
    }

    /// Parses the text of a wrench calibration and verifies that it was made for this sensor. Sets
    /// [`tracked`](Self::tracked) as in the calibration. Returns `None` if it is of another kind.
    ///
    /// # Errors
    /// If the calibration is invalid or was made for another sensor.
    pub fn parse_wrench_calibration(
        &mut self,
        text: &str,
    ) -> Result<Option<WrenchCalibration>, GeometryError> {
        // A calibration of taxels is a wrench calibration, too, which is rejected below.
        if !WrenchCalibration::is_kind(text) && !TaxelCalibration::is_kind(text) {
            return Ok(None);
        }
        let calibration = WrenchCalibration::from_toml(text)?;
        calibration.verify_target(&self.made_for)?;
        self.tracked = calibration.tracked;
        Ok(Some(calibration))
    }
}
