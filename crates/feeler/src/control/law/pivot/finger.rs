//! State of one finger that closes on the object and turns it about the pivot.

mod closing;

use super::circle::{Circle, CircleFit};
use super::course::MovePath;
use super::needed_grip::{NeededGrip, Surface};
use super::stiffness::StiffnessFit;
use super::stroke::{Sample, StrokeParameters, StrokeRecord};
use super::{Grip, PivotConfig};
use crate::control::feeler_shape::Stiffness;
use crate::control::plan::Plan;
use crate::control::sense::FingerReadings;
use crate::sensor::fingertip::layout::ElementLayout;
use glam::{DVec2, DVec3};

/// Compression below which an element's force is treated as noise (N).
const NOISE: f64 = 0.03;
/// Weight of the latest rate of change in its low-pass filter, for the largest element force.
const RATE_FILTER: f64 = 0.5;
/// Lead time for extrapolating the largest element force (s): about one control period plus the drive lag.
const LEAD: f64 = 0.03;
/// Target of the largest element force in the first stroke, as a fraction of F2. The path of that stroke is not
/// evaluated.
const FIRST_FORCE: f64 = 0.95;
/// Gain of the force control in the first stroke (1/s).
const FIRST_GAIN: f64 = 8.0;
/// Element force above which a finger retreats in the first two strokes, as a fraction of F2; the radius has not
/// settled yet.
const EARLY_GUARD: f64 = 1.1;
/// Gain of the retreat from an excessive element force (1/s).
const GUARD_GAIN: f64 = 20.0;
/// Number of strokes after which the radius has settled.
const SETTLED: u32 = 2;
/// Maximum target of the largest element force, as a fraction of F2, until the object resists being turned. From then
/// on, the force rises even on an unchanged path.
const LOOSE_FORCE: f64 = 1.0;

/// Kind of motion that a plan requests of a finger.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// Closing on the object.
    Close,
    /// Turning the object about the pivot.
    Turn,
    /// Any other motion, without force control.
    Free,
}

/// State at the first contact of a closing motion.
#[derive(Debug, Clone, Copy)]
struct Onset {
    /// Position of the dome's centre (m, x and y in W).
    position: DVec2,
    /// Largest element force (N).
    force: f64,
}

/// State of one finger in the law.
#[derive(Debug, Clone)]
pub(super) struct Finger {
    dome_radius: f64,
    /// F1: compression above which an element is in contact (N).
    touch_force: f64,
    stiffness_fit: StiffnessFit,
    /// Contact stiffness estimated from all closing motions so far; `None` before the first one.
    stiffness: Option<Stiffness>,
    motion: Motion,
    /// Sequence number of the latest tactile frame.
    newest: Option<u64>,
    /// Grasp force (N).
    grip: f64,
    /// Largest element force (N).
    force: f64,
    /// Rate of change of the largest element force, low-pass filtered (N/s).
    force_rate: f64,
    frame_stamp: f64,
    /// Position of the dome's centre (m, x and y in W).
    position: DVec2,
    /// Position at which the first closing motion began (m); `None` before it.
    home: Option<DVec2>,
    /// First contact of the latest closing motion.
    onset: Option<Onset>,
    /// First contact of the previous closing motion.
    onset_before: Option<Onset>,
    course: MovePath,
    record: StrokeRecord,
    needed_grip: NeededGrip,
    /// Number of strokes from which parameters for the next stroke were computed.
    strokes: u32,
    lesson: Option<StrokeParameters>,
}

impl Finger {
    /// Creates the state of a finger with the elements of `layout`, which are in contact above `touch_force` (F1, N).
    pub fn new(layout: &ElementLayout, touch_force: f64) -> Self {
        Self {
            dome_radius: layout.dome_radius,
            touch_force,
            stiffness_fit: StiffnessFit::new(layout.elements.len()),
            stiffness: None,
            motion: Motion::Free,
            newest: None,
            grip: 0.0,
            force: 0.0,
            force_rate: 0.0,
            frame_stamp: 0.0,
            position: DVec2::ZERO,
            home: None,
            onset: None,
            onset_before: None,
            course: MovePath::default(),
            record: StrokeRecord::new(),
            needed_grip: NeededGrip::new(touch_force, layout.elements.len()),
            strokes: 0,
            lesson: None,
        }
    }

