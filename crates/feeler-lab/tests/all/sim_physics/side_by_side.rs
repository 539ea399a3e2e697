//! Vectorized contact computation and lazily evaluated steps are bit-identical to scalar contacts and observed steps.

use super::reference::{Commands, commands, experiment, replay, world};
use feeler_lab::config::Experiment;
use feeler_sim::bench::ElementConfig;
use feeler_sim::world::World;

/// Complete observable state of a world; numbers are formatted so that they round-trip.
fn seen(world: &World) -> String {
    let state = world.state();
    let fingers = state.fingers.iter().map(|finger| {
        let contacts: Vec<_> = finger.contacts.iter().collect();
        let (forces, slipped) = (&finger.forces, &finger.slipped);
        format!(
            "{:?} {:?} {contacts:?} {forces:?} {slipped:?} {:?} {:?}",
            finger.joints, finger.tip, finger.slip_work, finger.sets
        )
    });
    let fingers: Vec<_> = fingers.collect();
    let objects = state.objects.iter().map(|o| (o.pose, o.turn));
    let objects: Vec<_> = objects.collect();
    let torque = state.filtered_torque;
    format!("{} {fingers:?} {objects:?} {torque:?}", state.steps)
}

/// An element of each finger that touches nothing in the run, and the maximum number of simultaneous contacts of a
/// finger.
fn idle_elements(experiment: &Experiment, commands: &Commands) -> (Vec<usize>, usize) {
    let mut world = world(experiment, &commands.start);
    let fingers = world.model().fingers.iter();
    let mut touched: Vec<_> = fingers.map(|f| vec![false; f.normals.len()]).collect();
    let mut most = 0;
    replay(&mut world, commands, |world, _| {
        for (finger, touched) in world.state().fingers.iter().zip(&mut touched) {
            most = most.max(finger.contacts.len());
            for contact in finger.contacts.iter() {
                touched[contact.element] = true;
            }
        }
    });
    let idle = |touched: &Vec<bool>| touched.iter().position(|touched| !touched);
    let idle: Option<Vec<_>> = touched.iter().map(idle).collect();
    (idle.expect("an element that touches nothing"), most)
}

/// Compares the run with one whose contacts are computed one by one, and returns the maximum number of contacts.
///
/// A feeler that differs from the others disables vectorization; one that touches nothing has no other effect.
fn compare_with_one_by_one(experiment: &Experiment) -> usize {
    let commands = commands(experiment);
    let (idle, most) = idle_elements(experiment, &commands);
    let mut differing = experiment.clone();
    let sim = differing.config.sim.as_mut().expect("a simulated world");
    for (finger, element) in idle.into_iter().enumerate() {
        sim.element.push(ElementConfig {
            finger,
            elements: vec![element],
            normal_stiffness: Some(1.5 * sim.feeler.normal_stiffness),
            ..ElementConfig::default()
        });
    }
    let mut one_by_one = world(&differing, &commands.start);
    let mut side_by_side = world(experiment, &commands.start);
    let mut steps = 0_u64;
    replay(&mut side_by_side, &commands, |world, row| {
        for (finger, &velocity) in commands.rows[row].iter().enumerate() {
            one_by_one.command(finger, velocity);
        }
        one_by_one.step().expect("a step");
        steps += 1;
        // Not every step is compared, as formatting is slow; a difference persists.
        if steps.is_multiple_of(7) {
            assert_eq!(seen(world), seen(&one_by_one));
        }
    });
    assert_eq!(seen(&side_by_side), seen(&one_by_one));
    most
}

fn built_in(name: &str, settings: &[&str]) -> Experiment {
    let settings: Vec<_> = std::iter::once(&"sensing=direct")
        .chain(settings)
        .map(ToString::to_string)
        .collect();
    Experiment::load(name, &settings).expect("a built-in experiment")
}

#[test]
fn vectorized_contacts_are_bit_identical_to_scalar_ones() {
    for seed in [3, 4, 5] {
        compare_with_one_by_one(&experiment(&[&format!("seed={seed}")]));
    }
    // Soft feelers have more contacts than a vector and a block.
    let soft = ["sim.feeler.normal_stiffness=60.0", "time_limit=6.0"];
    let most = compare_with_one_by_one(&built_in("cap-closing", &soft));
    assert!(most > 8, "{most}");
}

#[test]
fn vectorized_contacts_of_one_and_three_fingers_are_bit_identical_to_scalar_ones() {
    for name in ["friction-scan", "three-fingers"] {
        let most = compare_with_one_by_one(&built_in(name, &["time_limit=6.0"]));
        assert!(most > 0, "{name}");
    }
}

#[test]
fn vectorized_contacts_shift_a_bottle_like_scalar_ones() {
    let holder = "sim.holder={lateral={stiffness=[2e4,2e4]},turn_play=0.01}";
    compare_with_one_by_one(&experiment(&[holder]));
}

#[test]
fn observing_steps_does_not_change_the_world() {
    for settings in [
        vec!["seed=6"],
        vec!["sim.feeler.relaxation={share=0.2,time=0.5}"],
        vec![
            "sim.feeler.normal_damping=0.5",
            "sim.feeler.shear_damping=0.3",
        ],
    ] {
        let experiment = experiment(&settings);
        let commands = commands(&experiment);
        let mut stepped = world(&experiment, &commands.start);
        let mut advanced = world(&experiment, &commands.start);
        let steps = (commands.period / stepped.model().step).round() as usize;
        for command in &commands.rows {
            for (finger, &velocity) in command.iter().enumerate() {
                stepped.command(finger, velocity);
                advanced.command(finger, velocity);
            }
            for _ in 0..steps {
                stepped.step().expect("a step");
            }
            advanced.advance(steps).expect("steps");
            assert_eq!(seen(&advanced), seen(&stepped));
        }
    }
}
