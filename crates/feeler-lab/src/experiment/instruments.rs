//! What a simulated rig's own instruments read, and its record.

use super::truth::SlipMeter;
use feeler::control::control_loop::ControlLoop;
use feeler::control::touch::TouchSource;
use feeler::hand::{Hand, MAX_FINGERS};
use feeler_link::message::InstrumentsMessage;
use feeler_record::{MessageSink, RecordError, RunLog};
use feeler_sim::object::Motion;
use feeler_sim::pose::Pose;
use feeler_sim::rig::SimRig;
use feeler_sim::thread::Turn;
use feeler_sim::torque_sensor::TorqueReading;
use glam::{DQuat, DVec3};

/// What the rig's own instruments say at one time, beside what the hand feels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instruments {
    /// The torque sensor's reading.
    pub torque: TorqueReading,
    /// How the cap stands, in truth: the first object on a thread, if there is one.
    pub cap: Turn,
    /// Where its origin is, m, in W.
    pub cap_centre: DVec3,
    /// Where the object is that is carried, in truth, in W: the first free object, if there is one.
    pub object: Option<Pose>,
    /// Of each finger's feelers, in truth, the longest way that an anchor slid since the instruments were read
    /// at another time before, m; with `sim.frame_period`, from one picture to the next.
    pub slipped: [f64; MAX_FINGERS],
}

impl Instruments {
    /// Reads those of `rig`, whose object `cap` is on a thread.
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

    /// Writes the newest step of `control_loop`, at whose beginning these instruments were read, to `log`.
    ///
    /// # Errors
    /// When the recording cannot be written.
    pub fn record<R: MessageSink, S: TouchSource, H: Hand>(
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
