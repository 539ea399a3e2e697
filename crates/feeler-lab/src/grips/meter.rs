//! Ground truth of a grasp in every step of the physics: grip, required grip, and slip.

use super::object::{GripObject, OBJECT, TABLE, THICKNESS};
use feeler_sim::rig::acceleration;
use feeler_sim::world::{State, WorldModel};
use glam::DVec3;

/// Gap between the object's lowest point and the table above which the object is in the air (m).
const IN_AIR: f64 = 3e-4;
/// Gap between the object's lowest point and the table above which losing the object counts as dropping it (m).
const DROP: f64 = 4e-3;
/// Displacement of the object relative to the fingers above which it counts as dropped (m).
const SLID: f64 = 0.015;
/// Time window in which every touching element of a finger must have slipped for the whole contact to count as slipping
/// (s).
const WHOLE: f64 = 0.01;
/// Minimum time between two slips of a contact (s).
const APART: f64 = 0.1;
/// Relative increase of a finger's force that counts as a reaction to a slip. It is computed from the closing distance,
/// because forces also change without motion of the fingers.
const MORE: f64 = 0.01;
/// Fraction of the grip below which the pressing force of an element is neglected.
const FAINT: f64 = 0.002;
/// Direction in which the fingers close.
const AXIS: DVec3 = DVec3::X;

/// Ground truth of a grasp so far.
#[derive(Debug, Clone)]
pub struct GripMeter {
    object: GripObject,
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
    /// Time from each onset of slip until the fingers have closed to press harder (s); `None` if they did not within a
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
    /// Onset of the slip to which the gripper has not reacted yet.
    onset: Option<Onset>,
}

/// Onset of a slip.
#[derive(Debug, Clone, Copy)]
struct Onset {
    /// Time (s).
    time: f64,
    /// Distance between the fingers at which the gripper has reacted (m).
    reaction_opening: f64,
}

impl GripMeter {
    /// Starts measuring the grasp of `object` by a number of `fingers`.
    pub fn new(object: &GripObject, fingers: usize) -> Self {
        Self {
            object: *object,
            in_air: 0.0,
            grip: 0.0,
            required: 0.0,
            peak: 0.0,
            peak_required: 0.0,
            highest: 0.0,
            slid: 0.0,
            start: None,
            dropped: false,
            fingers: vec![FingerMeter::default(); fingers],
            reactions: Vec::new(),
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
        let lowest = own.pose.position.z - self.object.height_of_centre(&own.pose.rotation);
        let gap = lowest - table.pose.position.z - THICKNESS / 2.0;
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
        let required = load.reject_from_normalized(AXIS).length() / (2.0 * self.object.friction);
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
        self.watch_slip(model, state, pressing, in_air);
    }

    /// Records the onsets of slip, and the reactions to them. A slip of a finger begins when the whole contact slips while
    /// the object is in the air.
    fn watch_slip(&mut self, model: &WorldModel, state: &State, pressing: [f64; 2], in_air: bool) {
        let object = model.object(OBJECT);
        let now = state.time;
        let opening = opening(state);
        let fingers = state.fingers.iter().zip(&mut self.fingers);
        for (((finger, own), model), pressing) in fingers.zip(&model.fingers).zip(pressing) {
            own.update(now, &finger.slipped);
            let contacts = || finger.contacts.iter().filter(|c| Some(c.object) == object);
            let pressing_of = |element: usize| finger.forces[element].dot(AXIS).abs();
            let touching = || contacts().filter(|c| pressing_of(c.element) > FAINT * pressing);
            let slips = pressing > 0.0 && touching().all(|c| now - own.at[c.element] <= WHOLE);
            if let Some(onset) = own.onset {
                let reacted = opening < onset.reaction_opening;
                if reacted || now - onset.time > 1.0 {
                    self.reactions.push(reacted.then_some(now - onset.time));
                    own.onset = None;
                }
            } else if slips && in_air && now - own.whole > APART {
                let stiffness = touching().map(|c| model.feelers[c.element].normal_stiffness);
                let stiffness: f64 = stiffness.sum();
                own.onset = Some(Onset {
                    time: now,
                    // Each finger closes by half of it.
                    reaction_opening: opening - 2.0 * MORE * pressing / stiffness,
                });
            }
            if slips {
                own.whole = now;
            }
        }
    }
}

impl FingerMeter {
    /// Updates the times of the latest slips from the total slip distance of each element (m).
    fn update(&mut self, now: f64, slipped: &[f64]) {
        self.slipped.resize(slipped.len(), 0.0);
        self.at.resize(slipped.len(), f64::NEG_INFINITY);
        for ((before, at), &slipped) in self.slipped.iter_mut().zip(&mut self.at).zip(slipped) {
            if slipped != *before {
                (*before, *at) = (slipped, now);
            }
        }
    }
}

/// Distance between the fingers (m).
fn opening(state: &State) -> f64 {
    let along = state.fingers.iter().map(|f| f.tip.position.dot(AXIS));
    let ends = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    });
    ends[1] - ends[0]
}
