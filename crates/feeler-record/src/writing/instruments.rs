//! Instrument readings at a control step.

use crate::messages::channels::{Cap, ObjectPose, TorqueSensor, TrueSlip};
use crate::messages::model::SolidFrame;
use feeler::math::quaternion_z;
use glam::DAffine3;

/// Readings of a rig's instruments and a simulated world's ground truth at a control step, as far as available.
#[derive(Debug, Clone, Copy, Default)]
pub struct InstrumentRecord<'a> {
    /// Reading of the torque sensor.
    pub torque: Option<&'a TorqueSensor>,
    /// True state of the cap.
    pub cap: Option<&'a Cap>,
    /// True slip of the feelers.
    pub slip: Option<&'a TrueSlip>,
    /// True pose of the carried object.
    pub object: Option<&'a ObjectPose>,
}

impl InstrumentRecord<'_> {
    /// Pose of `frame` in `W`, or `None` if unknown.
    pub(crate) fn pose(&self, frame: SolidFrame) -> Option<DAffine3> {
        let (turned, origin) = match frame {
            SolidFrame::World => return Some(DAffine3::IDENTITY),
            SolidFrame::Cap => (quaternion_z(self.cap?.angle), self.cap?.centre),
            SolidFrame::Object => (self.object?.orientation.into(), self.object?.position),
        };
        Some(DAffine3::from_rotation_translation(turned, origin.into()))
    }
}
