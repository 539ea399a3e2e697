//! Time of learning environments: control steps of 10 ms of simulated time, with everything that a step does.

use divan::Bencher;
use feeler_lab::environment::{ActionKind, Environment, EnvironmentConfig};

fn main() {
    divan::main();
}

fn config(experiment: &str) -> EnvironmentConfig {
    EnvironmentConfig {
        experiment: experiment.to_string(),
        action: ActionKind::World,
        ..EnvironmentConfig::default()
    }
}

fn environment(experiment: &str) -> Environment {
    Environment::new(&config(experiment)).expect("a built-in experiment")
}

/// One step of whole episodes that follow each other, resets included; the fingers do what the task plans, so that they touch for
/// most of the time.
#[divan::bench(args = ["cap-closing", "cap-until-closed", "lift", "slide-box-two", "contour"], sample_count = 20, sample_size = 2000)]
fn step(bencher: Bencher, experiment: &str) {
    let mut environment = environment(experiment);
    let mut action = vec![0.0; environment.action_len()];
    environment.reset(Some(0)).expect("an episode");
    let mut over = false;
    bencher.bench_local(|| {
        if over {
            environment.reset(None).expect("an episode");
        }
        environment.guide(&mut action).expect("an action");
        let step = environment.step(&action).expect("a step");
        over = step.terminated || step.truncated;
    });
}

/// The beginning of an episode.
#[divan::bench(args = ["cap-closing", "cap-until-closed", "lift", "contour"])]
fn reset(bencher: Bencher, experiment: &str) {
    let mut environment = environment(experiment);
    bencher.bench_local(|| environment.reset(None).expect("an episode"));
}

/// The same where the friction is drawn anew.
#[divan::bench]
fn reset_that_varies(bencher: Bencher) {
    let mut config = config("cap-closing");
    config.vary.push("friction=uniform(0.6,1.2)".to_string());
    let mut environment = Environment::new(&config).expect("an environment");
    bencher.bench_local(|| environment.reset(None).expect("an episode"));
}
