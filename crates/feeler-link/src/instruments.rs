//! What a rig's instruments read, from its message to the record.

use super::message::InstrumentsMessage;
use feeler_record::{Cap, TorqueSensor, TrueSlip};

impl InstrumentsMessage {
    /// The same as it is recorded, of the control step at `stamp`, s, of a hand with so many `fingers`.
    pub fn recorded(&self, stamp: f64, fingers: usize) -> (TorqueSensor, Cap, TrueSlip) {
        let torque = TorqueSensor {
            stamp,
            torque: self.torque,
            bridge_voltage: self.bridge_voltage,
            counts: self.counts,
        };
        let cap = Cap {
            stamp,
            angle: self.cap_angle,
            height: self.cap_centre.z,
            centre: self.cap_centre,
            resisting_torque: self.cap_torque,
        };
        let slip = TrueSlip {
            stamp,
            distance: self.slipped.into_iter().take(fingers).collect(),
        };
        (torque, cap, slip)
    }
}
