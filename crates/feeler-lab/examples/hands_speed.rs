//! Measures the speed and memory of many simulated hands that step together, each in a separate environment that
//! follows the task's plan.
//!
//! ```sh
//! cargo run --release -p feeler-lab --example hands_speed -- HANDS THREADS STEPS [EXPERIMENT]
//! ```
//!
//! All hands begin an episode at the same time with different seeds. The program makes STEPS control steps of each
//! hand and prints the number of steps per second, excluding the time of planning. A cap-closing episode has 1,860
//! steps.

use feeler_lab::environment::{ActionKind, Autoreset, Batch, EnvironmentConfig, VectorEnvironment};
use std::error::Error;
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |name: &str| -> Result<usize, Box<dyn Error>> {
        let given = arguments.next().ok_or(format!("expected {name}"))?;
        Ok(given
            .parse()
            .map_err(|_| format!("{name}: expected a whole number, not {given}"))?)
    };
    let (hands, threads, steps) = (number("HANDS")?, number("THREADS")?, number("STEPS")?);
    let config = EnvironmentConfig {
        experiment: arguments
            .next()
            .unwrap_or_else(|| "cap-closing".to_string()),
        action: ActionKind::World,
        ..EnvironmentConfig::default()
    };
    let before = memory();
    let mut vector = VectorEnvironment::new(&config, hands, threads, Autoreset::NextStep)?;
    let mut observations = vec![0.0; hands * vector.observation_len()];
    let mut infos = vec![0.0; hands * vector.info_len()];
    let (mut rewards, mut terminated, mut truncated) =
        (vec![0.0; hands], vec![false; hands], vec![false; hands]);
    let mut batch = Batch {
        observations: &mut observations,
        rewards: &mut rewards,
        terminated: &mut terminated,
        truncated: &mut truncated,
        infos: &mut infos,
    };
    let seeds: Vec<_> = (0..hands as u64).map(Some).collect();
    vector.reset(&seeds, None, &mut batch)?;
    let memory = memory().saturating_sub(before);
    let length = vector.action_len();
    let mut actions = vec![0.0; hands * length];
    let (mut took, mut total) = (Duration::ZERO, 0.0);
    for _ in 0..steps {
        for (index, action) in actions.chunks_exact_mut(length).enumerate() {
            vector.look(index, |environment| environment.guide(action))??;
        }
        let start = Instant::now();
        vector.step(&actions, &mut batch)?;
        took += start.elapsed();
        total += batch.rewards.iter().sum::<f64>();
    }
    println!(
        "{hands} hands, {threads} threads: {:.0} control steps/s, {:.1} kB a hand; rewards {total:.9}",
        (hands * steps) as f64 / took.as_secs_f64(),
        memory as f64 / 1e3 / hands as f64,
    );
    Ok(())
}

/// Resident memory of the process in bytes; 0 if unknown.
fn memory() -> usize {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let resident = pages
        .split_whitespace()
        .nth(1)
        .and_then(|pages| pages.parse::<usize>().ok());
    4096 * resident.unwrap_or(0)
}
