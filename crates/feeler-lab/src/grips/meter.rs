//! Ground truth of a grasp in every step of the physics: grip, required grip, and slip.

use super::object::{GripObject, OBJECT, STANDING, TABLE};
use feeler_sim::rig::acceleration;
use feeler_sim::world::{State, WorldModel};
use glam::DVec3;

/// Gap between object and table above which the object is in the air (m).
const IN_AIR: f64 = 3e-4;
/// Gap between object and table above which losing the object counts as dropping it (m).
const DROP: f64 = 4e-3;
/// Displacement of the object relative to the fingers above which it counts as dropped (m).
const SLID: f64 = 0.015;
/// Time window in which every touching element of a finger must have slipped for the whole contact to count as slipping
/// (s).
const WHOLE: f64 = 0.01;
/// Minimum time between two slips of a contact (s).
const APART: f64 = 0.1;
/// Relative increase of a finger's force above which the finger has reacted to a slip.
const MORE: f64 = 0.01;
/// Fraction of the grip below which the pressing force of an element is neglected.
const FAINT: f64 = 0.002;
/// Direction in which the fingers close.
const AXIS: DVec3 = DVec3::X;

/// Ground truth of a grasp so far.
#[derive(Debug, Clone, Default)]
pub struct GripMeter {
    static_friction: f64,
    /// Time for which the object was in the air (s).
    in_air: f64,
    /// Integral of the grip over that time (N s).
    grip: f64,
    /// Integral over that time of the grip that the load requires (N s).
    required: f64,
    /// Largest force of a finger (N).
    pub peak: f64,
    /// Largest grip that the load required (N).
    pub peak_required: f64,
    /// Maximum height of the object above the table (m).
    pub highest: f64,
    /// Displacement of the object across the grip since it was lifted (m).
    pub slid: f64,
    start: Option<DVec3>,
    /// `true` if the object left the fingers in the air.
    pub dropped: bool,
    fingers: Vec<FingerMeter>,
    /// Time from each onset of slip to the increase of the force (s); `None` if the force did not increase within a
    /// second.
    pub reactions: Vec<Option<f64>>,
}

/// Slip of one finger.
#[derive(Debug, Clone, Default)]
struct FingerMeter {
    /// Total slip distance of each element at the previous step (m).
    slipped: Vec<f64>,
    /// Time of the last slip of each element (s).
    at: Vec<f64>,
    /// Time of the last step at which the whole contact slipped (s).
    whole: f64,
    /// Onset of the slip to which the finger has not reacted yet: time (s), and force of the finger (N).
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

    /// Mean grip, and mean of the grip that the load requires, while the object was in the air (N). NaN if it never
    /// was.
    ///
    /// The load requires at least the grip at which static friction of both fingers balances it: the load across the
    /// grip, divided by twice the coefficient of static friction. Torsion, kinetic friction and uneven pressure require
    /// more.
    pub fn mean_grips(&self) -> [f64; 2] {
        [self.grip / self.in_air, self.required / self.in_air]
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
        let required = load.reject_from_normalized(AXIS).length() / (2.0 * self.static_friction);
        self.peak_required = self.peak_required.max(required);
        if in_air {
            self.in_air += model.step;
            self.grip += grip * model.step;
            self.required += required * model.step;
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
