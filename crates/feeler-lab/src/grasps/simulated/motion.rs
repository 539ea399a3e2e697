//! Motion of two fingers that grasp an object: close, lift, shake and, in some grasps, open.

use super::scenario::Scenario;
use feeler_sim::objects::Pose;
use feeler_sim::world::World;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Initial distance of each finger from the object (m).
const GAP: f64 = 0.002;
/// Closing speed of each finger (m/s).
const CLOSING: f64 = 0.01;
/// Maximum indentation relative to the thickness of the gel.
const DEEPEST: f64 = 0.7;
/// Waiting time before lifting (s).
const REST: f64 = 0.3;
/// Duration of the opening of the fingers (s).
const OPENING: f64 = 1.0;
/// Duration of a tug (s).
const TUG: f64 = 1.0;

/// A hand of two fingers that face each other along the x axis of the hand.
pub struct Hand<'a> {
    scenario: &'a Scenario,
    /// Initial position of the hand's centre (m, in W).
    start: DVec3,
    /// Distance from the origin of a fingertip to its surface (m).
    reach: f64,
    /// Half the distance between the pads (m).
    half_gap: f64,
    /// Value of `half_gap` at first contact (m).
    touched: Option<f64>,
    /// Indentation (m) and time (s) at which the full grip was reached.
    gripped: Option<(f64, f64)>,
    /// Point of the object between the fingertips when lifting began (m, in the object's frame).
    held: Option<DVec3>,
}

impl<'a> Hand<'a> {
    /// Creates a hand around an object with its centre at `middle` (m, in W). `reach` is the distance from a
    /// fingertip's origin to its surface (m).
    pub fn new(scenario: &'a Scenario, middle: DVec3, reach: f64) -> Self {
        let [along, up] = scenario.off_centre;
        Self {
            start: middle + DVec3::new(0.0, along, up),
            half_gap: scenario.half_width + GAP,
            touched: None,
            gripped: None,
            held: None,
            scenario,
            reach,
        }
    }

    /// Advances by one step of `world`. `object` is the index of the object.
    pub fn advance(&mut self, world: &mut World, object: usize) {
        let time = world.state().time;
        self.close(world, time);
        let frame = self.frame(time);
        for finger in 0..2 {
            world.hold_fingertip(finger, Some(self.fingertip(finger, &frame, time)));
        }
        let pose = world.state().objects[object].pose;
        if self.held.is_none() && self.lifting(time) > 0.0 {
            self.held = Some(pose.rotation.transpose() * (frame.position - pose.position));
        }
        if let Some((force, from)) = self.scenario.tug {
            let strength = (PI * ((time - from) / TUG).clamp(0.0, 1.0)).sin();
            world.push(object, strength * force, pose.position);
        }
    }

    /// Displacement of the object along the pads since it was lifted (m).
    pub fn slid(&self, world: &World, object: usize) -> f64 {
        let frame = self.frame(world.state().time);
        self.held.map_or(0.0, |held| {
            let now = world.state().objects[object].pose.to_world(held);
            let off = frame.rotation.transpose() * (now - frame.position);
            DVec2::new(off.y, off.z).length()
        })
    }

    fn close(&mut self, world: &World, time: f64) {
        if self.gripped.is_some() {
            return;
        }
        let force = world.compressions(0).sum::<f64>();
        if force > 0.0 && self.touched.is_none() {
            self.touched = Some(self.half_gap);
        }
        let pressed = self.touched.map_or(0.0, |touched| touched - self.half_gap);
        let deepest = DEEPEST * self.scenario.gel.thickness;
        match force >= self.scenario.grip_force || pressed >= deepest {
            true => self.gripped = Some((pressed, time)),
            false => self.half_gap -= CLOSING * world.model().step,
        }
    }

    /// Time since lifting began (s); negative before.
    fn lifting(&self, time: f64) -> f64 {
        self.gripped
            .map_or(-1.0, |(_, gripped)| time - gripped - REST)
    }

    /// Returns the pose of the hand in W at `time` (s).
    fn frame(&self, time: f64) -> Pose {
        let (way, duration) = self.scenario.lift;
        let mut position = self.start + way * smooth(self.lifting(time) / duration) * DVec3::Z;
        let mut turn = 0.0;
        if let Some(shake) = &self.scenario.shake {
            let part = ((time - shake.from) / shake.duration).clamp(0.0, 1.0);
            let swing = (PI * part).sin() * (TAU * shake.frequency * (time - shake.from)).sin();
            position += swing * shake.way;
            turn = swing * shake.turn;
        }
        Pose {
            position,
            rotation: DMat3::from_rotation_z(turn),
        }
    }

    fn fingertip(&self, finger: usize, frame: &Pose, time: f64) -> Pose {
        let opened = match (self.scenario.loosen, self.gripped) {
            (Some((part, from)), Some((pressed, _))) => {
                part * pressed * smooth((time - from) / OPENING)
            }
            _ => 0.0,
        };
        let facing = DMat3::from_rotation_z(PI * finger as f64);
        let away = -(self.half_gap + opened + self.reach);
        Pose {
            position: frame.to_world(facing * (away * DVec3::X)),
            rotation: frame.rotation * facing,
        }
    }
}

/// Smooth step from 0 to 1 with zero velocity and acceleration at both ends.
fn smooth(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * part * (10.0 + part * (6.0 * part - 15.0))
}
