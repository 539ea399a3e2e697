//! Uses a ROS 2 tactile sensor as the fingertip of a finger.

use feeler::sensor::forces::TactileFrame;
use feeler_console::CommandError;
use feeler_lab::config::{Experiment, RosFingerConfig};
use feeler_lab::experiment::rigs::linked::expected;
use feeler_link::programs::{ProgramError, SensorConfig, SensorProgram, Warn};
use feeler_link::transport::Network;
use feeler_ros2::{Node, RosSensor, SensorAge};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time to wait for forces before checking whether to stop.
const WAIT: Duration = Duration::from_millis(50);

/// Sensor program of one finger.
pub struct Fingertip {
    finger: usize,
    sensor: RosSensor,
    program: SensorProgram,
    frame: TactileFrame,
    /// Error of the latest forces; empty if they are valid.
    trouble: String,
}

impl Fingertip {
    /// Creates the sensor that `config` specifies for `finger` of `experiment`, or returns `None` if it specifies
    /// none. `network` opens the network with the rights of that finger's sensor.
    pub fn new(
        node: &mut Node,
        experiment: &Experiment,
        finger: usize,
        config: &RosFingerConfig,
        age: &SensorAge,
        network: impl FnOnce() -> Result<Arc<dyn Network>, CommandError>,
    ) -> Result<Option<Self>, CommandError> {
        let fingertip = experiment.fingertip(Some(finger))?;
        let elements = fingertip.layout.element_count();
        let sensor = match (&config.cloud, &config.wrench) {
            (Some(topic), _) => RosSensor::cloud(node, topic, elements, age.clone())?,
            (None, Some(topic)) => RosSensor::wrench(node, topic, age.clone())?,
            (None, None) => return Ok(None),
        };
        let expected = expected(experiment)?;
        let config = SensorConfig {
            finger,
            elements,
            picture_size: (fingertip.camera.width, fingertip.camera.height),
            thresholds: experiment.config.control.thresholds(),
            fingertip: expected.fingertips[finger].clone(),
            expected,
        };
        Ok(Some(Self {
            finger,
            sensor,
            program: SensorProgram::new(&config, network()?)?,
            frame: TactileFrame::unloaded(elements),
            trouble: String::new(),
        }))
    }

    /// Sets the receiver of warnings.
    pub fn set_warn(&mut self, warn: Warn) {
        self.program.set_warn(warn);
    }

    /// Publishes tactile data until `interrupted` is set. Stale or invalid data are not published, so that the hand
    /// stops.
    ///
    /// # Errors
    /// If the network fails.
    pub fn run(&mut self, interrupted: &AtomicBool) -> Result<(), ProgramError> {
        while !interrupted.load(Ordering::Relaxed) {
            self.program.check_peers();
            if !self.sensor.wait_for_next(self.frame.sequence, WAIT) && self.trouble.is_empty() {
                continue;
            }
            let measured = match self.sensor.read_measured(&mut self.frame) {
                Ok(measured) => measured,
                Err(error) => {
                    self.tell(error.to_string());
                    continue;
                }
            };
            self.trouble.clear();
            let forces = self.frame.forces.iter();
            let forces = forces.map(|force| Some(*force).filter(|force| force.is_finite()));
            let taken = (self.frame.sequence - 1, self.frame.stamp, measured);
            self.program.publish(taken, forces)?;
        }
        Ok(())
    }

    /// Prints a warning when a problem starts.
    fn tell(&mut self, trouble: String) {
        if self.trouble.is_empty() {
            let finger = self.finger;
            self.program.warn(&format!("finger {finger}: {trouble}"));
        }
        self.trouble = trouble;
    }
}
