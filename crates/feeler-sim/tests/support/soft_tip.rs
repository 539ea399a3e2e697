//! A soft tip on a rigid plate, under a prescribed motion: the scene of `benches/peers/soft_tip/scene.py`.
//!
//! The fingertip's axis (x of `T`) points down. The elements' stiffness is fitted to an elastic half-space at one depth.

use crate::experiment_file::read;
use feeler::hand::{FingerConfig, FingerGeometry, JointVector};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig, RingConfig};
use feeler_sim::contact::FeelerConfig;
use feeler_sim::objects::{MotionConfig, ObjectConfig, Pose};
use feeler_sim::shapes::shape::ShapeConfig;
use feeler_sim::world::{SimConfig, World};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;
use std::path::Path;

/// Radius of the spherical end (m).
pub const RADIUS: f64 = 0.010;
/// Young's modulus (Pa) and Poisson's ratio of the half-space.
const YOUNG: f64 = 2e5;
const POISSON: f64 = 0.4;
/// Friction coefficient of tip and plate, static and kinetic.
pub const FRICTION: f64 = 0.8;
/// Depth at which the stiffness is fitted, and the largest of the scene (m).
pub const DEPTH: f64 = 1e-3;
/// Radius of an element's tip (m). Its effect cancels in this scene, because a tip does not roll about its normal.
const TIP_RADIUS: f64 = 5e-4;

/// Distance of two rings of the dense layout (deg).
const APART: f64 = 2.32;

/// 479 elements, 0.4 mm apart, up to 28 degrees from the apex.
pub fn dense_layout() -> LayoutConfig {
    let ring = |j: usize| {
        let polar_angle_deg = APART * j as f64;
        let around = TAU * polar_angle_deg.to_radians().sin() / APART.to_radians();
        RingConfig {
            elements: around.round().max(1.0) as usize,
            polar_angle_deg,
        }
    };
    LayoutConfig {
        dome_radius: RADIUS,
        rings: (0..13).map(ring).collect(),
        grid: None,
    }
}

/// The reference fingertip's rings of 1, 8, 12 and 20 elements on a dome of this radius.
pub fn reference_layout() -> LayoutConfig {
    LayoutConfig {
        dome_radius: RADIUS,
        ..LayoutConfig::default()
    }
}

/// Hertz's force at `depth` (N).
pub fn hertz_force(depth: f64) -> f64 {
    4.0 / 3.0 * YOUNG / (1.0 - POISSON * POISSON) * RADIUS.sqrt() * depth.powf(1.5)
}

/// Tangential stiffness 8 a G / (2 - nu) without slip at `depth` (N/m).
pub fn shear_stiffness(depth: f64) -> f64 {
    let modulus = YOUNG / (2.0 * (1.0 + POISSON));
    8.0 * (RADIUS * depth).sqrt() * modulus / (2.0 - POISSON)
}

/// Normal and shear stiffness per element (N/m) for which normal force and tangential stiffness at [`DEPTH`] are those of
/// the half-space, while all elements stick: two linear equations.
pub fn fitted_stiffness(layout: &ElementLayout) -> [f64; 2] {
    let (mut normal, mut shear) = ([0.0; 2], [0.0; 2]);
    for element in &layout.elements {
        let cos2 = element.normal().x.powi(2);
        let depth = DEPTH - RADIUS * (1.0 - element.normal().x);
        if depth > 0.0 {
            normal[0] += cos2 * depth;
            normal[1] += (1.0 - cos2) * depth;
            shear[0] += 0.5 * (1.0 - cos2);
            shear[1] += 0.5 * (1.0 + cos2);
        }
    }
    let (load, slope) = (hertz_force(DEPTH), shear_stiffness(DEPTH));
    let determinant = normal[0] * shear[1] - normal[1] * shear[0];
    [
        (load * shear[1] - slope * normal[1]) / determinant,
        (slope * normal[0] - load * shear[0]) / determinant,
    ]
}

/// Readings of one instant; forces act on the plate by the tip.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    /// Force on the plate (N) and moment about the tip's axis (N·m).
    pub force: DVec3,
    pub moment: f64,
    /// Sum of the elements' forces (N).
    pub elements: DVec3,
    /// Largest distance of a touching element from the tip's axis (m).
    pub radius: f64,
}

