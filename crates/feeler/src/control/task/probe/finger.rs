//! One finger of the probing routine.

use super::config::ProbeConfig;
use super::step::Step;
use crate::control::sense::FingerReadings;
use crate::control::stop_reason::StopReason;
use crate::control::task::homing::homeward;
use crate::control::task::screw::FingerPathConfig;
use crate::control::task::search::check_search;
use glam::DVec3;

/// Number of places that are probed.
pub(super) const PLACES: u32 = 3;
/// Displacement while the elements stick, relative to their depth. The shear force stays below 0.35 of the normal
/// force even if the shear stiffness is close to the normal stiffness.
const SHEAR: f64 = 0.35;
/// Rate of sliding and shearing, in depths per second.
const SLIDE_RATE: f64 = 5.0;
/// Maximum duration of sliding at one place (s).
const LONGEST_SLIDE: f64 = 2.5;
/// Gain of force control while a finger slides (1/s).
const FORCE_RATE: f64 = 2.0;
/// Maximum distance from a place at which a finger counts as there (m).
const TOLERANCE: f64 = 0.0002;
/// Number of consecutive control steps without enough force after which a finger has lost the object.
const LOST: u32 = 20;

/// State of one finger: its rectangle, measurements of the contact, and the start of its step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Finger {
    home: DVec3,
    /// Unit vectors (in W): towards the object, along the stroke, and along the object's axis.
    approach: DVec3,
    stroke: DVec3,
    axis: DVec3,
    /// Distance along the stroke from home to the middle place (m).
    middle: f64,
    /// Sign of the places along the stroke. Neighbouring fingers probe on the same side, so that their torques
    /// cancel.
    side: f64,
    /// Largest `F_z` (N), now and at first touch.
    force: f64,
    touch_force: f64,
    /// Distance from home towards the object at the first touch of this place (m).
    touched_at: Option<f64>,
    /// Contact stiffness along the approach from the first press (N/m).
    stiffness: f64,
    /// Position at the start of the step (m, in W).
    from: DVec3,
    /// `true` if the finger has completed the step.
    through: bool,
    /// Number of consecutive control steps with too little force.
    weak: u32,
}

impl Finger {
    /// Creates the finger `index` at home; `centre` is the mean of all homes (m, in W).
    pub fn new(index: usize, path: &FingerPathConfig, centre: DVec3) -> Self {
        let home = DVec3::from_array(path.home);
        let approach = DVec3::from_array(path.approach).normalize_or_zero();
        let stroke = DVec3::from_array(path.stroke)
            .reject_from_normalized(approach)
            .normalize_or_zero();
        Self {
            home,
            approach,
            stroke,
            axis: approach.cross(stroke),
            middle: (centre - home).dot(stroke),
            side: if index.is_multiple_of(2) { 1.0 } else { -1.0 },
            force: 0.0,
            touch_force: 0.0,
            touched_at: None,
            stiffness: 0.0,
            from: home,
            through: false,
            weak: 0,
        }
    }

    /// Updates the finger with its readings, `elapsed` seconds after `step` began at `place`.
    ///
    /// # Errors
    /// If the finger `index` finds no object to press, or loses it.
    pub fn advance(
        &mut self,
        index: usize,
        step: Step,
        place: u32,
        elapsed: f64,
        sense: &FingerReadings<'_>,
        config: &ProbeConfig,
    ) -> Result<(), StopReason> {
        let forces = sense.touch.frame.forces.iter();
        self.force = forces.fold(0.0, |most, force| most.max(force.z));
        if matches!(step, Step::Approach | Step::Press | Step::PressFast) {
            let travel = self.approached(sense.pose.position);
            check_search(index, travel, config.search_limit)?;
        }
        let sticks_or_slides = matches!(step, Step::Shear | Step::ShearBack | Step::Slide);
        let weak = sticks_or_slides && self.force < 0.5 * self.slide_force(config);
        self.weak = if weak { self.weak + 1 } else { 0 };
        if self.weak >= LOST {
            return Err(StopReason::ContactLost { finger: index });
        }
        self.through |= self.has_reached(step, place, elapsed, sense, config);
        Ok(())
    }

    /// Returns whether the finger has completed the step.
    pub fn is_through(&self) -> bool {
        self.through
    }

    /// Distance from home towards the object (m).
    fn approached(&self, position: DVec3) -> f64 {
        (position - self.home).dot(self.approach)
    }

    /// Force at which the finger slides (N).
    fn slide_force(&self, config: &ProbeConfig) -> f64 {
        config.slide_force.min(self.stiffness * config.slide_depth)
    }

