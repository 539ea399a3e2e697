//! Benchmark of slip detectors: a simulated fingertip presses, drags, twists and holds still on a specimen, and the
//! simulator provides the true slip of each feeler in each frame.

use super::{ExperimentError, fingers_at_home, layouts, steps_per_command};
use crate::config::{Experiment, ExperimentConfig};
use feeler::control::{
    FeelerShape, FingerReadings, FingertipPose, FlagAnalyzer, SlipDetector, TactileReading,
};
use feeler::hand::JointState;
use feeler::sensor::fingertip::ElementLayout;
use feeler_sim::contact::Friction;
use feeler_sim::objects::{MotionConfig, ObjectConfig, Pose};
use feeler_sim::random::normal;
use feeler_sim::shapes::ShapeConfig;
use feeler_sim::world::{DirectSensingConfig, SimConfig, World};
use glam::{DMat3, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Names of the evaluated detectors, in the order of a sample's scores.
pub const DETECTORS: [&str; 3] = [
    "shear rate (the paper's)",
    "missing shear, movable objects",
    "missing shear",
];

/// Detector scores and ground truth of one element in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Number of the frame.
    pub frame: u32,
    /// Index of the element.
    pub element: u32,
    /// Ground truth: whether the element slipped since the previous frame.
    pub slipped: bool,
    /// Score of each detector: shear rate (N/s) or missing shear (N).
    pub scores: [f64; DETECTORS.len()],
}

/// Number of motions of a trial after the first press.
const MOTIONS: usize = 5;
/// Range of depths of the fingertip's pole in the specimen (m).
const DEPTH: (f64, f64) = (0.0004, 0.002);
/// Initial distance from the specimen (m).
const GAP: f64 = 0.0002;

/// State of the prescribed motion of the fingertip relative to the specimen.
struct Course {
    /// Point on the specimen's surface under the fingertip (m, in W).
    surface: DVec3,
    frame: DMat3,
    /// Rotation of the fingertip before any twist.
    rotation: DMat3,
    /// Depth of the pole in the surface (m).
    depth: f64,
    /// Drag distances along both tangents (m).
    dragged: [f64; 2],
    /// Twist about the surface normal (rad).
    twist: f64,
}

/// Constant velocities for a duration (s): depth (m/s), along the tangents (m/s), and twist (rad/s).
struct Motion {
    depth: f64,
    drag: [f64; 2],
    twist: f64,
    duration: f64,
}

/// Runs one trial with the fingertip of finger 0 of `experiment`. Samples are taken of elements whose true force in
/// the previous frame was above F1.
///
/// # Errors
/// If a part of the experiment is invalid.
pub fn trial(experiment: &Experiment, seed: u64) -> Result<Vec<Sample>, ExperimentError> {
    let mut random = Pcg64::seed_from_u64(seed);
    let config = &experiment.config;
    let sim = config.simulation()?;
    let steps = steps_per_command(config)?;
    let mut judge = Judge::new(config, sim, layouts(config)?.swap_remove(0));
    let (mut world, mut course) = on_specimen(experiment, &mut random)?;
    let reach = judge.layout.dome_radius + sim.feeler.tip_radius;
    for number in 0..=MOTIONS {
        let motion = Motion::draw(number, &course, &mut random);
        let frames = (motion.duration / config.control.period).round() as u32;
        for _ in 0..frames {
            for _ in 0..steps {
                course.advance(&motion, sim.step);
                world.hold_fingertip(0, Some(course.pose(reach)));
                world.step()?;
            }
            judge.feel(&world, &sim.direct_sensing, &mut random);
            judge.judge(&world, &course.pose(reach));
        }
    }
    Ok(judge.samples)
}

/// Detectors under test, with their input and the ground truth.
struct Judge {
    layout: ElementLayout,
    touch_force: f64,
    analyzer: FlagAnalyzer,
    /// One detector for specimens that may move, and one for fixed specimens.
    detectors: [SlipDetector; 2],
    touch: TactileReading,
    /// True forces on the elements (N).
    truth: Vec<DVec3>,
    /// `true` if each element was pressed with more than F1 in the previous frame.
    pressed: Vec<bool>,
    /// Total slip distance of each feeler until the previous frame (m).
    way: Vec<f64>,
    samples: Vec<Sample>,
}

impl Judge {
    fn new(config: &ExperimentConfig, sim: &SimConfig, layout: ElementLayout) -> Self {
        let elements = layout.elements.len();
        let touch_force = config.control.touch_force;
        // Nominal rubber, as measured on a test bench; the rubber of a trial differs from it.
        let feeler = FeelerShape {
            normal_stiffness: sim.feeler.normal_stiffness,
            shear_stiffness: sim.feeler.shear_stiffness,
            tip_radius: sim.feeler.tip_radius,
        };
        Self {
            layout,
            touch_force,
            analyzer: FlagAnalyzer::new(config.control.thresholds(), elements),
            detectors: [
                SlipDetector::for_movable_object(feeler, touch_force, elements),
                SlipDetector::new(feeler, elements),
            ],
            touch: TactileReading::none(elements),
            truth: vec![DVec3::ZERO; elements],
            pressed: vec![false; elements],
            way: vec![0.0; elements],
            samples: Vec::new(),
        }
    }

    /// Takes the next frame: the true forces plus `noise`.
    fn feel(&mut self, world: &World, noise: &DirectSensingConfig, random: &mut Pcg64) {
        world.element_forces(0, &mut self.truth);
        let frame = &mut self.touch.frame;
        frame.sequence += 1;
        frame.stamp = world.state().time;
        for (felt, force) in frame.forces.iter_mut().zip(&self.truth) {
            let mut draw = |deviation| normal(random, deviation);
            let (across, along) = (noise.shear_noise, noise.normal_noise);
            *felt = *force + DVec3::new(draw(across), draw(across), draw(along));
        }
        self.touch.analyze(&mut self.analyzer);
    }

