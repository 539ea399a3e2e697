//! The reference run, and replay of its commands on a world that tests inspect after every step.

use feeler::hand::{FingerGeometry, JointVector};
use feeler::sensor::fingertip::ElementLayout;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_sim::world::World;
use std::path::Path;

pub fn experiment(settings: &[&str]) -> Experiment {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/stiff-feelers.toml");
    let settings: Vec<_> = std::iter::once(&"sensing=direct")
        .chain(settings)
        .map(ToString::to_string)
        .collect();
    Experiment::load(file, &settings).expect("the reference experiment")
}

/// Joint velocities commanded by the control law in a run, one row per control period.
pub struct Commands {
    pub period: f64,
    pub rows: Vec<Vec<JointVector>>,
    /// Initial joint angles (rad).
    pub start: Vec<JointVector>,
    /// Stroke of each row, starting at 1.
    pub strokes: Vec<u32>,
}

pub fn commands(experiment: &Experiment) -> Commands {
    let mut session = Session::new(experiment).expect("a session");
    let start = joints(&session.rig().world());
    let (mut rows, mut strokes) = (Vec::new(), Vec::new());
    while !session.finished() {
        session.step().expect("a step");
        let control_loop = session.control_loop();
        rows.push(control_loop.command().joint_velocity().to_vec());
        strokes.push(control_loop.controller().task().stroke());
    }
    Commands {
        period: experiment.config.control.period,
        rows,
        start,
        strokes,
    }
}

fn joints(world: &World) -> Vec<JointVector> {
    let fingers = world.state().fingers.iter();
    fingers.map(|f| f.joints.position).collect()
}

/// The world of `experiment` before its first step.
pub fn world(experiment: &Experiment, start: &[JointVector]) -> World {
    let config = &experiment.config;
    let layout = ElementLayout::new(&config.sensor.fingertip.layout);
    let fingers = config.hand.finger.iter();
    let fingers: Vec<_> = fingers
        .map(|f| (FingerGeometry::of(f).expect("a finger"), layout.clone()))
        .collect();
    World::new(
        config.simulation().expect("a simulated world"),
        &fingers,
        start,
        Path::new(""),
        config.seed,
    )
    .expect("a world")
}

/// Applies the commands of a run to `world` and calls `watch` with the world and the index of the command after every
/// physics step.
pub fn replay(world: &mut World, commands: &Commands, mut watch: impl FnMut(&mut World, usize)) {
    let steps = (commands.period / world.model().step).round() as usize;
    for (row, command) in commands.rows.iter().enumerate() {
        for (finger, &velocity) in command.iter().enumerate() {
            world.command(finger, velocity);
        }
        for _ in 0..steps {
            world.step().expect("a step");
            watch(world, row);
        }
    }
}
