//! Forces on a fingertip and the flags TOUCH, SLIP and OVER, computed with a calibration file.

use feeler::control::{ControlConfig, FlagAnalyzer, FlagThresholds};
use feeler::sensor::forces::{ElementReading, NO_FORCE, SensingChain, TactileFrame};
use feeler::sensor::image::Picture;
use feeler::sensor::wrench::{AXES, WrenchEstimator};
use feeler_lab::sensor::SensorGeometry;
use glam::DVec3;
use serde::Serialize;
use std::error::Error;

/// Computes from each image either the force on every element and the flags, or the total wrench.
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
    Wrench(Box<WrenchEstimator>),
}

/// Forces computed from one image, as the page shows them.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Sensed {
    /// Flags and grasp force, from the forces on the elements.
    Elements {
        touch: bool,
        slip: bool,
        over: bool,
        /// Sum of the compressions (N).
        grasp_force: f64,
        /// Number of elements without a valid force.
        invalid: usize,
    },
    /// Total wrench.
    Wrench {
        /// Force (N) and torque (N m); `None` for components that are not calibrated.
        components: [Option<f64>; AXES],
        /// `false` if the image differs too much from those of the calibration.
        valid: bool,
    },
}

impl Forces {
    /// Creates an estimator for the sensor from the calibration file content `text`.
    ///
    /// # Errors
    /// If the file is invalid, or was made for another sensor.
    pub fn new(mut geometry: SensorGeometry, text: &str) -> Result<Self, Box<dyn Error>> {
        let wrench = geometry.parse_wrench_calibration(text)?;
        let elements = match wrench {
            Some(_) => None,
            None => Some(geometry.parse_calibration(text)?),
        };
        let count = geometry.regions.len();
        let chain = geometry.sensing_chain()?;
        let chain = match elements {
            Some(calibration) => chain.with_calibration(calibration)?,
            None => chain,
        };
        let kind = match wrench {
            Some(calibration) => Kind::Wrench(Box::new(WrenchEstimator::new(calibration)?)),
            None => Kind::Elements {
                analyzer: FlagAnalyzer::new(ControlConfig::default().thresholds(), count),
                frame: TactileFrame::unloaded(count),
            },
        };
        Ok(Self {
            chain,
            readings: vec![ElementReading::default(); count],
            kind,
        })
    }

    /// Sets the thresholds of the flags. Has no effect with a calibration of the total wrench.
    pub fn set_thresholds(&mut self, thresholds: FlagThresholds) {
        if let Kind::Elements { analyzer, frame } = &mut self.kind {
            *analyzer = FlagAnalyzer::new(thresholds, frame.forces.len());
        }
    }

    /// Returns `true` if the calibration yields the force on each element, and therefore flags.
    pub fn has_flags(&self) -> bool {
        matches!(self.kind, Kind::Elements { .. })
    }

    /// Computes the forces from `picture`, taken `stamp` seconds after the start of the video.
    ///
    /// # Errors
    /// If the image has another size, or does not fit the calibration.
    pub fn sense(
        &mut self,
        picture: &Picture<&[u8]>,
        stamp: f64,
    ) -> Result<Sensed, Box<dyn Error>> {
        self.chain.sense(picture, &mut self.readings)?;
        self.chain.check_first(picture)?;
        Ok(match &mut self.kind {
            Kind::Elements { analyzer, frame } => {
                frame.sequence += 1;
                frame.stamp = stamp;
                for (force, reading) in frame.forces.iter_mut().zip(&self.readings) {
                    *force = reading.force.unwrap_or(NO_FORCE);
                }
                let flags = analyzer.analyze(frame);
                Sensed::Elements {
                    touch: flags.touch,
                    slip: flags.slip,
                    over: flags.over,
                    grasp_force: flags.grasp_force,
                    invalid: frame.forces.iter().filter(|force| force.is_nan()).count(),
                }
            }
            Kind::Wrench(estimator) => {
                let estimate = estimator.estimate(&self.readings);
                Sensed::Wrench {
                    components: estimate.components,
                    valid: estimate.valid,
                }
            }
        })
    }

    /// Force on each element (N, in its frame), computed from the latest image; [`NO_FORCE`] if unknown.
    pub fn element_forces(&self) -> impl Iterator<Item = DVec3> {
        let forces = self.readings.iter();
        forces.map(|reading| reading.force.unwrap_or(NO_FORCE))
    }
}
