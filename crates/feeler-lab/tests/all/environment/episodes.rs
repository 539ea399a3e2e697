//! Seeds, variation, kinds of actions, and errors.

use super::support::{config, environment};
use feeler::control::task::TaskConfig;
use feeler_lab::config::Experiment;
use feeler_lab::environment::{ActionKind, Environment, EnvironmentConfig};
use feeler_lab::grips::place_random_object;
use feeler_lab::sweep::plan::Plan;
use feeler_lab::sweep::trial::Trials;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;

/// Observation after a tenth of a second of an episode with this `seed` that follows the plan.
fn observed(environment: &mut Environment, seed: Option<u64>) -> Vec<f32> {
    environment.reset(seed).expect("an episode");
    let mut action = vec![0.0; environment.action_len()];
    for _ in 0..10 {
        environment.guide(&mut action).expect("an action");
        environment.step(&action).expect("a step");
    }
    environment.observation().to_vec()
}

#[test]
fn a_seed_determines_its_episode_and_the_following_ones() {
    let mut environment = environment("cap-closing", &[]);
    let first = observed(&mut environment, Some(5));
    let next = observed(&mut environment, None);
    let after = observed(&mut environment, None);
    assert!(first != next && next != after);
    assert_eq!(observed(&mut environment, Some(5)), first);
    let seed = environment.reset(None).expect("an episode");
    assert!(i64::try_from(seed).is_ok(), "a file can contain {seed}");
    let mut other = super::support::environment("cap-closing", &[]);
    assert_eq!(observed(&mut other, Some(seed)), next);
}

#[test]
fn variation_draws_the_parameters_of_a_sweeps_first_trial() {
    let vary = [
        "friction=uniform(0.3,1.2)",
        "cap.radius=uniform(0.013,0.015)",
    ];
    let vary = vary.map(ToString::to_string).to_vec();
    let mut environment = Environment::new(&EnvironmentConfig {
        vary: vary.clone(),
        ..config("cap-closing", &[])
    })
    .expect("an environment");
    let experiment = Experiment::load("cap-closing", &["sensing=direct".to_string()]);
    let experiment = experiment.expect("an experiment");
    for seed in [1, 9] {
        let plan = Plan::new(&experiment, "cap-closing", &vary, seed, 1).expect("a plan");
        let trials = Trials::new(&plan);
        let trial = trials
            .and_then(|trials| trials.experiment(0))
            .expect("a trial");
        environment.reset(Some(seed)).expect("an episode");
        let (ours, theirs) = (&environment.experiment().config, &trial.config);
        assert_eq!(ours.sim, theirs.sim);
        assert_ne!(ours.sim, experiment.config.sim);
        assert_eq!(ours.seed, seed);
    }
}

/// Equivalent actions of all kinds give the same command, up to the rounding of coordinate transformations.
#[test]
fn actions_of_all_kinds_pass_the_same_limits() {
    let command = |action| {
        let mut environment = Environment::new(&EnvironmentConfig {
            action,
            ..config("cap-closing", &[])
        })
        .expect("an environment");
        environment.reset(Some(0)).expect("an episode");
        let mut action = [f64::NAN; 6];
        environment.guide(&mut action).expect("an action");
        environment.step(&action).expect("a step");
        environment
            .session()
            .control_loop()
            .command()
            .joint_velocity()
            .to_vec()
    };
    let world = command(ActionKind::World);
    assert!(world.iter().all(|velocity| velocity.length() > 0.01));
    for kind in [ActionKind::Fingertip, ActionKind::Joints] {
        for (own, world) in command(kind).iter().zip(&world) {
            assert!(own.distance(*world) < 1e-12, "{kind:?}: {own} {world}");
        }
    }
    for (name, kind) in ActionKind::NAMES
        .into_iter()
        .zip(["World", "Fingertip", "Joints"])
    {
        let named = ActionKind::named(name).expect("a kind");
        assert_eq!(format!("{named:?}"), kind);
    }
    assert_eq!(ActionKind::named("torque"), None);
}

#[test]
fn limits_hold_for_arbitrarily_large_actions() {
    for action in [ActionKind::World, ActionKind::Fingertip, ActionKind::Joints] {
        let mut environment = Environment::new(&EnvironmentConfig {
            action,
            ..config("cap-closing", &[])
        })
        .expect("an environment");
        environment.reset(Some(0)).expect("an episode");
        let bounds = environment.action_bounds();
        assert_eq!(
            bounds,
            vec![
                if action == ActionKind::Joints {
                    2.0
                } else {
                    0.05
                };
                6
            ]
        );
        let mut before = vec![feeler::hand::JointVector::default(); 2];
        for sign in [1.0, -1.0, -1.0, 1.0] {
            environment.step(&[sign * f64::MAX; 6]).expect("a step");
            assert_eq!(environment.stop_reason(), None);
            let command = environment.session().control_loop().command();
            for (now, before) in command.joint_velocity().iter().zip(&mut before) {
                // 20 rad/s² for 10 ms.
                assert!((*now - *before).abs().max_element() <= 0.2 + 1e-12);
                *before = *now;
            }
        }
    }
}

