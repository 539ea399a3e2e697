//! Success rate of tuning over plausible hands: the fraction of hands on which all five claims about the hand pass.
//!
//! ```sh
//! cargo run --release -p feeler-lab --example tune_hands -- HANDS HAND_SEED RUN_SEED [RUNS]
//! ```
//!
//! Draws HANDS hands of the group `apparatus` of cap-closing, identifies each with an error, tunes it by the rules or,
//! with RUNS, by a search of that number of simulated runs, and evaluates one run of the true hand. An identified
//! value is the true value plus a normally distributed error. The stated 95 % intervals are 5 % for stiffness, 0.03
//! for friction, 2 ms for lag, 0.7 mm for the radius and 0.5 mm for the pivot.

use feeler_lab::config::{ConfigError, Experiment};
use feeler_lab::identify::{Estimate, FingerEstimates, Identified, ObjectEstimates};
use feeler_lab::sweep::Plan;
use feeler_lab::sweep::plan::{Design, ranges};
use feeler_lab::sweep::trial::Trials;
use feeler_lab::tune::hand::{Hand, rated_force};
use feeler_lab::tune::judge::{CLAIM_IDS, Margins, judge_all};
use feeler_lab::tune::rules::SETTINGS;
use feeler_lab::tune::search::{Budget, Problem, search};
use feeler_lab::tune::settings::Settings;
use feeler_lab::tune::uncertainty::Uncertainty;
use feeler_report::figures::sweep::wilson;
use feeler_sim::shapes::ShapeConfig;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const EXPERIMENT: &str = "cap-closing";
/// Half the width of a 95 % interval in standard deviations.
const Z: f64 = 1.96;

type AnyError = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), AnyError> {
    let numbers: Result<Vec<u64>, _> = std::env::args().skip(1).map(|a| a.parse()).collect();
    let (count, hand_seed, run_seed, runs) = match numbers?[..] {
        [count, hand_seed, run_seed] => (count, hand_seed, run_seed, None),
        [count, hand_seed, run_seed, runs] => (count, hand_seed, run_seed, Some(runs)),
        _ => return Err("expected HANDS HAND_SEED RUN_SEED [RUNS]".into()),
    };
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let hands = hands(count, hand_seed)?;
    let (mut by_rules, mut by_search) = (Vec::new(), Vec::new());
    for (index, hand) in hands.iter().enumerate() {
        let seed = (hand_seed << 20) | index as u64;
        let identified = identified(hand, seed)?;
        let known = Hand::new(hand, &identified, None)?;
        let limit = hand.config.control.limits.fingertip_speed;
        let tuned = |settings: &Settings| {
            let mut tuned = hand.clone();
            tuned.config.seed = run_seed;
            settings.apply(&mut tuned.config, known.pivot);
            tuned
        };
        by_rules.push(tuned(&Settings::new(&known, &[0.0; SETTINGS], limit)));
        let Some(runs) = runs else { continue };
        let nominal = Experiment::load(EXPERIMENT, &[])?;
        let uncertainty = Uncertainty::new(&nominal, &identified, seed)?;
        let problem = Problem {
            hand: known,
            uncertainty: &uncertainty,
            fingertip_speed: limit,
            jobs,
            stop: &AtomicBool::new(false),
        };
        let budget = Budget {
            time: None,
            runs: Some(runs),
        };
        let found = search(&problem, budget, seed, &mut |_, _| {})?;
        by_search.push(tuned(&found.settings));
        if by_search.len() % 10 == 0 {
            report("so far, by search", &by_search, jobs)?;
        }
    }
    report("experiment as it is", &as_it_is(&hands, run_seed)?, jobs)?;
    report("by rules", &by_rules, jobs)?;
    if runs.is_some() {
        report("by search", &by_search, jobs)?;
    }
    Ok(())
}

