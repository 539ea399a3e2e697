//! What two fingers do with an object: close on it, lift it, shake it, and let it go, some of them.

use super::scenario::Scenario;
use feeler_sim::pose::Pose;
use feeler_sim::world::World;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Distance of each finger from the object at the start, m, and how fast it closes, m/s.
const GAP: f64 = 0.002;
const CLOSING: f64 = 0.01;
/// Share of the gel's thickness beyond which a finger does not press in, and what it waits before it lifts, s.
const DEEPEST: f64 = 0.7;
const REST: f64 = 0.3;
/// How long fingers take to open, and a tug to swell and ebb, s.
const OPENING: f64 = 1.0;
const TUG: f64 = 1.0;

/// A hand of two fingers that face each other along its x axis.
pub struct Hand<'a> {
    scenario: &'a Scenario,
    /// Where its middle is at the start, m in W.
    start: DVec3,
    /// From a fingertip's origin to what of it touches first, m.
    reach: f64,
    /// Half the distance between both pads, m.
    half_gap: f64,
    /// The same when a pad first touched, and when it had pressed in enough.
    touched: Option<f64>,
    gripped: Option<(f64, f64)>,
    /// The point of the object that was between the fingertips when they began to lift, m in its frame.
    held: Option<DVec3>,
}

impl<'a> Hand<'a> {
    /// A hand about an object whose middle is at `middle`, m in W; of fingertips that `reach` so far, m.
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

    /// Moves on by one step of `world`, in which the object has this number.
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

    /// How far the object has slid along the pads since it was lifted, m.
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

    /// Time since it began to lift, s; negative before.
    fn lifting(&self, time: f64) -> f64 {
        self.gripped
            .map_or(-1.0, |(_, gripped)| time - gripped - REST)
    }

    /// Where its middle is, and how it is turned.
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

/// From 0 to 1 with neither speed nor acceleration at either end.
fn smooth(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * part * (10.0 + part * (6.0 * part - 15.0))
}