#[test]
fn invalid_actions_and_configurations_are_rejected_with_messages() {
    let mut environment = environment("cap-closing", &[]);
    let refused = |environment: &mut Environment, action: &[f64], word: &str| {
        let error = environment.step(action).expect_err("no sense").to_string();
        assert!(error.contains(word), "{error}");
    };
    refused(&mut environment, &[0.0; 6], "no episode is active");
    environment.reset(Some(0)).expect("an episode");
    refused(&mut environment, &[0.0; 5], "an action of 6 numbers");
    refused(
        &mut environment,
        &[0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0],
        "action[2]",
    );
    refused(&mut environment, &[f64::INFINITY; 6], "got inf");
    // Rejected actions have no effect.
    assert!(environment.step(&[0.0; 6]).is_ok());
    assert!(environment.guide(&mut [0.0; 3]).is_err());

    let no_such = |config: EnvironmentConfig, word: &str| {
        let error = Environment::new(&config)
            .err()
            .expect("no sense")
            .to_string();
        assert!(error.contains(word), "{error}");
    };
    no_such(config("cap-losing", &[]), "cap-losing");
    no_such(
        config("friction-scan", &[]),
        "no rewards are defined for task.friction_scan",
    );
    no_such(
        config("cap-opening", &[]),
        "no rewards are defined for task.screw",
    );
    no_such(
        config("cap-closing", &["control.period=-1"]),
        "control.period",
    );
    let varied = |vary: &str| EnvironmentConfig {
        vary: vec![vary.to_string()],
        ..config("cap-closing", &[])
    };
    no_such(varied("friction=gamma(1)"), "gamma");
    no_such(varied("seed=uniform(0,1)"), "seed");
    let other = varied("sensor.fingertip.layout.rings.0.elements=choice(1,3)");
    let mut environment = Environment::new(&other).expect("an environment");
    let error = (0..20).find_map(|seed| environment.reset(Some(seed)).err());
    let error = error.expect("an episode with other elements").to_string();
    assert!(error.contains("288 numbers"), "{error}");
}

/// With random actions within their bounds, in randomized episodes.
#[test]
fn observations_are_within_finite_bounds() {
    for (experiment, kind) in [
        ("cap-closing", ActionKind::Fingertip),
        ("cap-until-closed", ActionKind::Joints),
        ("lift", ActionKind::World),
        ("slide-box-two", ActionKind::World),
        ("contour", ActionKind::Joints),
    ] {
        let config = EnvironmentConfig {
            action: kind,
            vary: vec!["friction=relative(0.5,1.5)".into()],
            ..config(experiment, &["time_limit=4"])
        };
        let mut environment = Environment::new(&config).expect("an environment");
        let (low, high) = environment.observation_bounds();
        assert!(low.iter().chain(&high).all(|bound| bound.is_finite()));
        assert_eq!(low.len(), environment.observation().len());
        let bounds = environment.action_bounds();
        let mut random = Pcg64::seed_from_u64(7);
        for seed in 0..3 {
            environment.reset(Some(seed)).expect("an episode");
            let mut guided = vec![0.0; bounds.len()];
            loop {
                environment.guide(&mut guided).expect("an action");
                // Random actions around the planned motion, so that the fingers touch objects.
                let action = guided.iter().zip(&bounds);
                let action = action.map(|(guided, bound)| {
                    (guided + random.random_range(-0.3..0.3) * bound).clamp(-bound, *bound)
                });
                let action: Vec<f64> = action.collect();
                let step = environment.step(&action).expect("a step");
                let observation = environment.observation().iter().zip(low.iter().zip(&high));
                for (place, (number, (low, high))) in observation.enumerate() {
                    assert!(
                        (low..=high).contains(&number),
                        "{experiment} {place}: {number} of {low} to {high}"
                    );
                }
                if step.terminated || step.truncated {
                    break;
                }
            }
        }
    }
}

#[test]
fn a_later_episode_is_reproducible_from_its_seed() {
    let mut environment = environment("cap-closing", &[]);
    let seeds = [Some(5), None, None, None].map(|seed| environment.reset(seed).expect("a seed"));
    let after = environment.reset(None).expect("a seed");
    for (following, seed) in seeds.into_iter().enumerate() {
        let own = environment.reset_to(5, following as u64).expect("a seed");
        assert_eq!(own, seed);
    }
    assert_eq!(environment.reset(None).expect("a seed"), after);
}

/// The environment draws the objects of `feeler compare grip`, independently of earlier episodes.
#[test]
fn random_objects_are_those_of_a_comparison() {
    let random = |experiment: &str| EnvironmentConfig {
        vary: vec!["object=random".to_string()],
        ..config(experiment, &["task.grip.law=known-friction"])
    };
    let mut environment = Environment::new(&random("grip")).expect("an environment");
    for seed in [1, 2, 3, 1] {
        environment.reset(Some(seed)).expect("an episode");
        let settings = ["sensing=direct", "task.grip.law=known-friction"];
        let experiment = Experiment::load("grip", &settings.map(ToString::to_string));
        let mut expected = experiment.expect("an experiment").config;
        let object = place_random_object(&mut expected, seed);
        let ours = &environment.experiment().config;
        assert_eq!(ours, &expected);
        let TaskConfig::Grip(grip) = &ours.task else {
            panic!("a gripper")
        };
        assert_eq!(grip.known_friction, object.friction * object.kinetic);
    }
    let refused = Environment::new(&EnvironmentConfig {
        vary: vec!["object=random".to_string()],
        ..config("lift", &[])
    });
    let refused = refused.err().expect("an error").to_string();
    assert!(
        refused.contains("expected an experiment with task.grip, got lift"),
        "{refused}"
    );
}
