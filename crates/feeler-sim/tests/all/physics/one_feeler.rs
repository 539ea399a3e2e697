//! A fingertip with a single feeler in front of a flat face, at poses set by the test.

use crate::rig;
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig, RingConfig};
use feeler_sim::contact::FeelerConfig;
use feeler_sim::objects::Pose;
use feeler_sim::world::{SimConfig, World};
use glam::{DMat3, DVec3};
use std::path::Path;

/// Physics step (s).
pub const STEP: f64 = 0.001;
const DOME_RADIUS: f64 = 0.018;

/// A world with one feeler that points along x of W.
pub struct OneFeeler {
    pub world: World,
    pub feeler: FeelerConfig,
    /// Position of the object's face along x (m).
    face: f64,
}

impl OneFeeler {
    /// Creates the reference rig, modified by `change` and without variation, with the object's face at `face` (m)
    /// along x.
    pub fn new(face: f64, change: impl FnOnce(&mut SimConfig)) -> Self {
        let mut sim = rig::sim();
        sim.step = STEP;
        sim.variation.bottle_position = 0.0;
        sim.variation.friction = 0.0;
        sim.variation.seat_angle = 0.0;
        sim.variation.cap_angle = 0.0;
        (sim.feeler.static_friction, sim.feeler.kinetic_friction) = (10.0, 10.0);
        change(&mut sim);
        let layout = ElementLayout::new(&LayoutConfig {
            dome_radius: DOME_RADIUS,
            rings: vec![RingConfig {
                elements: 1,
                polar_angle_deg: 0.0,
            }],
            grid: None,
        });
        let (finger, _) = rig::fingers(1).remove(0);
        let joints = [[0.0, 1.0, -1.0].into()];
        let fingers = [(finger, layout)];
        let world = World::new(&sim, &fingers, &joints, Path::new(""), 0).expect("a world");
        Self {
            world,
            feeler: sim.feeler,
            face,
        }
    }

    /// Performs one step to a tip `depth` (m) behind the face and `aside` (m, in W) from the axis.
    ///
    /// Returns the force on the object (N, in W).
    pub fn press(&mut self, depth: f64, aside: DVec3) -> DVec3 {
        let reach = DOME_RADIUS + self.feeler.tip_radius;
        self.world.hold_fingertip(
            0,
            Some(Pose {
                position: (self.face + depth - reach) * DVec3::X + aside,
                rotation: DMat3::IDENTITY,
            }),
        );
        self.world.step().expect("a step");
        self.world.state().fingers[0].forces[0]
    }
}
