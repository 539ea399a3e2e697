//! Simulated grasps, successful or failed, measured by a gel with markers, with ground truth.
//!
//! Two fingers close on a free object and lift it. In some grasps, chosen at random, the hand shakes, a force tugs at
//! the object, or the fingers open. Object, grip and gel are drawn from ranges that are wider than those of any
//! particular sensor (see `scenario.rs`). The ground truth of slip is the displacement of the object relative to
//! its initial position between the fingertips.

mod markers;
mod motion;
mod scenario;

pub use markers::PICTURE;
pub use scenario::{Gel, Scenario, Shake};

use crate::config::Experiment;
use crate::experiment::{ExperimentError, fingers_at_home};
use feeler_sim::contact::FeelerConfig;
use feeler_sim::objects::{MotionConfig, ObjectConfig};
use feeler_sim::shapes::ShapeConfig;
use feeler_sim::world::{SimConfig, VariationConfig, World};
use glam::{DVec2, DVec3};
use markers::Markers;
use motion::Hand;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// Name of the built-in experiment that defines the hand.
const HAND: &str = "lift";
/// Duration of a grasp (s).
const DURATION: f64 = 9.0;
/// Time between two frames (s).
pub const INTERVAL: f64 = 0.1;
/// Assumed radius of the contact for which the stiffness of the gel is computed (m).
const CONTACT: f64 = 0.004;
/// Ratio of damping to stiffness of the gel (s); assumed.
const DAMPING: f64 = 0.003;
/// Tip radius at each marker (m).
const TIP: f64 = 0.0005;
/// Position of the object on its pedestal (m, in W), far from the initial position of the fingers.
const PLACE: DVec3 = DVec3::new(5.0, 0.0, 0.05);
/// Displacement of the object along the pads above which the object has slipped (m). A soft gel yields by less.
pub const SLIDING: f64 = 0.004;

/// Measurements and ground truth of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedFrame {
    /// Timestamp (s).
    pub stamp: f64,
    /// Displacement of each marker from its untouched position (px), with noise.
    pub displaced: Vec<DVec2>,
    /// True force on the gel at each marker (N): along x and y, and compression.
    pub forces: Vec<DVec3>,
    /// Displacement of the object along the pads since it was lifted (m).
    pub slid: f64,
    /// `true` if a finger touches the object.
    pub touches: bool,
}

/// A simulated grasp with ground truth.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedGrasp {
    /// The object and how it is grasped.
    pub scenario: Scenario,
    /// Image positions of the markers of finger 0 without contact (px).
    pub untouched: Vec<DVec2>,
    /// The frames.
    pub frames: Vec<SimulatedFrame>,
    /// Index of the first frame in which the object has slipped or is lost, if any.
    pub slips_at: Option<usize>,
}

impl SimulatedGrasp {
    /// Simulates the grasp with this seed, deterministically.
    ///
    /// # Errors
    /// If the world cannot be built, or a quantity becomes non-finite.
    pub fn new(seed: u64) -> Result<Self, ExperimentError> {
        let scenario = Scenario::draw(seed);
        let mut random = Pcg64::seed_from_u64(!seed);
        let mut markers = Markers::new(scenario.gel, &mut random);
        let mut world = world(&scenario, &markers)?;
        let object = world.model().object("object").unwrap_or(0);
        let middle = world.state().objects[object].pose.position;
        let mut hand = Hand::new(&scenario, middle, scenario.gel.radius + TIP);
        let untouched = markers.untouched();
        let mut forces = vec![DVec3::ZERO; untouched.len()];
        let mut frames = Vec::new();
        let steps = (INTERVAL / world.model().step).round() as usize;
        for frame in 0..=(DURATION / INTERVAL).round() as usize {
            if frame > 0 {
                for _ in 0..steps {
                    hand.advance(&mut world, object);
                    world.step()?;
                }
            }
            world.element_forces(0, &mut forces);
            let fingers = world.state().fingers.iter();
            let mut contacts = fingers.flat_map(|finger| finger.contacts.iter());
            frames.push(SimulatedFrame {
                stamp: frame as f64 * INTERVAL,
                displaced: markers.displaced(&forces, INTERVAL, &mut random),
                forces: forces.clone(),
                slid: hand.slid(&world, object),
                touches: contacts.any(|contact| contact.object == object),
            });
        }
        let slips_at = slips_at(&frames);
        Ok(Self {
            untouched,
            frames,
            slips_at,
            scenario,
        })
    }
}

/// Returns the index of the first frame in which the object has slipped or is lost.
fn slips_at(frames: &[SimulatedFrame]) -> Option<usize> {
    let grasped = frames.iter().position(|frame| frame.touches)?;
    let gone = |frame: &SimulatedFrame| frame.slid > SLIDING || !frame.touches;
    let first = frames[grasped..].iter().position(gone)?;
    Some(grasped + first)
}

/// Builds the world: the object on its pedestal, and a hand of two fingers with the gel.
fn world(scenario: &Scenario, markers: &Markers) -> Result<World, ExperimentError> {
    let experiment = Experiment::load(HAND, &[])?;
    let config = &experiment.config;
    let mut sim: SimConfig = config.simulation()?.clone();
    let [normal_stiffness, shear_stiffness] = markers.stiffness(CONTACT);
    sim.feeler = FeelerConfig {
        normal_stiffness,
        shear_stiffness,
        normal_damping: DAMPING * normal_stiffness,
        shear_damping: DAMPING * shear_stiffness,
        tip_radius: TIP,
        length_limit: Some(0.8 * scenario.gel.thickness),
        ..FeelerConfig::default()
    };
    sim.fault.clear();
    sim.variation = VariationConfig {
        friction: 0.0,
        ..VariationConfig::default()
    };
    let fixed = |shape, position: DVec3| ObjectConfig {
        shape,
        motion: MotionConfig::Fixed,
        position: position.to_array(),
        orientation_deg: [0.0; 3],
        offset: [0.0; 3],
        friction: None,
    };
    // Narrower than the fingers at maximum indentation.
    let size = [0.4 * scenario.half_width, 0.03, PLACE.z];
    let pedestal = fixed(ShapeConfig::Box { size }, PLACE.with_z(PLACE.z / 2.0));
    sim.object = BTreeMap::from([
        (
            "ground".to_string(),
            fixed(ShapeConfig::HalfSpace, DVec3::ZERO),
        ),
        ("object".to_string(), scenario.object(PLACE)),
        ("pedestal".to_string(), pedestal),
    ]);
    let (fingers, joints) = fingers_at_home(config)?;
    let fingers = fingers
        .into_iter()
        .map(|finger| (finger, markers.elements()));
    let fingers: Vec<_> = fingers.collect();
    Ok(World::new(
        &sim,
        &fingers,
        &joints,
        experiment.folder(),
        config.seed,
    )?)
}