/// Draws plausible hands with directly sensed forces.
fn hands(count: u64, seed: u64) -> Result<Vec<Experiment>, AnyError> {
    let files: [&Path; 0] = [];
    let mut ranges = ranges::load(&files, EXPERIMENT)?;
    ranges.parameter.retain(|entry| entry.group == "apparatus");
    let experiment = Experiment::load(EXPERIMENT, &["sensing=direct".into()])?;
    let design = Design {
        rows: count.next_multiple_of(2),
        controls: 0,
        pairs: 1,
    };
    let plan = Plan::designed(&experiment, EXPERIMENT, ranges.parameter, design, seed)?;
    let trials = Trials::new(&plan)?;
    (0..count).map(|k| Ok(trials.experiment(k)?)).collect()
}

/// Returns the hands with the settings of the experiment, except for F2, which is the rated force of the elements.
fn as_it_is(hands: &[Experiment], run_seed: u64) -> Result<Vec<Experiment>, ConfigError> {
    let mut hands = hands.to_vec();
    for hand in &mut hands {
        let stiffness = hand.config.simulation()?.feeler.normal_stiffness;
        hand.config.control.over_force = rated_force(stiffness);
        hand.config.seed = run_seed;
    }
    Ok(hands)
}

/// Returns the values of `hand` with random identification errors that depend on `seed`.
fn identified(hand: &Experiment, seed: u64) -> Result<Identified, AnyError> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut estimate = |truth: f64, half: f64| {
        let value = truth + half / Z * random.sample::<f64, _>(StandardNormal);
        Estimate {
            value,
            low: value - half,
            high: value + half,
            method: "true value with an error".to_string(),
        }
    };
    let config = &hand.config;
    let sim = config.simulation()?;
    let (_, cap, _) = config.cap().ok_or("no cap")?;
    let ShapeConfig::Cylinder { radius, .. } = cap.shape else {
        return Err("the cap is not a cylinder".into());
    };
    let feeler = &sim.feeler;
    let noise = sim.direct_sensing.normal_noise;
    let finger = FingerEstimates {
        force_noise: estimate(noise, 0.1 * noise),
        normal_stiffness: estimate(feeler.normal_stiffness, 0.05 * feeler.normal_stiffness),
        shear_stiffness: estimate(feeler.shear_stiffness, 0.05 * feeler.shear_stiffness),
        hysteresis: estimate(0.0, 0.01),
        static_friction: estimate(feeler.static_friction, 0.03),
        kinetic_friction: estimate(feeler.kinetic_friction, 0.03),
        servo_lag: positive(estimate(sim.servo.lag, 0.002)),
        dead_time: estimate(config.control.period, 0.002),
    };
    Ok(Identified {
        experiment: config.name.clone(),
        seed,
        warnings: Vec::new(),
        object: ObjectEstimates {
            pivot_x: estimate(cap.position[0], 0.0005),
            pivot_y: estimate(cap.position[1], 0.0005),
            radius: estimate(radius, 0.0007),
        },
        finger: vec![finger; config.hand.finger.len()],
    })
}

/// Limits an estimate of a positive quantity.
fn positive(estimate: Estimate) -> Estimate {
    let least = |x: f64| x.max(1e-4);
    Estimate {
        value: least(estimate.value),
        low: least(estimate.low),
        high: least(estimate.high),
        ..estimate
    }
}

/// Prints the fraction of `hands` on which all claims pass, and the fraction for each claim.
fn report(name: &str, hands: &[Experiment], jobs: usize) -> Result<(), AnyError> {
    let margins = judge_all(hands, jobs, &AtomicBool::new(false))?.unwrap_or_default();
    let share = |held: &dyn Fn(&Margins) -> bool| {
        let count = margins.iter().filter(|m| held(m)).count() as u64;
        let (low, high) = wilson(count, margins.len() as u64);
        let share = count as f64 / margins.len() as f64;
        let [low, share, high] = [low, share, high].map(|part| 100.0 * part);
        format!("{share:.1} % [{low:.1}, {high:.1}]")
    };
    println!(
        "{name}, {} hands: all five {}",
        hands.len(),
        share(&Margins::hold)
    );
    for (index, id) in CLAIM_IDS.iter().enumerate() {
        println!("  {id}: {}", share(&|m| m.0[index] >= 0.0));
    }
    Ok(())
}
