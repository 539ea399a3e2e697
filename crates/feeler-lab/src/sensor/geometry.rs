//! Where a sensor's elements are: by an experiment's fingertip, or by a layout that was located.

use crate::config::{ConfigError, Experiment};
use feeler::sensor::calibration::{Calibration, CalibrationError, LengthUnit, MadeFor};
use feeler::sensor::exposure::DEFAULT_MAX_SATURATED;
use feeler::sensor::fingertip::{Fingertip, FingertipConfig, FingertipError};
use feeler::sensor::located_layout::{LayoutError, LocatedLayout};
use feeler::sensor::moments::MomentsKernel;
use feeler::sensor::moments_config::MomentsError;
use feeler::sensor::seen::SeenElement;
use feeler::sensor::subregion::WeightedPixel;
use feeler::sensor::wrench::WrenchError;
use glam::DMat3;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longest layout or calibration file, bytes.
const MAX_TEXT: u64 = 16 << 20;

/// Why a sensor's geometry or its calibration cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum GeometryError {
    /// A file could not be read.
    #[error(transparent)]
    File(#[from] std::io::Error),
    /// The layout makes no sense.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The fingertip makes no sense.
    #[error(transparent)]
    Fingertip(#[from] FingertipError),
    /// Moments cannot be taken.
    #[error(transparent)]
    Moments(#[from] MomentsError),
    /// The calibration makes no sense, or was made for another sensor.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The wrench calibration makes no sense, or was made for another sensor.
    #[error(transparent)]
    Wrench(#[from] WrenchError),
    /// The experiment cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

/// What is needed of a sensor to take moments of its pictures, and to tell it from others.
#[derive(Debug, Clone)]
pub struct SensorGeometry {
    /// Columns and rows of its pictures, px.
    pub size: (usize, usize),
    /// Takes the moments.
    pub kernel: MomentsKernel,
    /// The pixels of each element.
    pub regions: Vec<Vec<WeightedPixel>>,
    /// Where the camera sees each element.
    pub seen: Vec<SeenElement>,
    /// Rotation of each element's frame in the fingertip's; none where lengths are px.
    pub frames: Vec<DMat3>,
    /// Part of an element's pixels that may be saturated, unless another one is asked for.
    pub max_saturated: f64,
    /// What a calibration of it says that it was made for.
    pub made_for: MadeFor,
}

impl SensorGeometry {
    /// The fingertip of the experiment called `name`: that of `finger`, or what fingers have without one of their own.
    ///
    /// # Errors
    /// When there is no such experiment or finger, or the fingertip makes no sense.
    pub fn of_experiment(name: &str, finger: Option<usize>) -> Result<Self, GeometryError> {
        Self::of_fingertip(Experiment::load(name, &[])?.fingertip(finger)?)
    }

    /// The layout in the file at `path`, as `feeler locate` writes it.
    ///
    /// # Errors
    /// When it cannot be read or makes no sense.
    pub fn read_layout(path: &Path) -> Result<Self, GeometryError> {
        Self::of_layout(&read_layout(path)?)
    }

    /// The elements of `layout`; without a dome in it, lengths are px.
    ///
    /// # Errors
    /// When the layout makes no sense.
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
            max_saturated: layout.max_saturated(),
            made_for: MadeFor::layout(&layout.to_toml()?, layout.elements.len(), unit),
        })
    }

    /// The fingertip that `config` describes.
    ///
    /// # Errors
    /// When it makes no sense.
    pub fn of_fingertip(config: &FingertipConfig) -> Result<Self, GeometryError> {
        let (layout, _) = Fingertip::layout_and_projection(config)?;
        let (kernel, regions) = Fingertip::kernel_and_subregions(config)?;
        Ok(Self {
            size: (config.camera.width, config.camera.height),
            kernel,
            regions,
            seen: Fingertip::seen_elements(config)?,
            frames: layout.elements.iter().map(|e| e.rotation).collect(),
            max_saturated: DEFAULT_MAX_SATURATED,
            made_for: MadeFor::fingertip(config)?,
        })
    }

    /// The calibration in the file at `path`, if it was made for this sensor.
    ///
    /// # Errors
    /// When it cannot be read, makes no sense, or was made for another sensor.
    pub fn read_calibration(&self, path: &Path) -> Result<Calibration, GeometryError> {
        let calibration = Calibration::from_toml(&read_text(path)?)?;
        self.made_for.check_same(&calibration.made_for)?;
        Ok(calibration)
    }
}

/// The layout in the file at `path`, as `feeler locate` writes it.
///
/// # Errors
/// When it cannot be read or makes no sense.
pub fn read_layout(path: &Path) -> Result<LocatedLayout, GeometryError> {
    Ok(LocatedLayout::from_toml(&read_text(path)?)?)
}

/// The text of a layout's or a calibration's file.
pub(super) fn read_text(path: &Path) -> Result<String, std::io::Error> {
    let mut text = String::new();
    File::open(path)?.take(MAX_TEXT).read_to_string(&mut text)?;
    Ok(text)
}