    /// Evaluates the detectors on the latest frame, and reads the ground truth.
    fn judge(&mut self, world: &World, pose: &Pose) {
        let finger = FingerReadings {
            pose: FingertipPose {
                position: pose.position,
                rotation: pose.rotation,
            },
            joints: JointState::default(),
            touch: &self.touch,
            layout: &self.layout,
        };
        let [moving, still] = self.detectors.each_mut().map(|d| d.detect(&finger));
        let slipped = &world.state().fingers[0].slipped;
        for (element, &slipped) in slipped.iter().enumerate() {
            if self.pressed[element] {
                self.samples.push(Sample {
                    frame: self.touch.frame.sequence as u32,
                    element: element as u32,
                    slipped: slipped > self.way[element],
                    scores: [
                        self.touch.shear_rate[element],
                        moving[element],
                        still[element],
                    ],
                });
            }
            self.way[element] = slipped;
            self.pressed[element] = self.truth[element].z > self.touch_force;
        }
    }
}

/// Places a fingertip with slightly different rubber over a specimen.
fn on_specimen(
    experiment: &Experiment,
    random: &mut Pcg64,
) -> Result<(World, Course), ExperimentError> {
    let config = &experiment.config;
    let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let mut sim = config.simulation()?.clone();
    let stiffness = between(0.9, 1.1);
    sim.feeler.normal_stiffness *= stiffness;
    sim.feeler.shear_stiffness *= stiffness;
    sim.fault.clear();
    let (specimen, surface, normal) = specimen(&mut between);
    sim.object = BTreeMap::from([("specimen".to_string(), specimen)]);
    let tangent = normal.any_orthonormal_vector();
    let frame = DMat3::from_cols(tangent, normal.cross(tangent), normal);
    // The dome's axis points into the surface, tilted by up to 25 degrees in a random direction, with a random
    // rotation about itself.
    let towards = between(0.0, TAU);
    let axis = frame * DVec3::new(libm::cos(towards), libm::sin(towards), 0.0);
    let lean = DMat3::from_axis_angle(axis, between(0.0, 25_f64.to_radians()));
    let onto = DMat3::from_cols(-normal, frame.x_axis, -frame.y_axis);
    let rotation = lean * onto * DMat3::from_rotation_x(between(0.0, TAU));
    let (fingers, joints) = fingers_at_home(config)?;
    let fingers: Vec<_> = fingers.into_iter().zip(layouts(config)?).collect();
    let world = World::new(&sim, &fingers, &joints, experiment.folder(), config.seed)?;
    let course = Course {
        surface,
        frame,
        rotation,
        depth: -GAP,
        dragged: [0.0; 2],
        twist: 0.0,
    };
    Ok((world, course))
}

/// Draws a specimen of random shape and friction, and a point on it (m, in W) with its outward normal.
fn specimen(between: &mut impl FnMut(f64, f64) -> f64) -> (ObjectConfig, DVec3, DVec3) {
    let static_friction = between(0.3, 1.2);
    let friction = Friction {
        static_friction,
        kinetic_friction: static_friction * between(0.6, 0.95),
        stribeck_speed: 0.0,
    };
    // Far below the fingers, which stay at their home positions.
    let centre = DVec3::new(0.0, 0.0, -1.0);
    let radius = between(0.012, 0.05);
    let side = centre + radius * DVec3::X;
    let (shape, surface, normal) = match (3.0 * between(0.0, 1.0)) as u32 {
        0 => (ShapeConfig::HalfSpace, centre, DVec3::Z),
        1 => (ShapeConfig::Sphere { radius }, side, DVec3::X),
        _ => {
            let height = 0.2;
            (ShapeConfig::Cylinder { radius, height }, side, DVec3::X)
        }
    };
    let specimen = ObjectConfig {
        shape,
        motion: MotionConfig::Fixed,
        position: centre.to_array(),
        orientation_deg: [0.0; 3],
        offset: [0.0; 3],
        friction: Some(friction),
    };
    (specimen, surface, normal)
}

impl Motion {
    /// Draws a motion: first a press from outside, then a random press, drag, twist or hold.
    fn draw(number: usize, course: &Course, random: &mut Pcg64) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let duration = between(0.3, 0.8);
        let mut motion = Self {
            depth: 0.0,
            drag: [0.0; 2],
            twist: 0.0,
            duration,
        };
        let kind = match number {
            0 => 0,
            _ => (4.0 * between(0.0, 1.0)) as u32,
        };
        match kind {
            0 => motion.depth = (between(DEPTH.0, DEPTH.1) - course.depth) / duration,
            1 => {
                let (speed, angle) = (between(0.001, 0.015), between(0.0, TAU));
                motion.drag = [speed * libm::cos(angle), speed * libm::sin(angle)];
            }
            2 => motion.twist = between(-1.5, 1.5),
            _ => {}
        }
        motion
    }
}

impl Course {
    fn advance(&mut self, motion: &Motion, duration: f64) {
        self.depth += motion.depth * duration;
        self.dragged[0] += motion.drag[0] * duration;
        self.dragged[1] += motion.drag[1] * duration;
        self.twist += motion.twist * duration;
    }

    /// Pose of the fingertip, whose dome has the radius `reach` (m) including the tips.
    fn pose(&self, reach: f64) -> Pose {
        let [x, y] = self.dragged;
        Pose {
            position: self.surface + self.frame * DVec3::new(x, y, reach - self.depth),
            rotation: DMat3::from_axis_angle(self.frame.z_axis, self.twist) * self.rotation,
        }
    }
}
