//! What changes in a run.

use super::columnar_feeler::Anchor;
pub use super::contacts::Contacts;
use super::model::WorldModel;
use super::object::Motion;
use super::pose::Pose;
use super::servo::Joints;
use super::thread::Turn;
use feeler::hand::kinematics::fingertip_pose;
use glam::{DMat3, DVec3};

/// Feelers of which is seen together whether one must be looked at.
pub(super) const GROUP: usize = 8;

/// The true state of the simulated world.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Simulated time, s.
    pub time: f64,
    /// Steps taken; time is `steps * step`, so that it does not drift.
    pub steps: u64,
    /// The fingers.
    pub fingers: Vec<FingerState>,
    /// The objects, in the model's order.
    pub objects: Vec<ObjectState>,
    /// Torque behind the sensor's low-pass, N·m.
    pub filtered_torque: f64,
}

/// The true state of one object.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectState {
    /// Where it is.
    pub pose: Pose,
    /// How it stands on its hinge or thread, if it has one.
    pub turn: Turn,
    /// Velocity of a free body's centre of mass, m/s, in W.
    pub velocity: DVec3,
    /// Angular velocity of a free body, rad/s, in W.
    pub angular_velocity: DVec3,
    /// Force on a free body from outside, N, in W, and its torque about the object's origin, N·m.
    pub outside: (DVec3, DVec3),
    /// Mass of a free body, kg; 0 of what is not free.
    pub mass: f64,
    /// Factor on the friction of feelers on it.
    pub friction_factor: f64,
    /// How often it has moved by its hinge or thread, or with what it stands on.
    pub(super) moves: u64,
    /// By how much it and what it stands on turned in the last step, rad: by about as much again in the next.
    pub(super) last_turn: (f64, f64),
}

/// The true state of one finger.
#[derive(Debug, Clone, PartialEq)]
pub struct FingerState {
    /// Its joints.
    pub joints: Joints,
    /// Where its fingertip is: the dome's centre, and the fingertip frame `T`.
    pub tip: Pose,
    /// Where the fingertip is held from outside, if it does not follow its joints.
    pub held_at: Option<Pose>,
    /// Whether its fingertip was left where it was in the last step, as it cannot touch anything.
    pub(super) is_left: bool,
    /// The feelers that touch.
    pub contacts: Contacts,
    /// The fingertip as seen from each object, which has not moved since.
    pub(super) seen: Vec<Pose>,
    /// Rotation of the fingertip as seen from each object up to which its tips have rolled on it.
    pub(super) rolled: Vec<DMat3>,
    /// Set of each feeler that relaxes, m, in the fingertip frame `T`.
    pub sets: Vec<DVec3>,
    /// Force on what it touches by each feeler, N, in W.
    pub forces: Vec<DVec3>,
    /// How far each feeler's tip has slipped over what it touches since the beginning, m, without what it rolled.
    pub slipped: Vec<f64>,
    /// Work that friction took from feelers that slipped, J.
    pub slip_work: f64,
    /// What spares free feelers the search for a surface.
    pub(super) watch: Watch,
}

/// A feeler that touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The feeler.
    pub element: usize,
    /// The object that it holds on to.
    pub object: usize,
    /// Where.
    pub anchor: Anchor,
    /// How far it has rolled since its anchor was last put on the surface, m.
    pub rolled: f64,
    /// Centre of its undeformed tip in the object's frame one step ago, m.
    pub tip_before: DVec3,
}

/// How far a fingertip has come, and how far each free feeler may go before it can touch anything.
///
/// Distances from a surface change no faster than the tip moves relative to it, so that a feeler
/// that was 5 mm away need not be looked at before the fingertip has moved by 5 mm.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Watch {
    /// The fingertip as seen from each object, when it was last looked at.
    pub seen: Vec<Pose>,
    /// Upper bound of the way that any tip has gone relative to any object, m.
    pub travelled: f64,
    /// Way at which each feeler must be looked at again, m; infinite while it touches, and of those that fill up the last group.
    pub due: Vec<f64>,
    /// Nothing is due before this, m.
    pub soonest: f64,
    /// Upper bound of the way that any tip has gone since the fingertip was last looked at, m.
    pub unseen: f64,
    /// How often objects had moved by then.
    pub moves: u64,
}

impl FingerState {
    /// Whether any of its feelers holds on to `object`.
    #[inline(always)]
    pub(super) fn touches(&self, object: usize) -> bool {
        !self.contacts.on(object).is_empty()
    }
}

impl State {
    /// The world at time 0: fingers at rest at `joints` (rad, one triple per finger), objects where
    /// they start.
    pub fn new(model: &WorldModel, joints: &[DVec3]) -> Self {
        let objects: Vec<_> = model.objects.iter().map(ObjectState::new).collect();
        let fingers = model.fingers.iter().zip(joints).map(|(finger, &theta)| {
            let (position, rotation) = fingertip_pose(&finger.geometry, theta);
            let tip = Pose { position, rotation };
            let elements = finger.normals.len();
            let mut due = vec![0.0; elements];
            due.resize(elements.next_multiple_of(GROUP), f64::INFINITY);
            let seen: Vec<_> = objects.iter().map(|o| tip.seen_from(&o.pose)).collect();
            FingerState {
                joints: model.servo.joints(theta),
                tip,
                held_at: None,
                is_left: false,
                contacts: Contacts::none(objects.len(), elements),
                seen: seen.clone(),
                rolled: vec![DMat3::IDENTITY; objects.len()],
                sets: vec![DVec3::ZERO; elements],
                forces: vec![DVec3::ZERO; elements],
                slipped: vec![0.0; elements],
                slip_work: 0.0,
                watch: Watch {
                    seen,
                    travelled: 0.0,
                    due,
                    soonest: 0.0,
                    unseen: 0.0,
                    moves: 0,
                },
            }
        });
        Self {
            time: 0.0,
            steps: 0,
            fingers: fingers.collect(),
            objects,
            filtered_torque: 0.0,
        }
    }

    /// Work that friction took from all feelers that slipped, J.
    pub fn slip_work(&self) -> f64 {
        self.fingers.iter().map(|finger| finger.slip_work).sum()
    }

    /// Torque on what stands on the torque sensor, N·m.
    pub fn torque_on_sensor(&self, model: &WorldModel) -> f64 {
        let objects = self.objects.iter().zip(&model.objects);
        objects
            .filter(|(_, object)| matches!(&object.motion, Motion::Turns(h) if h.on_torque_sensor))
            .map(|(state, _)| state.turn.torque)
            .sum()
    }
}

impl ObjectState {
    fn new(object: &super::object::Object) -> Self {
        Self {
            pose: object.start,
            turn: Turn::default(),
            velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
            outside: (DVec3::ZERO, DVec3::ZERO),
            mass: object.mass().unwrap_or(0.0),
            friction_factor: 1.0,
            moves: 0,
            last_turn: (0.0, 0.0),
        }
    }

    /// Moves it to `pose`, by its hinge or thread, or with what it stands on.
    pub(super) fn move_to(&mut self, pose: Pose) {
        self.moves += u64::from(pose != self.pose);
        self.pose = pose;
    }
}
