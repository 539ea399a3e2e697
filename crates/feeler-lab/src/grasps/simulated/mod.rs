//! Grasps in simulation, held or lost, as a gel with markers feels them, and what is true of them.
//!
//! Two fingers close on a free object, lift it, shake it, are tugged at and open, as it comes. Object, grip and gel are drawn from
//! ranges that are wider than what any one sensor has (`docs/slip.md` lists them). Whether an object slid is the simulator's
//! truth: how far it is from where it was between the fingertips.

mod markers;
mod motion;
mod scenario;

pub use markers::PICTURE;
pub use scenario::{Gel, Scenario, Shake};

use crate::config::Experiment;
use crate::experiment::{ExperimentError, fingers_at_home};
use feeler_sim::columnar_feeler::FeelerConfig;
use feeler_sim::config::{SimConfig, VariationConfig};
use feeler_sim::object::{MotionConfig, ObjectConfig};
use feeler_sim::shape::ShapeConfig;
use feeler_sim::world::World;
use glam::{DVec2, DVec3};
use markers::Markers;
use motion::Hand;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// The experiment whose hand grasps.
const HAND: &str = "lift";
/// How long a grasp is looked at, s.
const DURATION: f64 = 9.0;
/// Time between two frames, s.
pub const INTERVAL: f64 = 0.1;
/// Radius of the contact for which the gel is as stiff as its layer, m; assumed.
const CONTACT: f64 = 0.004;
/// Damping of the gel in parts of its stiffness, s; assumed.
const DAMPING: f64 = 0.003;
/// Radius of what touches at each marker, m.
const TIP: f64 = 0.0005;
/// Where the object stands on its pedestal, m in W: far from where the fingers are before they are held anywhere.
const PLACE: DVec3 = DVec3::new(5.0, 0.0, 0.05);
/// An object that moves by more along the pads has slipped, m: a soft gel gives way by less.
pub const SLIDING: f64 = 0.004;

/// What was felt in a frame, and what is true of it.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedFrame {
    /// Its time, s.
    pub stamp: f64,
    /// How far each marker is seen from its untouched place, px, with noise.
    pub displaced: Vec<DVec2>,
    /// The true force on the gel at each marker, N: along x and y, and compression.
    pub forces: Vec<DVec3>,
    /// How far the object has slid along the pads since it was lifted, m.
    pub slid: f64,
    /// Whether a finger touches it.
    pub touches: bool,
}

/// A grasp of which everything is known.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedGrasp {
    /// What was grasped, and how.
    pub scenario: Scenario,
    /// Where the markers of finger 0 are seen where nothing touches, px.
    pub untouched: Vec<DVec2>,
    /// The frames.
    pub frames: Vec<SimulatedFrame>,
    /// From which frame on the object has slipped or is lost, if it does.
    pub slips_at: Option<usize>,
}

impl SimulatedGrasp {
    /// The grasp of `seed`: the same each time.
    ///
    /// # Errors
    /// When the world cannot be made, or a quantity becomes not finite.
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

/// From which frame on the object has slid or is lost.
fn slips_at(frames: &[SimulatedFrame]) -> Option<usize> {
    let grasped = frames.iter().position(|frame| frame.touches)?;
    let gone = |frame: &SimulatedFrame| frame.slid > SLIDING || !frame.touches;
    let first = frames[grasped..].iter().position(gone)?;
    Some(grasped + first)
}

/// The object on its pedestal, and the hand of two fingers that wear the gel.
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
    // Narrower than any grip that presses in as far as it may.
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
