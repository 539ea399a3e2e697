//! Measured wrenches on disk: pictures, or recordings of what was sensed, and the CSV that says what acted on the whole fingertip
//! in each.

use super::geometry::read_text;
use super::recorded::{NamedFrame, NamedFrames, files_of};
use super::{GeometryError, SensorGeometry};
use feeler::sensor::load_check::{FINGERTIP_RANGE, LoadCheckError, check_magnitude};
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::sensing::{ElementReading, SensingChain, SensingError};
use feeler::sensor::wrench::features::usable;
use feeler::sensor::wrench::forces::{ForcesError, MeasuredForces, MeasuredPicture, read_forces};
use feeler::sensor::wrench::{WrenchCalibration, WrenchSample};
use glam::DVec3;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Why measured wrenches on disk cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ForcesFileError {
    /// The file could not be read.
    #[error("{}: {source}; expected a CSV file of picture,f_x,f_y,f_z,m_x,m_y,m_z", csv.display())]
    File {
        /// The file.
        csv: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is no file of measured wrenches.
    #[error("{}: {source}", csv.display())]
    Forces {
        /// The file.
        csv: PathBuf,
        /// What is wrong with it.
        source: ForcesError,
    },
    /// The sensor cannot sense.
    #[error(transparent)]
    Sensing(#[from] SensingError),
    /// No picture that it names can be used.
    #[error("no picture can be used, the first not as {reason}")]
    NoPicture {
        /// What is wrong with the first.
        reason: String,
    },
}

/// A file of measured wrenches.
pub struct ForcesFile {
    csv: PathBuf,
    forces: MeasuredForces,
}

/// What a file's pictures say.
pub struct MeasuredSamples {
    /// Pictures that could be read, recording by recording, in the order of time.
    pub samples: Vec<WrenchSample>,
    /// What each is called, and in which line of the file.
    pub pictures: Vec<(String, u64)>,
    /// What was wrong with the others: file, line, expected and found.
    pub skipped: Vec<String>,
}

impl ForcesFile {
    /// Reads the file of measured wrenches at `csv`.
    ///
    /// # Errors
    /// When it cannot be read, or is no such file.
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

    /// The file's name.
    pub fn name(&self) -> String {
        self.csv.display().to_string()
    }

    /// Name of each recording.
    pub fn recordings(&self) -> &[String] {
        &self.forces.recordings
    }

    /// Calls `measured` with each force of which all components were measured, N.
    pub fn each_force(&self, mut measured: impl FnMut(DVec3)) {
        for picture in &self.forces.pictures {
            if let [Some(x), Some(y), Some(z), ..] = picture.wrench {
                measured(DVec3::new(x, y, z));
            }
        }
    }

    /// Refuses forces that no soft fingertip bears, or that no picture shows.
    ///
    /// # Errors
    /// Names the largest force and the likely unit.
    pub fn check_magnitude(&self) -> Result<(), LoadCheckError> {
        let pictures = self.forces.pictures.iter();
        let forces = pictures.map(|picture| {
            let [x, y, z, ..] = picture.wrench.map(Option::unwrap_or_default);
            DVec3::new(x, y, z)
        });
        check_magnitude("the fingertip", forces, FINGERTIP_RANGE)
    }

    /// Number of pictures.
    pub fn picture_count(&self) -> usize {
        self.forces.pictures.len()
    }

    /// All files that are read: the file of wrenches, and the pictures and recordings that it names.
    pub fn files(&self) -> Vec<PathBuf> {
        let pictures = self.forces.pictures.iter();
        files_of(
            &self.csv,
            pictures.map(|measured| measured.picture.as_str()),
        )
    }

    /// Senses all pictures, and the recordings at their times, with `sensor`; calls `sensed` after each. A picture that cannot be
    /// used is skipped, with a reason.
    ///
    /// # Errors
    /// When no picture can be used.
    pub fn sense(
        &self,
        sensor: &SensorGeometry,
        mut sensed: impl FnMut(),
    ) -> Result<MeasuredSamples, ForcesFileError> {
        let elements = sensor.kernel.element_count();
        let kernel = sensor.kernel.clone();
        let mut eye = Eye {
            frames: NamedFrames::new(&self.csv, sensor.size),
            chain: SensingChain::new(sensor.size, kernel, &sensor.regions, sensor.max_saturated)?,
            readings: vec![ElementReading::default(); elements],
            moments: vec![ElementMoments::default(); elements],
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

/// Looks at pictures and into recordings.
struct Eye {
    frames: NamedFrames,
    chain: SensingChain,
    readings: Vec<ElementReading>,
    moments: Vec<ElementMoments>,
}

impl Eye {
    /// The moments of each element; none of one that is dark or saturated.
    fn see(&mut self, name: &str) -> Result<Vec<Option<ElementMoments>>, String> {
        let NamedFrame::Picture(picture) = self.frames.get(name, &mut self.moments)? else {
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
    /// The wrench calibration in the file at `path`, if it is one and was made for this sensor; none where the file is of another kind.
    ///
    /// # Errors
    /// When the file cannot be read, or is a wrench calibration that makes no sense or was made for another sensor.
    pub fn read_wrench_calibration(
        &self,
        path: &Path,
    ) -> Result<Option<WrenchCalibration>, GeometryError> {
        let text = read_text(path)?;
        if !WrenchCalibration::is_kind(&text) {
            return Ok(None);
        }
        let calibration = WrenchCalibration::from_toml(&text)?;
        calibration.check_made_for(&self.made_for)?;
        Ok(Some(calibration))
    }
}
