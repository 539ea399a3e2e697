//! Time of learning environments, per control step of 10 ms of simulated time.

use divan::Bencher;
use divan::counter::ItemsCount;
use feeler_lab::environment::{
    ActionKind, Autoreset, Batch, Environment, EnvironmentConfig, VectorEnvironment,
};

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

/// One step, averaged over complete episodes including resets. The fingers follow the task's plan, so they are in
/// contact most of the time.
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

/// Beginning of an episode.
#[divan::bench(args = ["cap-closing", "cap-until-closed", "lift", "contour"])]
fn reset(bencher: Bencher, experiment: &str) {
    let mut environment = environment(experiment);
    bencher.bench_local(|| environment.reset(None).expect("an episode"));
}

/// Beginning of an episode with random friction.
#[divan::bench]
fn reset_that_varies(bencher: Bencher) {
    let mut config = config("cap-closing");
    config.vary.push("friction=uniform(0.6,1.2)".to_string());
    let mut environment = Environment::new(&config).expect("an environment");
    bencher.bench_local(|| environment.reset(None).expect("an episode"));
}

/// One step of each of 256 environments on several threads, averaged over complete episodes including resets.
#[divan::bench(args = [1, 2], sample_count = 10, sample_size = 200)]
fn step_of_256(bencher: Bencher, threads: usize) {
    const COUNT: usize = 256;
    let vector =
        VectorEnvironment::new(&config("cap-closing"), COUNT, threads, Autoreset::NextStep);
    let mut vector = vector.expect("environments");
    let mut observations = vec![0.0; COUNT * vector.observation_len()];
    let mut infos = vec![0.0; COUNT * vector.info_len()];
    let (mut rewards, mut flags) = (vec![0.0; COUNT], [vec![false; COUNT], vec![false; COUNT]]);
    let [terminated, truncated] = &mut flags;
    let mut batch = Batch {
        observations: &mut observations,
        rewards: &mut rewards,
        terminated,
        truncated,
        infos: &mut infos,
    };
    let seeds: Vec<_> = (0..COUNT as u64).map(Some).collect();
    vector.reset(&seeds, None, &mut batch).expect("episodes");
    let mut actions = vec![0.0; COUNT * vector.action_len()];
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        for (index, action) in actions.chunks_exact_mut(6).enumerate() {
            let guided = vector.look(index, |environment| environment.guide(action));
            guided.expect("an environment").expect("an action");
        }
        vector.step(&actions, &mut batch).expect("a step");
    });
}
