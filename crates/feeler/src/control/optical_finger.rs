//! Sets up the control loop of fingers with camera-based fingertips, from their configurations.

use super::config::ControlConfig;
use super::control_loop::{ControlError, ControlLoop};
use super::controller::Controller;
use super::law::LawError;
use super::phase::Phase;
use super::task::TaskConfig;
use super::touch::{FlaggedSensor, TactileSource};
use crate::hand::{FingerConfig, FingerError, FingerGeometry, Hand};
use crate::pace::Schedule;
use crate::sensor::calibration::Calibration;
use crate::sensor::fingertip::{ElementLayout, Fingertip, FingertipError};
use crate::sensor::forces::{OpticalSensor, SensingError};
use crate::sensor::image::Camera;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// Maximum number of consecutive missed control periods; above it, the hand is stopped.
const MAX_MISSED: u64 = 10;

/// A finger with a camera-based fingertip: its sensor, element layout and geometry.
pub struct OpticalFinger<C> {
    sensor: OpticalSensor<C>,
    layout: ElementLayout,
    geometry: FingerGeometry,
}

/// Error of setting up a hand.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The calibration was not made for a fingertip with a dome.
    #[error("expected the calibration of a fingertip, got that of a located layout")]
    NoFingertip,
    /// The fingertip is invalid.
    #[error(transparent)]
    Fingertip(#[from] FingertipError),
    /// The geometry of the finger is invalid.
    #[error(transparent)]
    Finger(#[from] FingerError),
    /// The sensor cannot be set up.
    #[error(transparent)]
    Sensing(#[from] SensingError),
    /// The control law cannot be set up.
    #[error(transparent)]
    Law(#[from] LawError),
    /// The number of fingers differs from that of the hand.
    #[error("expected {expected} fingers, as the hand has, got {actual}")]
    FingerCount {
        /// Number of fingers of the hand.
        expected: usize,
        /// Number of fingers that were given.
        actual: usize,
    },
}

impl<C: Camera> OpticalFinger<C> {
    /// Creates a finger from the camera in its fingertip, the calibration of that fingertip, and the geometry of the
    /// finger.
    ///
    /// # Errors
    /// If the calibration was not made for a fingertip with a dome, or a configuration is invalid.
    pub fn new(
        camera: C,
        calibration: Calibration,
        finger: &FingerConfig,
    ) -> Result<Self, SetupError> {
        let fingertip = calibration.made_for.fingertip.clone();
        let fingertip = fingertip.ok_or(SetupError::NoFingertip)?;
        Ok(Self {
            layout: Fingertip::new(&fingertip)?.layout,
            geometry: FingerGeometry::new(finger)?,
            sensor: OpticalSensor::new(camera, &fingertip, calibration)?,
        })
    }
}

impl<C: Camera, H: Hand> ControlLoop<FlaggedSensor<OpticalSensor<C>>, H> {
    /// Creates the control loop of `hand` with `fingers`, in the order of the hand's fingers.
    ///
    /// # Errors
    /// If the number of fingers differs from that of the hand, or the control law cannot be set up.
    pub fn with_fingers(
        fingers: Vec<OpticalFinger<C>>,
        hand: H,
        control: ControlConfig,
        task: &TaskConfig,
    ) -> Result<Self, SetupError> {
        let (expected, actual) = (hand.finger_count(), fingers.len());
        if expected != actual {
            return Err(SetupError::FingerCount { expected, actual });
        }
        let thresholds = control.thresholds();
        let (mut sensors, mut geometries, mut layouts) = (Vec::new(), Vec::new(), Vec::new());
        for finger in fingers {
            sensors.push(FlaggedSensor::new(finger.sensor, thresholds));
            geometries.push(finger.geometry);
            layouts.push(finger.layout);
        }
        let controller = Controller::new(control, task, &geometries, &layouts)?;
        Ok(Self::new(sensors, hand, controller))
    }
}

impl<S: TactileSource, H: Hand> ControlLoop<S, H> {
    /// Runs the task until it is done, the hand is stopped, or `interrupted` is set, and returns the last phase. Stops
    /// the hand at the end, and if more than ten consecutive periods are missed.
    ///
    /// # Errors
    /// If the hand or a sensor fails.
    pub fn run_task(
        &mut self,
        schedule: &mut impl Schedule,
        interrupted: &AtomicBool,
    ) -> Result<Phase, ControlError> {
        self.run(
            schedule,
            MAX_MISSED,
            interrupted,
            |control_loop, _| match control_loop.controller().phase().is_final() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            },
        )?;
        Ok(self.controller().phase())
    }
}
