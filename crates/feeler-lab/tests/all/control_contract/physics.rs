//! Steps of the simulated world do not allocate, over a whole run in which feelers touch, roll, slip and separate.

use assert_no_alloc::assert_no_alloc;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;

#[test]
fn a_step_of_the_world_does_not_allocate() {
    run_without_allocation(&["sensing=direct"]);
}

#[test]
fn a_step_with_relaxing_rubber_and_a_loose_bottle_does_not_allocate() {
    run_without_allocation(&[
        "sensing=direct",
        "sim.feeler.relaxation={share=0.2, time=0.3}",
        "sim.holder={lateral={stiffness=[4e4, 4e4], play=[1e-4, 1e-4]}, turn_play=0.01}",
        "sim.servo.backlash=0.0005",
    ]);
}

fn run_without_allocation(settings: &[&str]) {
    let settings: Vec<_> = settings.iter().map(ToString::to_string).collect();
    let experiment = Experiment::load("cap-closing", &settings).expect("an experiment");
    let mut session = Session::new(&experiment).expect("a session");
    let mut world = feeler_lab::experiment::world(&experiment).expect("a world");
    let (mut steps, mut touched) = (0, 0);
    while !session.finished() {
        session.step().expect("a step");
        for (finger, &velocity) in
            (session.control_loop().command().joint_velocity().iter()).enumerate()
        {
            world.command(finger, velocity);
        }
        assert_no_alloc(|| {
            for _ in 0..10 {
                world.step().expect("a step");
            }
        });
        steps += 10;
        touched += usize::from(!world.state().fingers[0].contacts.is_empty());
    }
    assert!(steps > 10_000 && touched > 300, "{steps} {touched}");
}
