//! What a rig's instruments read, from its message to the record.

use super::message::InstrumentsMessage;
use feeler_record::{Cap, InstrumentRecord, ObjectPose, TorqueSensor, TrueSlip};

/// What a rig's instruments read at a control step, as it is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedInstruments {
    torque: TorqueSensor,
    cap: Cap,
    slip: TrueSlip,
    object: Option<ObjectPose>,
}

impl RecordedInstruments {
    /// What is handed to the record.
    pub fn record(&self) -> InstrumentRecord<'_> {
        InstrumentRecord {
            torque: Some(&self.torque),
            cap: Some(&self.cap),
            slip: Some(&self.slip),
            object: self.object.as_ref(),
        }
    }
}

impl InstrumentsMessage {
    /// The same as it is recorded, of the control step at `stamp`, s, of a hand with so many `fingers`.
    pub fn recorded(&self, stamp: f64, fingers: usize) -> RecordedInstruments {
        RecordedInstruments {
            torque: TorqueSensor {
                stamp,
                torque: self.torque,
                bridge_voltage: self.bridge_voltage,
                counts: self.counts,
            },
            cap: Cap {
                stamp,
                angle: self.cap_angle,
                height: self.cap_centre.z,
                centre: self.cap_centre,
                resisting_torque: self.cap_torque,
            },
            slip: TrueSlip {
                stamp,
                distance: self.slipped.into_iter().take(fingers).collect(),
            },
            object: self.has_object.then_some(ObjectPose {
                stamp,
                position: self.object_position,
                orientation: self.object_orientation,
            }),
        }
    }
}
