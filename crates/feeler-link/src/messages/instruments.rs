//! Conversion of instrument readings from messages to records.

use super::message::InstrumentsMessage;
use feeler_record::{Cap, InstrumentRecord, ObjectPose, TorqueSensor, TrueSlip};

/// Instrument readings of a control step in the types of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedInstruments {
    torque: TorqueSensor,
    cap: Cap,
    slip: TrueSlip,
    object: Option<ObjectPose>,
}

impl RecordedInstruments {
    /// Returns the readings as a record.
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
    /// Converts the readings for a recording. `stamp` is the time of the control step (s), `fingers` the number of
    /// fingers.
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
