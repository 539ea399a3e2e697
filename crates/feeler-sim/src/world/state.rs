//! Variable part of the world.

use super::model::WorldModel;
use crate::contact::contacts::Contacts;
use crate::objects::object::Motion;
use crate::objects::pose::Pose;
use crate::objects::thread::Turn;
use crate::rig::servo::Joints;
use feeler::hand::JointVector;
use feeler::hand::kinematics::fingertip_pose;
use glam::{DMat3, DVec3};

/// Number of feelers per group. Groups in which no feeler is due for a distance query are skipped.
pub(crate) const GROUP: usize = 8;

/// Ground truth of the simulated world.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Simulated time (s).
    pub time: f64,
    /// Number of steps taken; the time is `steps * step`, so it does not accumulate rounding errors.
    pub steps: u64,
    /// The fingers.
    pub fingers: Vec<FingerState>,
    /// The objects, in the model's order.
    pub objects: Vec<ObjectState>,
    /// Output of the torque sensor's low-pass filter (N·m).
    pub filtered_torque: f64,
}

/// Ground truth of one object.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectState {
    /// Pose in W.
    pub pose: Pose,
    /// State of its hinge or thread; default for other objects.
    pub turn: Turn,
    /// Velocity of a free body's centre of mass in W (m/s).
    pub velocity: DVec3,
    /// Angular velocity of a free body in W (rad/s).
    pub angular_velocity: DVec3,
    /// External force on a free body (N) and its torque about the object's origin (N·m), both in W.
    pub outside: (DVec3, DVec3),
    /// Force of pulls at the origin of a free body (N, in W).
    pub pull: DVec3,
    /// Mass of a free body (kg); 0 for other objects.
    pub mass: f64,
    /// Factor on the friction coefficients of feelers on the object.
    pub friction_factor: f64,
    /// Number of times that the object was moved by its hinge, thread or support.
    pub(crate) moves: u64,
    /// Changes of angle and twist in the last step (rad); initial guess for the next step.
    pub(crate) last_turn: (f64, f64),
}

/// Ground truth of one finger.
#[derive(Debug, Clone, PartialEq)]
pub struct FingerState {
    /// State of the finger's joints.
    pub joints: Joints,
    /// Pose of the fingertip in W: the dome's centre and the fingertip frame `T`.
    pub tip: Pose,
    /// Prescribed pose of the fingertip, or `None` if it follows the joints.
    pub held_at: Option<Pose>,
    /// `true` if the last step did not update the fingertip's pose, as it cannot touch anything.
    pub(crate) is_left: bool,
    /// Feelers in contact.
    pub contacts: Contacts,
    /// Pose of the fingertip in each object's frame, for the object's current pose.
    pub(crate) seen: Vec<Pose>,
    /// Rotation of the fingertip in each object's frame up to which the anchors have been updated for rolling.
    pub(crate) rolled: Vec<DMat3>,
    /// Creep displacement (*set*) of each feeler that relaxes, in the fingertip frame `T` (m).
    pub sets: Vec<DVec3>,
    /// Force of each feeler on the object that it touches, in W (N).
    pub forces: Vec<DVec3>,
    /// Distance that each feeler's tip has slipped since the start, without rolling (m).
    pub slipped: Vec<f64>,
    /// Energy dissipated by friction in slips (J).
    pub slip_work: f64,
    /// Bounds that avoid most distance queries of free feelers.
    pub(crate) watch: Watch,
}

/// Conservative advancement of a fingertip: the distance travelled, and the lower bound of the travelled distance at
/// which each free feeler can make contact (its time of impact, measured in distance).
///
/// The distance of a tip from a surface changes no faster than the tip moves relative to it. A feeler that was 5 mm
/// away needs no query before the fingertip has moved by 5 mm.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Watch {
    /// Pose of the fingertip in each object's frame at the last update.
    pub seen: Vec<Pose>,
    /// Upper bound of the distance that any tip has travelled relative to any object (m).
    pub travelled: f64,
    /// Travelled distance before which each feeler cannot make contact (m); its distance is queried again then.
    /// Infinite while it touches, and for the padding of the last group.
    pub due: Vec<f64>,
    /// Minimum of `due` (m).
    pub soonest: f64,
    /// Upper bound of the distance that any tip has travelled since the last update (m).
    pub unseen: f64,
    /// Sum of [`ObjectState::moves`] over all objects at the last update; shows if an object has moved since.
    pub moves: u64,
}

impl FingerState {
    /// Returns `true` if any feeler of the finger touches `object`.
    #[inline(always)]
    pub(crate) fn touches(&self, object: usize) -> bool {
        !self.contacts.on(object).is_empty()
    }
}

impl State {
    /// The world at time 0: fingers at rest at `joints` (rad, one vector per finger), objects at their start poses.
    pub fn new(model: &WorldModel, joints: &[JointVector]) -> Self {
        let objects: Vec<_> = model.objects.iter().map(ObjectState::new).collect();
        let fingers = model.fingers.iter().zip(joints).map(|(finger, &theta)| {
            let (position, rotation) = fingertip_pose(&finger.geometry, theta);
            let tip = Pose { position, rotation };
            let elements = finger.normals.len();
            let mut due = vec![0.0; elements];
            due.resize(elements.next_multiple_of(GROUP), f64::INFINITY);
            let seen: Vec<_> = objects.iter().map(|o| tip.relative_to(&o.pose)).collect();
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

    /// Energy dissipated by friction in the slips of all feelers (J).
    pub fn slip_work(&self) -> f64 {
        self.fingers.iter().map(|finger| finger.slip_work).sum()
    }

    /// Total torque of the objects on the torque sensor (N·m).
    pub fn torque_on_sensor(&self, model: &WorldModel) -> f64 {
        let objects = self.objects.iter().zip(&model.objects);
        objects
            .filter(|(_, object)| matches!(&object.motion, Motion::Turns(h) if h.on_torque_sensor))
            .map(|(state, _)| state.turn.torque)
            .sum()
    }
}

impl ObjectState {
    fn new(object: &crate::objects::object::Object) -> Self {
        Self {
            pose: object.start,
            turn: Turn::default(),
            velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
            outside: (DVec3::ZERO, DVec3::ZERO),
            pull: DVec3::ZERO,
            mass: object.mass().unwrap_or(0.0),
            friction_factor: 1.0,
            moves: 0,
            last_turn: (0.0, 0.0),
        }
    }

    /// Sets the pose of an object that was moved by its hinge, thread or support, and counts the motion.
    pub(crate) fn move_to(&mut self, pose: Pose) {
        self.moves += u64::from(pose != self.pose);
        self.pose = pose;
    }
}
