//! Worlds with free bodies.

use crate::rig;
use feeler::hand::JointVector;
use feeler_sim::objects::{FreeConfig, MotionConfig, ObjectConfig};
use feeler_sim::shapes::shape::ShapeConfig;
use feeler_sim::world::{SimConfig, World};
use std::path::Path;

pub const GRAVITY: f64 = 9.81;

/// The reference rig without objects and variation.
pub fn empty() -> SimConfig {
    let mut sim = rig::sim();
    sim.object.clear();
    sim.variation.friction = 0.0;
    sim
}

/// A fixed object at the origin.
pub fn fixed(shape: ShapeConfig) -> ObjectConfig {
    ObjectConfig {
        shape,
        motion: MotionConfig::Fixed,
        position: [0.0; 3],
        orientation_deg: [0.0; 3],
        offset: [0.0; 3],
        friction: None,
    }
}

/// A free object with `mass` (kg) and `friction` on fixed objects.
pub fn free(shape: ShapeConfig, mass: f64, friction: f64) -> ObjectConfig {
    ObjectConfig {
        motion: MotionConfig::Free(FreeConfig {
            density: 1000.0,
            mass: Some(mass),
            inertia: None,
            friction,
        }),
        ..fixed(shape)
    }
}

pub fn cuboid(x: f64, y: f64, z: f64) -> ShapeConfig {
    ShapeConfig::Box { size: [x, y, z] }
}

/// A world without fingers.
pub fn world(sim: &SimConfig) -> World {
    World::new(sim, &[], &[], Path::new(""), 0).expect("a world")
}

/// A world with the first `count` reference fingers, whose fingertips the test positions.
pub fn world_with_fingers(sim: &SimConfig, count: usize) -> World {
    let fingers = rig::fingers(count);
    let joints = vec![JointVector::from([0.0, 1.0, -1.0]); count];
    World::new(sim, &fingers, &joints, Path::new(""), 0).expect("a world")
}

pub fn run(world: &mut World, seconds: f64) {
    let steps = (seconds / world.model().step).round() as usize;
    for _ in 0..steps {
        world.step().expect("a step");
    }
}
