//! Where a sensor's elements are: by an experiment's fingertip, or by a layout that was located.

use super::CommandError;
use feeler::sensor::calibration::{Calibration, LengthUnit, MadeFor};
use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::located_layout::LocatedLayout;
use feeler::sensor::moments::MomentsKernel;
use feeler::sensor::subregion::WeightedPixel;
use feeler_lab::config::Experiment;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longest layout or calibration file, bytes.
const MAX_TEXT: u64 = 16 << 20;

/// What is needed of a sensor to take moments of its pictures, and to tell it from others.
pub struct SensorGeometry {
    /// Columns and rows of its pictures, px.
    pub size: (usize, usize),
    /// Takes the moments.
    pub kernel: MomentsKernel,
    /// The pixels of each element.
    pub regions: Vec<Vec<WeightedPixel>>,
    /// What a calibration of it says that it was made for.
    pub made_for: MadeFor,
}

impl SensorGeometry {
    /// The fingertip of the experiment called `name`, that of `finger` or what all have, or the layout
    /// in the file `layout`, if there is one.
    pub fn of(
        name: &str,
        finger: Option<usize>,
        layout: Option<&Path>,
    ) -> Result<Self, CommandError> {
        match layout {
            Some(path) => Self::of_layout(path)
                .map_err(|e| format!("--layout {}: {e}", path.display()).into()),
            None => Self::of_fingertip(Experiment::load(name, &[])?.fingertip(finger)?),
        }
    }

    fn of_layout(path: &Path) -> Result<Self, CommandError> {
        let layout = LocatedLayout::from_toml(&read_text(path)?)?;
        let unit = match layout.dome {
            Some(_) => LengthUnit::Metre,
            None => LengthUnit::Pixel,
        };
        Ok(Self {
            size: (layout.width, layout.height),
            kernel: layout.kernel()?,
            regions: layout.weighted_pixels()?,
            made_for: MadeFor::layout(&layout.to_toml()?, layout.elements.len(), unit),
        })
    }

    /// The fingertip that `config` describes.
    pub fn of_fingertip(config: &FingertipConfig) -> Result<Self, CommandError> {
        let (kernel, regions) = Fingertip::kernel_and_subregions(config)?;
        Ok(Self {
            size: (config.camera.width, config.camera.height),
            kernel,
            regions,
            made_for: MadeFor::fingertip(config)?,
        })
    }

    /// The calibration in the file `path`, if it was made for this sensor.
    pub fn read_calibration(&self, path: &Path) -> Result<Calibration, CommandError> {
        let read = || -> Result<Calibration, CommandError> {
            let calibration = Calibration::from_toml(&read_text(path)?)?;
            self.made_for.check_same(&calibration.made_for)?;
            Ok(calibration)
        };
        read().map_err(|e| format!("--calibration {}: {e}", path.display()).into())
    }
}

fn read_text(path: &Path) -> Result<String, CommandError> {
    let mut text = String::new();
    File::open(path)?.take(MAX_TEXT).read_to_string(&mut text)?;
    Ok(text)
}
