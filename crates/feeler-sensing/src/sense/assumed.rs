//! Checks that images show the default fingertip if no fingertip was named.

use super::SenseOptions;
use feeler::sensor::calibration::Calibration;
use feeler::sensor::forces::Likeness;
use feeler::sensor::image::{Picture, WeightedPixel};
use feeler::sensor::moments::ElementMoments;
use feeler_console::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::sensor::SensorGeometry;

/// Advice appended to errors.
const ADVICE: &str = "Find its elements with `feeler locate PICTURE -o layout.toml` and pass `--layout layout.toml`, or name the \
                       experiment of the fingertip with `--experiment`";

/// Fingertip of an experiment that is assumed if none is named.
pub struct AssumedFingertip {
    experiment: String,
    size: (usize, usize),
    dark_level: u8,
    calibration: Calibration,
    regions: Vec<Vec<WeightedPixel>>,
}

impl AssumedFingertip {
    /// Returns the assumed fingertip, described by `geometry`, or `None` if a fingertip was named.
    pub fn of(
        options: &SenseOptions,
        geometry: &SensorGeometry,
    ) -> Result<Option<Self>, CommandError> {
        if !options.assumes_fingertip() {
            return Ok(None);
        }
        let experiment = Experiment::load(options.experiment(), &[])?;
        let config = experiment.fingertip(options.finger)?;
        Ok(Some(Self {
            experiment: options.experiment().into(),
            size: geometry.size,
            dark_level: config.moments.dark_level,
            calibration: experiment.calibration(options.finger.unwrap_or(0))?,
            regions: geometry.regions.clone(),
        }))
    }

    /// Checks that `picture`, with its `moments`, may show the fingertip, and returns a note about the assumption.
    ///
    /// # Errors
    /// If the image does not show the fingertip. The message describes the difference and the remedy.
    pub fn check(
        &self,
        picture: &Picture,
        moments: &[ElementMoments],
    ) -> Result<String, CommandError> {
        let Self {
            experiment,
            calibration,
            regions,
            dark_level,
            ..
        } = self;
        let likeness = Likeness::of(picture, moments, calibration, regions, *dark_level);
        if !likeness.is_enough() {
            return Err(format!(
                "the image does not show the assumed fingertip of {experiment}: {likeness}. {ADVICE}"
            )
            .into());
        }
        let Likeness {
            alike, elements, ..
        } = likeness;
        Ok(format!(
            "assuming the fingertip of {experiment}: {alike} of its {elements} elements are in possible positions; use \
             --layout or --experiment to select another"
        ))
    }

    /// Returns the error message for an image `name` whose size (px) differs from the fingertip's images.
    pub fn refuse_size(&self, name: &str, (width, height): (usize, usize)) -> String {
        let (experiment, (columns, rows)) = (&self.experiment, self.size);
        format!(
            "{name}: a {width}x{height} px image does not show the assumed fingertip of {experiment}; expected {columns}x{rows} \
             px. {ADVICE}"
        )
    }
}
