//! Readings of a simulated rig's instruments, and their recording.

use super::truth::SlipMeter;
use feeler::control::{ControlLoop, TactileSource};
use feeler::hand::{Hand, MAX_FINGERS};
use feeler_link::messages::message::InstrumentsMessage;
use feeler_record::{MessageSink, RecordError, RunLog};
use feeler_sim::objects::{Motion, Pose, Turn};
use feeler_sim::rig::{SimRig, TorqueReading};
use glam::{DQuat, DVec3};

/// Simultaneous readings of the rig's instruments and ground truth, in addition to the hand's sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instruments {
    /// Reading of the torque sensor.
    pub torque: TorqueReading,
    /// True angle and torque of the cap, which is the first object with a thread; zero without a cap.
    pub cap: Turn,
    /// Position of the cap's origin in W (m).
    pub cap_centre: DVec3,
    /// True pose in W of the carried object, which is the first free object, if any.
    pub object: Option<Pose>,
    /// Ground truth for each finger: the longest distance that an anchor of its feelers slid since the previous reading
    /// (m), or between two frames if `sim.frame_period` is set.
    pub slipped: [f64; MAX_FINGERS],
}

impl Instruments {
    /// Reads the instruments of `rig`. `cap` is the index of the object with a thread.
    pub(super) fn read(rig: &SimRig, cap: Option<usize>, slip: &mut SlipMeter) -> Self {
        let mut world = rig.world();
        let torque = world.read_torque();
        let objects = world.model().objects.iter();
        let free = objects.zip(&world.state().objects);
        let object = free
            .filter(|(object, _)| matches!(object.motion, Motion::Free(_)))
            .map(|(_, state)| state.pose)
            .next();
        let cap = cap.and_then(|cap| world.state().objects.get(cap));
        Self {
            torque,
            cap: cap.map_or_else(Turn::default, |cap| cap.turn),
            cap_centre: cap.map_or(DVec3::ZERO, |cap| cap.pose.position),
            object,
            slipped: slip.read(world.state()),
        }
    }

    /// Writes the latest step of `control_loop` to `log`, with these readings, taken at the beginning of that step.
    ///
    /// # Errors
    /// If the recording cannot be written.
    pub fn record<R: MessageSink, S: TactileSource, H: Hand>(
        &self,
        control_loop: &ControlLoop<S, H>,
        log: &mut RunLog<R>,
    ) -> Result<(), RecordError> {
        let stamp = control_loop.state().stamp;
        let fingers = control_loop.touches().len();
        let read = InstrumentsMessage::from(self).recorded(stamp, fingers);
        log.write(control_loop, read.record())
    }
}

impl From<&Instruments> for InstrumentsMessage {
    fn from(at: &Instruments) -> Self {
        let object = at.object.unwrap_or(Pose::IDENTITY);
        Self {
            torque: at.torque.torque,
            bridge_voltage: at.torque.voltage,
            counts: at.torque.counts,
            cap_angle: at.cap.angle,
            cap_centre: at.cap_centre.into(),
            cap_torque: at.cap.torque,
            slipped: at.slipped,
            has_object: at.object.is_some(),
            object_position: object.position.into(),
            object_orientation: DQuat::from_mat3(&object.rotation).into(),
        }
    }
}
