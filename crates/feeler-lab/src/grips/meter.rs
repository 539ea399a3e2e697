//! Ground truth of a grasp in every step of the physics: grip, minimum grip that holds the object, and slip.

use super::object::{GripObject, OBJECT, STANDING, TABLE};
use feeler_sim::rig::acceleration;
use feeler_sim::world::{State, WorldModel};
use glam::DVec3;

/// Gap between object and table from which the object counts as in the air (m).
const IN_AIR: f64 = 3e-4;
/// Gap from which losing the object counts as dropping it (m).
const DROP: f64 = 4e-3;
/// Displacement of the object relative to the fingers from which it counts as dropped (m).
const SLID: f64 = 0.015;
/// Period within which all touching elements of a finger must have slipped for the whole contact to slip (s).
const WHOLE: f64 = 0.01;
/// Minimum time between two slips of a contact (s).
const APART: f64 = 0.1;
/// Relative increase of the grip that counts as more force.
const MORE: f64 = 0.01;
/// Share of the grip below which the pressing force of an element is neglected.
const FAINT: f64 = 0.002;
/// Direction in which the fingers close.
const AXIS: DVec3 = DVec3::X;

/// Ground truth of a grasp so far.
#[derive(Debug, Clone, Default)]
pub struct GripMeter {
    static_friction: f64,
    /// Time in the air (s), and the integrals over it of the grip and of the minimum grip that holds (N s).
    in_air: f64,
    grip: f64,
    least: f64,
    /// Largest force of a finger (N).
    pub peak: f64,
    /// Maximum over time of the minimum grip that holds the object (N).
    pub peak_least: f64,
    /// Maximum height of the object above the table (m).
    pub highest: f64,
    /// Displacement of the object across the grip since it was lifted (m).
    pub slid: f64,
    start: Option<DVec3>,
    /// `true` if the object left the fingers in the air.
    pub dropped: bool,
    fingers: Vec<FingerMeter>,
    /// Reaction times from the onset of a slip to an increase of the grip (s); `None` if it did not rise within a
    /// second.
    pub reactions: Vec<Option<f64>>,
}

/// Slip of one finger.
#[derive(Debug, Clone, Default)]
struct FingerMeter {
    /// Total slip distance of each element at the previous step (m), and the time of its last slip (s).
    slipped: Vec<f64>,
    at: Vec<f64>,
    /// Time of the last step at which the whole contact slipped (s).
    whole: f64,
    /// Latest onset of slip, until the force rises: time (s), and force of the finger then (N).
    onset: Option<(f64, f64)>,
}

impl GripMeter {
    /// Starts measuring the grasp of `object` by a number of `fingers`.
    pub fn new(object: &GripObject, fingers: usize) -> Self {
        Self {
            static_friction: object.friction,
            fingers: vec![FingerMeter::default(); fingers],
            ..Self::default()
        }
    }

    /// Mean grip, and mean of the minimum grip that holds, while the object was in the air (N). NaN if it never was.
    ///
    /// The minimum grip is the load across the grip divided by twice the static friction. It neglects torsion, kinetic
    /// friction and the uneven pressure, so no gripper can reach it.
    pub fn mean_grips(&self) -> [f64; 2] {
        [self.grip / self.in_air, self.least / self.in_air]
    }

    /// Adds the state after a step.
    pub fn observe(&mut self, model: &WorldModel, state: &State) {
        let (Some(object), Some(table)) = (model.object(OBJECT), model.object(TABLE)) else {
            return;
        };
        let (own, table) = (&state.objects[object], &state.objects[table]);
        let gap = own.pose.position.z - table.pose.position.z - STANDING;
        let mut pressing = [0.0; 2];
        let mut touches = false;
        for (finger, pressed) in state.fingers.iter().zip(&mut pressing) {
            for contact in finger.contacts.iter().filter(|c| c.object == object) {
                *pressed += finger.forces[contact.element].dot(AXIS).abs();
                touches = true;
            }
        }
        let grip = (pressing[0] + pressing[1]) / 2.0;
        self.peak = self.peak.max(pressing[0]).max(pressing[1]);
        let in_air = gap > IN_AIR;
        let arm = acceleration(&model.arm, state.time);
        let load = own.mass * (model.gravity - arm) + own.pull;
        let least = load.reject_from_normalized(AXIS).length() / (2.0 * self.static_friction);
        self.peak_least = self.peak_least.max(least);
        if in_air {
            self.in_air += model.step;
            self.grip += grip * model.step;
            self.least += least * model.step;
            self.highest = self.highest.max(gap);
        }
        let start = *self.start.get_or_insert(own.pose.position);
        if touches {
            let slid = (own.pose.position - start).reject_from_normalized(AXIS);
            self.slid = self.slid.max(slid.length());
        }
        self.dropped |= self.slid > SLID || (gap > DROP && !touches);
        self.watch_slip(state, object, pressing, in_air);
    }

    fn watch_slip(&mut self, state: &State, object: usize, pressing: [f64; 2], in_air: bool) {
        let now = state.time;
        let fingers = state.fingers.iter().zip(&mut self.fingers).zip(pressing);
        for ((finger, own), pressing) in fingers {
            own.slipped.resize(finger.slipped.len(), 0.0);
            own.at.resize(finger.slipped.len(), f64::NEG_INFINITY);
            for ((before, at), &slipped) in
                own.slipped.iter_mut().zip(&mut own.at).zip(&finger.slipped)
            {
                if slipped != *before {
                    (*before, *at) = (slipped, now);
                }
            }
            let mut touching = finger.contacts.iter().filter(|c| {
                c.object == object && finger.forces[c.element].dot(AXIS).abs() > FAINT * pressing
            });
            let slips = pressing > 0.0 && touching.all(|c| now - own.at[c.element] <= WHOLE);
            if let Some((onset, force)) = own.onset {
                if pressing > (1.0 + MORE) * force {
                    self.reactions.push(Some(now - onset));
                    own.onset = None;
                } else if now - onset > 1.0 {
                    self.reactions.push(None);
                    own.onset = None;
                }
            } else if slips && in_air && now - own.whole > APART {
                own.onset = Some((now, pressing));
            }
            if slips {
                own.whole = now;
            }
        }
    }
}
