//! What never changes in a run: the rig's geometry and material, as this run's seed made them.

use super::cap::CapConfig;
use super::config::SimConfig;
use super::feeler::FeelerConfig;
use super::object::Object;
use super::random::{Purpose, generator, uniform};
use super::servo::ServoConfig;
use super::torque_sensor::TorqueSensorConfig;
use crate::hand::finger::FingerGeometry;
use crate::sensor::layout::ElementLayout;
use glam::DVec3;
use std::f64::consts::TAU;

/// The rig of one run.
pub struct Model {
    /// Time step, s.
    pub step: f64,
    /// The feelers.
    pub feeler: FeelerConfig,
    /// The cap.
    pub cap: CapConfig,
    /// The cap's shape.
    pub object: Object,
    /// Rotation of the cap's frame at the start of the run, rad.
    pub cap_start_angle: f64,
    /// The torque sensor.
    pub torque_sensor: TorqueSensorConfig,
    /// The drives.
    pub servo: ServoConfig,
    /// The fingers.
    pub fingers: Vec<FingerGeometry>,
    /// Where the elements are on every fingertip.
    pub layout: ElementLayout,
    /// Outward normals of the elements in the fingertip frame `T`.
    pub normals: Vec<DVec3>,
    /// Part of a joint's velocity error left after one step.
    pub servo_remaining_error: f64,
    /// Part of the way to a new torque that the sensor's low-pass goes in one step.
    pub torque_low_pass_gain: f64,
}

impl Model {
    /// The rig of `config`, varied as `seed` says.
    pub fn new(
        config: &SimConfig,
        fingers: Vec<FingerGeometry>,
        layout: ElementLayout,
        seed: u64,
    ) -> Self {
        let mut random = generator(seed, Purpose::Variation);
        let mut cap = config.cap.clone();
        let mut feeler = config.feeler.clone();
        let variation = &config.variation;
        cap.position[0] += uniform(&mut random, variation.bottle_position);
        cap.position[1] += uniform(&mut random, variation.bottle_position);
        let friction = 1.0 + uniform(&mut random, variation.friction);
        feeler.static_friction *= friction;
        feeler.kinetic_friction *= friction;
        cap.seat_angle *= 1.0 + uniform(&mut random, variation.seat_angle);
        let cap_start_angle = uniform(&mut random, variation.cap_angle).rem_euclid(TAU);
        Self {
            step: config.step,
            object: Object::cylinder(cap.radius, cap.height),
            servo_remaining_error: config.servo.remaining_error(config.step),
            torque_low_pass_gain: config.torque_sensor.low_pass_gain(config.step),
            normals: layout.elements.iter().map(|e| e.normal()).collect(),
            torque_sensor: config.torque_sensor.clone(),
            servo: config.servo.clone(),
            feeler,
            cap,
            cap_start_angle,
            fingers,
            layout,
        }
    }
}
