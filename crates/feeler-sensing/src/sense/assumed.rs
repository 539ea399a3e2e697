//! The fingertip that pictures are taken to be of where nobody says whose they are.

use super::SenseOptions;
use feeler::sensor::calibration::Calibration;
use feeler::sensor::frame::Picture;
use feeler::sensor::likeness::Likeness;
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::subregion::WeightedPixel;
use feeler_console::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::sensor::SensorGeometry;

/// What to do about it.
const WAY_OUT: &str = "Find its elements with `feeler locate PICTURE -o layout.toml` and give `--layout layout.toml`, or name the \
                       experiment whose fingertip it is with `--experiment`";

/// An experiment's fingertip that nobody has named.
pub struct AssumedFingertip {
    experiment: String,
    size: (usize, usize),
    dark_level: u8,
    calibration: Calibration,
    regions: Vec<Vec<WeightedPixel>>,
}

impl AssumedFingertip {
    /// The fingertip that is assumed, whose `geometry` is this; none where one was named.
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

    /// What was assumed, if `picture`, and the `moments` of it, may be of the fingertip.
    ///
    /// # Errors
    /// When it cannot be: what was seen, and what to do.
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
                "the picture is not of the fingertip of {experiment}, which is assumed: {likeness}. {WAY_OUT}"
            )
            .into());
        }
        let Likeness {
            alike, elements, ..
        } = likeness;
        Ok(format!(
            "the fingertip of {experiment} is assumed, as {alike} of its {elements} elements are where they can be; --layout or \
             --experiment names another"
        ))
    }

    /// That the picture called `name` has another size, px, than the fingertip's pictures.
    pub fn refuse_size(&self, name: &str, (width, height): (usize, usize)) -> String {
        let (experiment, (columns, rows)) = (&self.experiment, self.size);
        format!(
            "{name}: a picture of {width}x{height} px is not of the fingertip of {experiment}, which is assumed: {columns}x{rows} px \
             expected. {WAY_OUT}"
        )
    }
}