    /// Position of the dome's centre (m, x and y in W).
    pub fn position(&self) -> DVec2 {
        self.position
    }

    /// Position at which the finger first began to close (m, x and y in W).
    pub fn home(&self) -> DVec2 {
        self.home.unwrap_or(self.position)
    }

    /// Radius of the dome at the tips of the unloaded feelers (m).
    pub fn dome_radius(&self) -> f64 {
        self.dome_radius
    }

    /// Kind of motion that the latest plan requests.
    pub fn motion(&self) -> Motion {
        self.motion
    }

    /// Updates the finger with the latest position and forces. Adds elements in contact to the stiffness fit while
    /// closing, and to `contacts` while turning.
    pub fn feel(&mut self, sense: &FingerReadings<'_>, mut contacts: Option<&mut CircleFit>) {
        self.position = sense.pose.position.truncate();
        let frame = &sense.touch.frame;
        if self.newest.replace(frame.sequence) == Some(frame.sequence) {
            return;
        }
        let before = std::mem::take(&mut self.force);
        self.grip = 0.0;
        for (index, &force) in frame.forces.iter().enumerate() {
            if force.z > NOISE && force.is_finite() {
                self.grip += force.z;
                self.force = self.force.max(force.z);
                self.feel_element(sense, index, force, contacts.as_deref_mut());
            } else {
                self.stiffness_fit.release(index);
            }
        }
        if self.motion == Motion::Close && self.force > self.touch_force {
            self.onset.get_or_insert(Onset {
                position: self.position,
                force: self.force,
            });
        }
        let interval = frame.stamp - std::mem::replace(&mut self.frame_stamp, frame.stamp);
        if interval > 0.0 {
            let rate = (self.force - before) / interval;
            self.force_rate += RATE_FILTER * (rate - self.force_rate);
        }
    }

    /// Predicts the shear forces of the latest frame. Returns the fraction (0 to 1) of the fingertip's motion that the
    /// object may have followed, estimated from this finger alone.
    pub fn foretell_shear(&mut self, sense: &FingerReadings<'_>) -> f64 {
        self.needed_grip.predict_shear(sense)
    }

    /// Updates slip detection and the required grasp force with the latest frame. `along` is the fraction (0 to 1) of
    /// the fingertip's motion that the object has followed.
    pub fn feel_slip(&mut self, sense: &FingerReadings<'_>, circle: Option<Circle>, along: f64) {
        if let (Some(stiffness), Some(circle)) = (self.stiffness, circle) {
            let surface = Surface {
                stiffness,
                pivot: circle.centre,
            };
            let turns = self.motion == Motion::Turn;
            self.needed_grip.feel(sense, surface, turns, along);
        }
    }

    fn feel_element(
        &mut self,
        sense: &FingerReadings<'_>,
        index: usize,
        force: DVec3,
        contacts: Option<&mut CircleFit>,
    ) {
        let Some(element) = sense.layout.elements.get(index) else {
            return;
        };
        let place = || {
            let tip = sense.pose.rotation * sense.layout.tip(index) + sense.pose.position;
            (tip, sense.pose.rotation * element.rotation)
        };
        match (self.motion, self.stiffness, contacts) {
            (Motion::Close, ..) => {
                let (tip, rotation) = place();
                self.stiffness_fit.add(index, tip, rotation, force);
            }
            (Motion::Turn, Some(k), Some(contacts)) if force.z > self.touch_force => {
                let (tip, rotation) = place();
                contacts.add((tip + rotation * k.displacement(force)).truncate());
            }
            _ => {}
        }
    }

