//! Margins of each claim of an experiment over many seeds.
//!
//! ```sh
//! cargo run --release --example claim_margins -- cap-closing direct 0 99
//! cargo run --release --example claim_margins -- cap-closing image 0 99 sensor.calibration='"reference-fingertip.calibration.toml"'
//! ```

use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Pictures, Session};
use feeler_report::{Claim, tasks};
use std::collections::BTreeMap;
use std::error::Error;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

type AnyError = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), AnyError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, sensing, first, last, settings @ ..] = &arguments[..] else {
        return Err("expected: EXPERIMENT direct|image FIRST_SEED LAST_SEED [KEY=VALUE…]".into());
    };
    let (next, last) = (AtomicU64::new(first.parse()?), last.parse::<u64>()?);
    let runs = Mutex::new(BTreeMap::new());
    let work = || -> Result<(), AnyError> {
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed > last {
                return Ok(());
            }
            let mut settings = settings.to_vec();
            settings.extend([format!("sensing={sensing}"), format!("seed={seed}")]);
            let claims = claims(name, &settings)?;
            runs.lock().expect("no thread panics").insert(seed, claims);
        }
    };
    std::thread::scope(|scope| {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        let mut ended = threads
            .into_iter()
            .map(|thread| thread.join().expect("no panic"));
        ended.try_for_each(|result| result)
    })?;
    print(&runs.into_inner()?);
    Ok(())
}

/// Returns the claims of a run of the experiment `name` with `settings`.
fn claims(name: &str, settings: &[String]) -> Result<Vec<Claim>, AnyError> {
    let experiment = Experiment::load(name, settings)?;
    let mut session = Session::rendering(&experiment, Pictures::Sensed)?;
    let (recording, data) = session.run_in_memory(&experiment.config)?;
    Ok(tasks::of(&recording.facts).claims(&recording, &data, &data.stroke_measures()))
}

fn print(runs: &BTreeMap<u64, Vec<Claim>>) {
    let all = runs
        .values()
        .filter(|claims| claims.iter().all(|claim| claim.holds));
    println!(
        "all claims pass in {} of {} runs\n",
        all.count(),
        runs.len()
    );
    println!("| claim | passes | margin: minimum / 10 % / median | failing seeds |");
    println!("|---|---|---|---|");
    let Some(claims) = runs.values().next() else {
        return;
    };
    for (index, claim) in claims.iter().enumerate() {
        // A missing measurement counts as the worst margin.
        let margin = |claims: &Vec<Claim>| claims[index].margin().unwrap_or(-1.0);
        let mut margins: Vec<f64> = runs.values().map(margin).collect();
        margins.sort_by(f64::total_cmp);
        let at = |share: f64| 100.0 * margins[(share * (margins.len() - 1) as f64) as usize];
        let broken = runs.iter().filter(|(_, claims)| !claims[index].holds);
        let broken: Vec<_> = broken.map(|(seed, _)| seed.to_string()).collect();
        println!(
            "| {} | {} | {:.0} / {:.0} / {:.0} % | {} |",
            claim.id,
            runs.len() - broken.len(),
            at(0.0),
            at(0.1),
            at(0.5),
            broken.join(", ")
        );
    }
}