/// The simulated scene.
pub struct SoftTip {
    pub world: World,
    pub layout: ElementLayout,
    pose: Pose,
}

impl SoftTip {
    /// Elements of the [fitted stiffness](fitted_stiffness), and physics steps of `step` seconds.
    pub fn new(layout: &LayoutConfig, step: f64) -> Self {
        let layout = ElementLayout::new(layout);
        let stiffness = fitted_stiffness(&layout);
        Self::with_stiffness(layout, stiffness, step)
    }

    /// Elements of this normal and shear `stiffness` (N/m).
    pub fn with_stiffness(layout: ElementLayout, stiffness: [f64; 2], step: f64) -> Self {
        let [normal_stiffness, shear_stiffness] = stiffness;
        let mut sim: SimConfig = read("experiments/cap-closing.toml", "sim");
        sim.step = step;
        sim.variation.friction = 0.0;
        sim.feeler = FeelerConfig {
            normal_stiffness,
            shear_stiffness,
            tip_radius: TIP_RADIUS,
            static_friction: FRICTION,
            kinetic_friction: FRICTION,
            ..FeelerConfig::default()
        };
        let size = [0.1, 0.1, 0.02];
        let plate = ObjectConfig {
            shape: ShapeConfig::Box { size },
            motion: MotionConfig::Fixed,
            position: [0.0, 0.0, -0.5 * size[2]],
            orientation_deg: [0.0; 3],
            offset: [0.0; 3],
            friction: None,
        };
        sim.object = [("plate".to_string(), plate)].into();
        // The finger is far away until the fingertip is held.
        let geometry = FingerGeometry::new(&FingerConfig {
            base_position: [0.0, 0.0, 0.5],
            phi1_deg: 0.0,
            phi2_deg: 0.0,
            links: [0.030, 0.060, 0.055],
            joint_lower_deg: [-180.0; 3],
            joint_upper_deg: [180.0; 3],
            joint_speed_limit: [10.0; 3],
        });
        let fingers = [(geometry.expect("a finger"), layout.clone())];
        let world = World::new(&sim, &fingers, &[JointVector::zeros(3)], Path::new(""), 0);
        Self {
            world: world.expect("a world"),
            layout,
            pose: Self::pose(0.0, 0.0, 0.0),
        }
    }

    /// Performs one step that ends at this depth and travel along x (m) and turn about the plate's normal (rad).
    pub fn advance(&mut self, depth: f64, travel: f64, turn: f64) {
        self.pose = Self::pose(depth, travel, turn);
        self.world.hold_fingertip(0, Some(self.pose));
        self.world.step().expect("a step");
    }

    fn pose(depth: f64, travel: f64, turn: f64) -> Pose {
        let down = DMat3::from_cols(DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y);
        Pose {
            position: DVec3::new(travel, 0.0, RADIUS + TIP_RADIUS - depth),
            rotation: DMat3::from_rotation_z(turn) * down,
        }
    }

    /// Forces on the elements by the plate (N), in `E_i`.
    pub fn forces(&self) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; self.layout.elements.len()];
        self.world.element_forces(0, &mut forces);
        forces
    }

    pub fn read(&self) -> Reading {
        let (force, torque) = self.world.wrench(0);
        let forces = self.forces();
        let pairs = self.layout.elements.iter().zip(&forces);
        let on_tip: DVec3 = pairs.map(|(e, &f)| e.force_on_fingertip(f)).sum();
        let axis = self.pose.position;
        let contacts = self.world.state().fingers[0].contacts.iter();
        let radius = contacts.map(|contact| {
            let tip = self.pose.rotation * self.layout.tip(contact.element);
            tip.truncate().length()
        });
        Reading {
            force,
            // The object's frame is at the plate's centre; the moment is that about the tip's axis.
            moment: torque.z - (axis.x * force.y - axis.y * force.x),
            elements: -(self.pose.rotation * on_tip),
            radius: radius.fold(0.0, f64::max),
        }
    }
}
