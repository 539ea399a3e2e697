//! An agent that replaces the control law with the same actions produces an identical run.

use super::support::environment;
use feeler::control::law::Law;
use feeler_lab::config::Experiment;
use feeler_lab::environment::Environment;
use feeler_lab::experiment::Session;

/// A session as created by `feeler run`.
fn session(name: &str, settings: &[&str], seed: u64) -> Session {
    let mut settings: Vec<_> = settings.iter().map(ToString::to_string).collect();
    settings.push(format!("seed={seed}"));
    let experiment = Experiment::load(name, &settings).expect("an experiment");
    Session::new(&experiment).expect("a session")
}

/// Control laws of the environment's experiment, one per finger, in their initial state.
fn laws(environment: &Environment) -> Vec<Box<dyn Law>> {
    let control = &environment.experiment().config.control;
    let layouts = environment.layouts().iter();
    layouts
        .map(|layout| {
            let law =
                control
                    .law
                    .finger_law(control.reflex(), control.touch_force, layout.elements);
            law.expect("a law").expect("a law for each finger")
        })
        .collect()
}

/// Writes the velocities that the laws request for the current plans and readings to `action`.
fn by_law(environment: &Environment, laws: &mut [Box<dyn Law>], action: &mut [f64]) {
    let control_loop = environment.session().control_loop();
    let plans = control_loop.controller().plans();
    let fingers = control_loop.hand_sense().fingers().zip(plans);
    for ((law, numbers), (sense, plan)) in
        laws.iter_mut().zip(action.chunks_exact_mut(3)).zip(fingers)
    {
        numbers.copy_from_slice(&law.velocity(plan, &sense).to_array());
    }
}

/// Performs both runs in parallel and compares joint angles, forces, flags, phases and commands of every step bit for
/// bit.
///
/// The agent follows the laws if `follows_law`, else the plan. Returns the number of steps.
fn compare(name: &str, settings: &[&str], seed: u64, follows_law: bool) -> usize {
    let mut session = session(name, settings, seed);
    let mut environment = environment(name, settings);
    environment.reset(Some(seed)).expect("an episode");
    let mut laws = laws(&environment);
    let mut action = vec![0.0; environment.action_len()];
    let mut steps = 0;
    loop {
        session.step().expect("a step");
        let (ours, theirs) = (environment.session().control_loop(), session.control_loop());
        assert_eq!(ours.state(), theirs.state(), "{name}: step {steps}");
        assert_eq!(ours.touches(), theirs.touches(), "{name}: step {steps}");
        let phases = [ours, theirs].map(|control_loop| control_loop.controller().phase());
        assert_eq!(phases[0], phases[1], "{name}: step {steps}");
        match follows_law {
            true => by_law(&environment, &mut laws, &mut action),
            false => environment.guide(&mut action).expect("an action"),
        }
        let step = environment.step(&action).expect("a step");
        let (ours, theirs) = (environment.session().control_loop(), session.control_loop());
        assert_eq!(ours.command(), theirs.command(), "{name}: step {steps}");
        steps += 1;
        if step.terminated || step.truncated {
            return steps;
        }
    }
}

#[test]
fn an_agent_with_the_papers_law_reproduces_its_run() {
    for seed in [0, 7] {
        let steps = compare("cap-closing", &["sensing=direct"], seed, true);
        assert!(steps > 1500, "{steps} steps");
    }
}

#[test]
fn an_agent_with_an_adaptive_law_reproduces_its_run() {
    let settings = ["sensing=direct", "control.law=best", "task.screw.strokes=1"];
    assert!(compare("cap-closing", &settings, 3, true) > 300);
}

#[test]
fn an_agent_that_follows_the_plan_reproduces_a_run_without_law() {
    for name in ["cap-until-closed", "lift", "slide-box-two", "contour"] {
        let steps = compare(name, &["sensing=direct"], 1, false);
        assert!(steps > 300, "{name}: {steps} steps");
    }
}

#[test]
fn forces_are_computed_from_images_if_configured() {
    let settings = ["sensing=image", "time_limit=1.2"];
    // Step 120 is the first with a state past the limit.
    assert_eq!(compare("cap-closing", &settings, 0, true), 120);
}
