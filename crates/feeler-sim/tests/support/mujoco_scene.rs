//! Scene of `references/mujoco_cap.py`: two fingertips turn a cap under a motion prescribed over time.

use crate::experiment_file::read;
use feeler::hand::{FingerConfig, FingerGeometry, JointVector, fingertip_pose};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
use feeler_sim::objects::{MotionConfig, Pose, ThreadConfig};
use feeler_sim::shapes::shape::ShapeConfig;
use feeler_sim::world::{SimConfig, World};
use glam::DVec3;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// MuJoCo's results.
#[derive(Deserialize)]
pub struct Reference {
    pub header: Header,
    /// Cap angle (rad) every `sample` seconds.
    pub cap_angle: Vec<f64>,
    /// F_x, F_y, F_z (N) of each element that ever touches, by "finger/element".
    pub forces: BTreeMap<String, Vec<[f64; 3]>>,
}

/// Parameters of the scene and its motion.
#[derive(Deserialize)]
pub struct Header {
    dome_radius: f64,
    tip_radius: f64,
    normal_stiffness: f64,
    shear_stiffness: f64,
    friction: f64,
    cap: Cap,
    links: [f64; 3],
    pub bases: Vec<[f64; 3]>,
    phi1_deg: Vec<f64>,
    pub knot_times: Vec<f64>,
    /// Joint angles (rad) of each finger at each knot.
    knot_joints: Vec<Vec<[f64; 3]>>,
    pub sample: f64,
    /// Time (s) up to which halving MuJoCo's step changes its cap angle by less than 0.5 % of the final one.
    pub converged_until: f64,
}

#[derive(Deserialize)]
struct Cap {
    radius: f64,
    height: f64,
    position: [f64; 3],
    running_torque: f64,
    seat_angle: f64,
    seat_stiffness: f64,
}

impl Header {
    /// Joint angles (rad) of `finger` at `time`.
    pub fn joints(&self, finger: usize, time: f64) -> JointVector {
        let knots = &self.knot_joints[finger];
        let after = self.knot_times.iter().position(|&t| t > time);
        let i = after.unwrap_or(knots.len() - 1) - 1;
        let (from, to) = (self.knot_times[i], self.knot_times[i + 1]);
        let s = ((time - from) / (to - from)).clamp(0.0, 1.0);
        let s = s * s * (3.0 - 2.0 * s);
        JointVector::from(knots[i]) * (1.0 - s) + JointVector::from(knots[i + 1]) * s
    }
}

/// The simulated scene in feeler.
pub struct Scene {
    pub world: World,
    pub fingers: Vec<(FingerGeometry, ElementLayout)>,
}

impl Scene {
    pub fn new(header: &Header, time_step: f64) -> Self {
        let mut sim: SimConfig = read("experiments/cap-closing.toml", "sim");
        sim.step = time_step;
        sim.torque_sensor.stiffness = 1e9;
        sim.variation.bottle_position = 0.0;
        sim.variation.friction = 0.0;
        sim.variation.seat_angle = 0.0;
        sim.feeler.normal_stiffness = header.normal_stiffness;
        sim.feeler.shear_stiffness = header.shear_stiffness;
        sim.feeler.tip_radius = header.tip_radius;
        sim.feeler.static_friction = header.friction;
        sim.feeler.kinetic_friction = header.friction;
        let cap = sim.object.get_mut("cap").expect("a cap");
        cap.position = header.cap.position;
        cap.shape = ShapeConfig::Cylinder {
            radius: header.cap.radius,
            height: header.cap.height,
        };
        cap.motion = MotionConfig::Thread(ThreadConfig {
            running_torque: header.cap.running_torque,
            seat_angle: header.cap.seat_angle,
            seat_stiffness: header.cap.seat_stiffness,
            static_factor: 1.0,
            lead: 0.0,
            fault: None,
        });
        let layout = LayoutConfig::default();
        assert!((layout.dome_radius - header.dome_radius).abs() < 1e-12);
        let fingers = header.bases.iter().zip(&header.phi1_deg);
        let fingers = fingers.map(|(&base_position, &phi1_deg)| {
            let geometry = FingerGeometry::new(&FingerConfig {
                base_position,
                phi1_deg,
                phi2_deg: 0.0,
                links: header.links,
                joint_lower_deg: [-180.0; 3],
                joint_upper_deg: [180.0; 3],
                joint_speed_limit: [10.0; 3],
            });
            (geometry.expect("a finger"), ElementLayout::new(&layout))
        });
        let fingers: Vec<_> = fingers.collect();
        let start: Vec<_> = (0..fingers.len()).map(|f| header.joints(f, 0.0)).collect();
        let world = World::new(&sim, &fingers, &start, Path::new(""), 0).expect("a world");
        Self { world, fingers }
    }

    /// Poses of the fingertips at these joint angles (rad).
    pub fn poses(&self, joints: impl Fn(usize) -> JointVector) -> Vec<Pose> {
        let fingers = self.fingers.iter().enumerate();
        let pose = |(finger, (geometry, _)): (usize, &(FingerGeometry, _))| {
            let (position, rotation) = fingertip_pose(geometry, joints(finger));
            Pose { position, rotation }
        };
        fingers.map(pose).collect()
    }

    /// Performs one step that ends with the fingertips at `poses`.
    pub fn advance(&mut self, poses: &[Pose]) {
        for (finger, &pose) in poses.iter().enumerate() {
            self.world.hold_fingertip(finger, Some(pose));
        }
        self.world.step().expect("a step");
    }

    pub fn cap_angle(&self) -> f64 {
        self.world.state().objects[0].turn.angle
    }

    /// Force (N) in the element's frame: F_x, F_y on the feeler, F_z compression.
    pub fn force(&self, finger: usize, element: usize) -> DVec3 {
        let mut forces = vec![DVec3::ZERO; self.fingers[finger].1.elements.len()];
        self.world.element_forces(finger, &mut forces);
        forces[element]
    }
}

/// Loads the reference called `name`.
pub fn reference(name: &str) -> Reference {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../feeler-sim/tests/references"
    );
    let text = std::fs::read_to_string(format!("{folder}/mujoco_cap_{name}.json"));
    serde_json::from_str(&text.expect("the reference")).expect("a reference")
}
