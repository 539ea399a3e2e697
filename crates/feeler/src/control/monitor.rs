//! Whether what the hand's sensors say can be true.

use super::frozen_forces::FrozenForces;
use super::joint_monitor::JointMonitor;
use super::monitor_config::MonitorConfig;
use super::stop_reason::StopReason;
use super::touch::FingerTouch;
use crate::hand::finger::FingerGeometry;
use glam::DVec3;

/// What is watched of one finger: its joints and its forces.
#[derive(Debug, Clone)]
pub struct FingerMonitor {
    joints: JointMonitor,
    forces: FrozenForces,
}

impl FingerMonitor {
    /// A monitor of a finger of `elements` elements that has seen nothing yet. After a gap of more than `most_gap` (s)
    /// between two joint states, what the drives did is not known.
    pub fn new(config: MonitorConfig, elements: usize, most_gap: f64) -> Self {
        Self {
            joints: JointMonitor::new(config, most_gap),
            forces: FrozenForces::new(config.frozen_frames, elements),
        }
    }

    /// Forgets what was, as the hand goes on after a stop.
    pub fn reset(&mut self) {
        self.joints.reset();
        self.forces.reset();
    }

    /// Looks at what `finger` felt, and at its joint angles (rad) and their stamp (s), after its drives were told to turn
    /// with `command`, rad/s. Does not allocate.
    ///
    /// # Errors
    /// When a sensor cannot be right.
    pub fn watch(
        &mut self,
        (finger, geometry): (usize, &FingerGeometry),
        touch: &FingerTouch,
        joints: (f64, DVec3),
        command: DVec3,
    ) -> Result<(), StopReason> {
        self.joints.watch(finger, geometry, joints, command)?;
        self.forces.watch(finger, touch)
    }
}