    /// Updates the kind of motion from the latest plan. Starts and ends closing motions and strokes.
    pub fn follow(
        &mut self,
        plan: &Plan,
        config: &PivotConfig,
        rated_force: f64,
        circle: Option<Circle>,
    ) {
        let motion = match (plan.keep_grasp, plan.reflex) {
            (true, _) => Motion::Turn,
            (false, true) => Motion::Close,
            (false, false) => Motion::Free,
        };
        let before = std::mem::replace(&mut self.motion, motion);
        if before == motion {
            return;
        }
        if before == Motion::Turn
            && config.grip == Grip::Firm
            && let Some(circle) = circle
        {
            self.learn(config, rated_force, &circle);
        }
        match motion {
            Motion::Close => {
                self.stiffness_fit.start();
                self.onset_before = self.onset.take().or(self.onset_before);
                self.home.get_or_insert(self.position);
            }
            Motion::Turn => {
                self.stiffness = self.stiffness_fit.stiffness();
                if let Some(stiffness) = self.stiffness {
                    self.needed_grip.set_stiffness(stiffness);
                }
                self.record = StrokeRecord::new();
                self.course.start = self.position;
            }
            Motion::Free => {}
        }
    }

    fn learn(&mut self, config: &PivotConfig, rated_force: f64, circle: &Circle) {
        self.course.end = self.position;
        let Some(stiffness) = self.stiffness else {
            return;
        };
        let target = self.next_target(config, rated_force);
        // The radius is still uncertain in the second stroke, so the finger stays on the circle.
        let settled = self.strokes + 1 >= SETTLED;
        let line = if settled {
            self.course.line_deviation(circle)
        } else {
            0.0
        };
        let tolerance = config.path_tolerance * line;
        if let Some(lesson) = self.record.lesson(target, stiffness, tolerance) {
            self.strokes += 1;
            self.lesson = Some(lesson);
        }
    }

    /// Target of the largest element force in the next stroke (N).
    fn next_target(&self, config: &PivotConfig, rated_force: f64) -> f64 {
        let most = if self.record.resisted() {
            f64::INFINITY
        } else {
            LOOSE_FORCE
        };
        config.peak_force.min(most) * rated_force
    }

    /// Velocity of a finger that turns the object (m/s, in W): around the pivot at the planned speed, at the radius
    /// computed from earlier strokes.
    pub fn turn(
        &mut self,
        plan: &Plan,
        config: &PivotConfig,
        rated_force: f64,
        circle: Circle,
        sense: &FingerReadings<'_>,
    ) -> DVec3 {
        let from_pivot = self.position - circle.centre;
        let (radius, outward) = (from_pivot.length(), from_pivot.normalize_or_zero());
        let start = self.course.start - circle.centre;
        let swept = libm::asin(start.normalize_or_zero().perp_dot(outward).abs());
        let speed = plan.velocity.length();
        let planned = plan.velocity.truncate();
        if speed > 0.0 {
            self.course.direction = planned / speed;
        }
        let tangent = planned.reject_from_normalized(outward).normalize_or_zero();
        self.record.add(Sample {
            swept,
            radius,
            grip: self.grip,
            force: self.force,
            tangential: -sense.resultant().truncate().dot(tangent),
        });
        let planned = self
            .lesson
            .map_or(start.length(), |lesson| self.radius(&lesson, &circle));
        let radial = self.radial_speed(config, rated_force, planned - radius);
        (speed * tangent + radial * outward).extend(plan.velocity.z)
    }

    /// Radial speed away from the pivot (m/s) of a finger that is `inside` (m) its circle.
    fn radial_speed(&self, config: &PivotConfig, rated_force: f64, inside: f64) -> f64 {
        let Some(stiffness) = self.stiffness else {
            return config.gain * inside;
        };
        let excess = |share: f64, rate: f64| {
            (self.force + LEAD * rate - share * rated_force) / stiffness.normal
        };
        let wanted = match self.lesson {
            None => {
                let limit = FIRST_GAIN * excess(FIRST_FORCE, self.force_rate);
                match config.grip {
                    Grip::Firm => limit,
                    Grip::AsNeeded => {
                        let depth = self.force / stiffness.normal;
                        self.needed_grip.speed(depth).max(limit)
                    }
                }
            }
            Some(lesson) => {
                let gives = lesson.compliance * (self.grip - lesson.mean_grip);
                config.gain * (inside + gives)
            }
        };
        let guard = if self.strokes < SETTLED {
            EARLY_GUARD.min(config.guard_force)
        } else {
            config.guard_force
        };
        let beyond = excess(guard, self.force_rate.max(0.0));
        if beyond > 0.0 {
            wanted.max(0.0) + GUARD_GAIN * beyond
        } else {
            wanted
        }
    }
}
