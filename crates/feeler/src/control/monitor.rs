//! Plausibility checks of the hand's sensors.

use super::joint_monitor::JointMonitor;
use super::monitor_config::MonitorConfig;
use super::stop_reason::StopReason;
use super::stuck_sensor::StuckSensorDetector;
use super::touch::TactileReading;
use crate::hand::finger::FingerGeometry;
use glam::DVec3;

/// Monitors the joints and forces of one finger.
#[derive(Debug, Clone)]
pub struct FingerMonitor {
    joints: JointMonitor,
    forces: StuckSensorDetector,
}

impl FingerMonitor {
    /// Creates a monitor for a finger of `elements` elements. After a gap of more than `most_gap` (s) between two
    /// joint states, the motion of the drives is unknown.
    pub fn new(config: MonitorConfig, elements: usize, most_gap: f64) -> Self {
        Self {
            joints: JointMonitor::new(config, most_gap),
            forces: StuckSensorDetector::new(config.frozen_frames, elements),
        }
    }

    /// Forgets all readings, for use when the hand resumes after a stop.
    pub fn reset(&mut self) {
        self.joints.reset();
        self.forces.reset();
    }

    /// Checks the latest tactile reading of `finger` and its joint angles (stamp in s, angles in rad). `command` is
    /// the joint velocity in effect since the previous reading (rad/s). Does not allocate.
    ///
    /// # Errors
    /// If a sensor reading is implausible.
    pub fn watch(
        &mut self,
        (finger, geometry): (usize, &FingerGeometry),
        touch: &TactileReading,
        joints: (f64, DVec3),
        command: DVec3,
    ) -> Result<(), StopReason> {
        self.joints.watch(finger, geometry, joints, command)?;
        self.forces.watch(finger, touch)
    }
}