    /// Begins a step at `position` (m, in W).
    pub fn begin(&mut self, step: Step, position: DVec3) {
        self.from = position;
        self.through = false;
        if step == Step::Press {
            self.touched_at = Some(self.approached(position));
            self.touch_force = self.force;
        } else if step == Step::Release {
            let depth = self.approached(position) - self.touched_at.unwrap_or(0.0);
            self.stiffness = (self.force - self.touch_force) / depth.max(1e-5);
        }
    }

    /// Position off the object at which the finger waits before it touches at `place` (m, in W).
    fn waiting_place(&self, place: u32, config: &ProbeConfig) -> DVec3 {
        let offset = self.side * (f64::from(place) - 0.5 * f64::from(PLACES - 1)) * config.spacing;
        let near = self
            .touched_at
            .map_or(0.0, |at| (at - config.clearance).max(0.0));
        self.home + (self.middle + offset) * self.stroke + near * self.approach
    }

    /// Displacement of a shear that sticks (m).
    fn shear(&self, config: &ProbeConfig) -> f64 {
        SHEAR * config.press_force / self.stiffness.max(1.0)
    }

    /// Depth to which an element is pressed in for the sliding test (m).
    fn slide_depth(&self, config: &ProbeConfig) -> f64 {
        self.slide_force(config) / self.stiffness.max(1.0)
    }

    /// Returns whether the finger has reached the end of `step`, after `elapsed` seconds.
    fn has_reached(
        &self,
        step: Step,
        place: u32,
        elapsed: f64,
        finger: &FingerReadings<'_>,
        config: &ProbeConfig,
    ) -> bool {
        let position = finger.pose.position;
        let sheared = (position - self.from).dot(self.axis).abs();
        match step {
            Step::Travel => position.distance(self.waiting_place(place, config)) <= TOLERANCE,
            Step::Approach => finger.flags().touch,
            Step::Press | Step::PressFast => {
                self.force >= config.press_force || finger.flags().over
            }
            Step::Release | Step::Ease => self.force <= self.slide_force(config),
            Step::Shear | Step::ShearBack => sheared >= self.shear(config),
            Step::Slide => sheared >= config.slide_travel || elapsed >= LONGEST_SLIDE,
            Step::Retract => {
                let touched = self.touched_at.unwrap_or(0.0);
                self.approached(position) <= (touched - config.clearance).max(0.0)
            }
            Step::Home => position.distance(self.home) <= TOLERANCE,
            Step::Rest | Step::Done => true,
        }
    }

    /// Velocity in `step` at `place` (m/s, in W); zero once the finger has completed the step.
    pub fn velocity(&self, step: Step, place: u32, position: DVec3, config: &ProbeConfig) -> DVec3 {
        if self.through {
            return DVec3::ZERO;
        }
        let direction = if place.is_multiple_of(2) { 1.0 } else { -1.0 };
        let waiting = self.waiting_place(place, config);
        let back = homeward(self.from - position, config.press_speed);
        // The step determines the motion along the approach; across it, the finger keeps its line.
        let across = back.reject_from_normalized(self.approach);
        let along = |speed: f64| speed * self.approach + across;
        let shear =
            |rate: f64| direction * rate * self.axis + back.reject_from_normalized(self.axis);
        match step {
            Step::Travel => homeward(waiting - position, config.return_speed),
            Step::Approach => along(config.search_speed),
            Step::Press => along(config.press_speed),
            Step::Release => along(-config.press_speed),
            Step::PressFast => along(2.0 * config.press_speed),
            Step::Ease => along(-2.0 * config.press_speed),
            Step::Shear => shear(SLIDE_RATE * self.shear(config)),
            Step::ShearBack => shear(-SLIDE_RATE * self.shear(config)),
            Step::Slide => self.slide(direction, position, config),
            Step::Retract => along(-config.return_speed),
            Step::Home => homeward(self.home - position, config.return_speed),
            Step::Rest | Step::Done => DVec3::ZERO,
        }
    }

    /// Slides along the object's axis with a regulated force.
    fn slide(&self, direction: f64, position: DVec3, config: &ProbeConfig) -> DVec3 {
        let missing = self.slide_force(config) - self.force;
        let press = (FORCE_RATE * missing / self.stiffness.max(1.0))
            .clamp(-config.press_speed, config.press_speed);
        let stray = (self.from - position).dot(self.stroke);
        let back = homeward(stray * self.stroke, config.press_speed);
        direction * SLIDE_RATE * self.slide_depth(config) * self.axis + press * self.approach + back
    }

    /// Unit vector towards the object, in W.
    pub fn towards_object(&self) -> DVec3 {
        self.approach
    }
}
