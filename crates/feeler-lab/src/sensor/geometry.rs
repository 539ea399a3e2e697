//! Geometry of a sensor, from the fingertip of an experiment or from a located layout.

use crate::config::{ConfigError, Experiment, read_text};
use feeler::sensor::calibration::{Calibration, CalibrationError, CalibrationTarget, LengthUnit};
use feeler::sensor::fingertip::{
    Fingertip, FingertipConfig, FingertipError, LayoutError, LocatedLayout, SensingElement,
};
use feeler::sensor::forces::{SensingChain, SensingError};
use feeler::sensor::image::{DEFAULT_MAX_SATURATED, ProjectedElement, WeightedPixel};
use feeler::sensor::moments::{MomentsError, MomentsKernel};
use feeler::sensor::track::MarkerTracker;
use feeler::sensor::wrench::WrenchError;
use glam::{DMat3, DVec3};
use std::path::Path;

/// Error of a sensor geometry or calibration that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum GeometryError {
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] std::io::Error),
    /// The layout is invalid.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The fingertip is invalid.
    #[error(transparent)]
    Fingertip(#[from] FingertipError),
    /// Moments cannot be computed.
    #[error(transparent)]
    Moments(#[from] MomentsError),
    /// The calibration is invalid or was made for another sensor.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The wrench calibration is invalid or was made for another sensor.
    #[error(transparent)]
    Wrench(#[from] WrenchError),
    /// The experiment cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

/// Data required to compute the moments of a sensor's images and to identify the sensor.
#[derive(Debug, Clone)]
pub struct SensorGeometry {
    /// Width and height of the images (px).
    pub size: (usize, usize),
    /// Computes the moments.
    pub kernel: MomentsKernel,
    /// Pixels of each element, with weights.
    pub regions: Vec<Vec<WeightedPixel>>,
    /// Projection of each element into the image.
    pub seen: Vec<ProjectedElement>,
    /// Rotation from each element's frame to the fingertip frame. Empty if lengths are in pixels.
    pub frames: Vec<DMat3>,
    /// Radius of the sphere through the unloaded tips of the elements (m), or `None` if lengths are in pixels.
    pub dome_radius: Option<f64>,
    /// Default for the maximum fraction of an element's pixels that may be saturated.
    pub max_saturated: f64,
    /// Identification of the sensor for which a calibration is made.
    pub made_for: CalibrationTarget,
    /// Located layout, or `None` for the fingertip of an experiment.
    pub layout: Option<LocatedLayout>,
    /// `true` if elements are tracked as markers; `false` if moments of sub-regions are computed. Ignored without a
    /// layout.
    pub tracked: bool,
}

impl SensorGeometry {
    /// Returns the geometry of the fingertip of `finger` in the experiment `name`, or of its default fingertip if
    /// `finger` is `None`.
    ///
    /// # Errors
    /// If there is no such experiment or finger, or the fingertip is invalid.
    pub fn of_experiment(name: &str, finger: Option<usize>) -> Result<Self, GeometryError> {
        Self::of_fingertip(Experiment::load(name, &[])?.fingertip(finger)?)
    }

    /// Reads a layout file, as written by `feeler locate`.
    ///
    /// # Errors
    /// If the file cannot be read or is invalid.
    pub fn read_layout(path: &Path) -> Result<Self, GeometryError> {
        Self::of_layout(&read_layout(path)?)
    }

    /// Returns the geometry of a located layout. Lengths are in pixels if the layout has no dome.
    ///
    /// # Errors
    /// If the layout is invalid.
    pub fn of_layout(layout: &LocatedLayout) -> Result<Self, GeometryError> {
        let unit = match layout.dome {
            Some(_) => LengthUnit::Metre,
            None => LengthUnit::Pixel,
        };
        Ok(Self {
            size: (layout.width, layout.height),
            kernel: layout.kernel()?,
            regions: layout.weighted_pixels()?,
            seen: layout.seen_elements()?,
            frames: layout.element_frames(),
            dome_radius: layout.dome.as_ref().map(|dome| dome.radius),
            max_saturated: layout.max_saturated(),
            made_for: CalibrationTarget::layout(&layout.to_toml()?, layout.elements.len(), unit),
            layout: Some(layout.clone()),
            tracked: false,
        })
    }

    /// Returns the geometry of the fingertip that `config` describes.
    ///
    /// # Errors
    /// If the fingertip is invalid.
    pub fn of_fingertip(config: &FingertipConfig) -> Result<Self, GeometryError> {
        let (layout, _) = Fingertip::layout_and_projection(config)?;
        let (kernel, regions) = Fingertip::kernel_and_subregions(config)?;
        Ok(Self {
            size: (config.camera.width, config.camera.height),
            kernel,
            regions,
            seen: Fingertip::seen_elements(config)?,
            frames: layout.elements.iter().map(|e| e.rotation).collect(),
            dome_radius: Some(layout.dome_radius),
            max_saturated: DEFAULT_MAX_SATURATED,
            made_for: CalibrationTarget::fingertip(config)?,
            layout: None,
            tracked: false,
        })
    }

    /// Elements with their unloaded tips (m, in the fingertip frame), or `None` if lengths are in pixels.
    pub fn places(&self) -> Option<Vec<(SensingElement, DVec3)>> {
        let radius = self.dome_radius?;
        let place = |&rotation: &DMat3| {
            let element = SensingElement { ring: 0, rotation };
            (element, radius * element.normal())
        };
        Some(self.frames.iter().map(place).collect())
    }

    /// Creates a sensing chain for the sensor, without a calibration.
    ///
    /// # Errors
    /// If the regions do not match the kernel, or if markers are tracked but there are too few.
    pub fn sensing_chain(&self) -> Result<SensingChain, SensingError> {
        let chain = SensingChain::new(
            self.size,
            self.kernel.clone(),
            &self.regions,
            self.max_saturated,
        )?;
        Ok(match self.layout.as_ref().filter(|_| self.tracked) {
            Some(layout) => chain.with_tracker(MarkerTracker::new(layout)?),
            None => chain,
        })
    }

    /// Reads the calibration at `path` and verifies that it was made for this sensor.
    ///
    /// # Errors
    /// If the file cannot be read, is invalid, or was made for another sensor.
    pub fn read_calibration(&self, path: &Path) -> Result<Calibration, GeometryError> {
        self.parse_calibration(&read_text(path)?)
    }

    /// Parses the text of a calibration file and verifies that it was made for this sensor.
    ///
    /// # Errors
    /// If the calibration is invalid or was made for another sensor.
    pub fn parse_calibration(&self, text: &str) -> Result<Calibration, GeometryError> {
        let calibration = Calibration::from_toml(text)?;
        self.made_for.verify_same(&calibration.made_for)?;
        Ok(calibration)
    }
}

/// Reads a layout file, as written by `feeler locate`.
///
/// # Errors
/// If the file cannot be read or is invalid.
pub fn read_layout(path: &Path) -> Result<LocatedLayout, GeometryError> {
    Ok(LocatedLayout::from_toml(&read_text(path)?)?)
}
