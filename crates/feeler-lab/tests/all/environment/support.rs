//! Creates environments of built-in experiments.

use feeler_lab::environment::{ActionKind, Environment, EnvironmentConfig, Step};

pub fn config(experiment: &str, settings: &[&str]) -> EnvironmentConfig {
    EnvironmentConfig {
        experiment: experiment.to_string(),
        settings: settings.iter().map(ToString::to_string).collect(),
        action: ActionKind::World,
        ..EnvironmentConfig::default()
    }
}

pub fn environment(experiment: &str, settings: &[&str]) -> Environment {
    Environment::new(&config(experiment, settings)).expect("an environment")
}

/// Info value called `name`.
pub fn told(environment: &Environment, name: &str) -> f64 {
    let mut names = environment.info_names().into_iter();
    let index = names.position(|own| own == name).expect("a name");
    environment.info()[index]
}

/// Follows the task's plan to the end of the episode with this `seed`. Returns its steps and the sum of their rewards.
pub fn follow(environment: &mut Environment, seed: u64) -> (Vec<Step>, f64) {
    environment.reset(Some(seed)).expect("an episode");
    let mut action = vec![0.0; environment.action_len()];
    let mut steps = Vec::new();
    loop {
        environment.guide(&mut action).expect("an action");
        let step = environment.step(&action).expect("a step");
        steps.push(step);
        if step.terminated || step.truncated {
            break;
        }
    }
    let sum = steps.iter().map(|step| step.reward).sum();
    (steps, sum)
}
