//! Forces on a fingertip by a calibration, with the flags of the paper.

use feeler::control::{FlagAnalyzer, FlagThresholds};
use feeler::sensor::forces::{ElementReading, NO_FORCE, SensingChain, TactileFrame};
use feeler::sensor::image::Picture;
use feeler::sensor::wrench::{AXES, WrenchEstimator};
use feeler_lab::sensor::SensorGeometry;
use glam::DVec3;
use serde::Serialize;
use std::error::Error;

/// Computes forces from images: of each element with flags, or the wrench on the whole fingertip.
pub struct Forces {
    chain: SensingChain,
    readings: Vec<ElementReading>,
    kind: Kind,
}

enum Kind {
    Elements {
        analyzer: FlagAnalyzer,
        frame: TactileFrame,
    },
    Wrench(WrenchEstimator),
}

/// Forces in one image, as the page shows them.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Felt {
    /// Forces of the elements by the flag analyzer.
    Elements {
        touch: bool,
        slip: bool,
        over: bool,
        /// Sum of the compressions (N).
        grasp_force: f64,
        /// Number of elements without a valid force.
        invalid: usize,
    },
    /// Wrench on the whole fingertip.
    Wrench {
        /// Force (N) and torque (N m); `None` for components that are not calibrated.
        components: [Option<f64>; AXES],
        /// `false` if the image is unlike those of the calibration.
        valid: bool,
    },
}

impl Forces {
    /// Prepares the calibration file with the content `text` for the sensor, with flags by `thresholds`.
    ///
    /// # Errors
    /// If the file is invalid, or was made for another sensor.
    pub fn new(
        geometry: SensorGeometry,
        text: &str,
        thresholds: FlagThresholds,
    ) -> Result<Self, Box<dyn Error>> {
        let wrench = geometry.wrench_calibration(text)?;
        let elements = match wrench {
            Some(_) => None,
            None => Some(geometry.calibration(text)?),
        };
        let count = geometry.regions.len();
        let chain = SensingChain::new(
            geometry.size,
            geometry.kernel,
            &geometry.regions,
            geometry.max_saturated,
        )?;
        let chain = match elements {
            Some(calibration) => chain.with_calibration(calibration)?,
            None => chain,
        };
        let kind = match wrench {
            Some(calibration) => Kind::Wrench(WrenchEstimator::new(calibration)?),
            None => Kind::Elements {
                analyzer: FlagAnalyzer::new(thresholds, count),
                frame: TactileFrame::unloaded(count),
            },
        };
        Ok(Self {
            chain,
            readings: vec![ElementReading::default(); count],
            kind,
        })
    }

    /// Returns the forces in `picture`, taken `stamp` seconds after the start of the video.
    ///
    /// # Errors
    /// If the image has another size, or does not fit the calibration.
    pub fn sense(&mut self, picture: &Picture<&[u8]>, stamp: f64) -> Result<Felt, Box<dyn Error>> {
        self.chain.sense(picture, &mut self.readings)?;
        self.chain.check_first(picture)?;
        Ok(match &mut self.kind {
            Kind::Elements { analyzer, frame } => {
                if stamp < frame.stamp {
                    return Err("the time of the images runs backwards".into());
                }
                frame.sequence += 1;
                frame.stamp = stamp;
                for (force, reading) in frame.forces.iter_mut().zip(&self.readings) {
                    *force = reading.force.unwrap_or(NO_FORCE);
                }
                let flags = analyzer.analyze(frame);
                Felt::Elements {
                    touch: flags.touch,
                    slip: flags.slip,
                    over: flags.over,
                    grasp_force: flags.grasp_force,
                    invalid: frame.forces.iter().filter(|force| force.is_nan()).count(),
                }
            }
            Kind::Wrench(estimator) => {
                let estimate = estimator.estimate(&self.readings);
                Felt::Wrench {
                    components: estimate.components,
                    valid: estimate.valid,
                }
            }
        })
    }

    /// Force on each element in the latest image (N, in its frame), [`NO_FORCE`] if there is none.
    pub fn of_elements(&self) -> impl Iterator<Item = DVec3> {
        let forces = self.readings.iter();
        forces.map(|reading| reading.force.unwrap_or(NO_FORCE))
    }
}
