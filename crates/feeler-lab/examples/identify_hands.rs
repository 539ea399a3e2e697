//! Coverage and errors of `feeler identify` over plausible hands, drawn as in `feeler robustness cap-closing`.
//!
//! `cargo run --release -p feeler-lab --example identify_hands -- 500 9000 [KEY=VALUE]...`: number of hands, seed of
//! the hands, settings. Prints for each quantity the fraction of hands whose interval contains the true value, and the
//! median and 95th percentile of the error.

use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_lab::identify::{Estimate, Identified, estimate, probe, probing};
use feeler_lab::sweep::Plan;
use feeler_lab::sweep::plan::{Design, ranges};
use feeler_lab::sweep::trial::Trials;
use feeler_sim::rig::FaultKind;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

type AnyError = Box<dyn Error + Send + Sync>;

/// F2 of an element with the reference stiffness (N). F2 is scaled with the square root of the stiffness.
const OVER_FORCE: f64 = 0.505;
const REFERENCE_STIFFNESS: f64 = 205.0;

/// Comparison of an estimate with the true value.
struct Checked {
    name: &'static str,
    covered: bool,
    error: f64,
}

fn main() -> Result<(), AnyError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [count, seed, settings @ ..] = &arguments[..] else {
        return Err("expected the number of hands, their seed, and settings as KEY=VALUE".into());
    };
    let hands = hands(settings, count.parse()?, seed.parse()?)?;
    let mut quantities: BTreeMap<&str, Vec<Checked>> = BTreeMap::new();
    let (mut failed, mut longest, mut hardest) = (0, 0.0_f64, 0.0_f64);
    for (number, hand) in hands.iter().enumerate() {
        let probing = probing(hand)?;
        let identified = probe(&probing).map_err(AnyError::from).and_then(|trace| {
            let rows = trace.fingers.iter().flat_map(|finger| &finger.rows);
            for row in rows {
                longest = longest.max(row.time);
                hardest = hardest.max(row.greatest() / hand.config.control.over_force);
            }
            Ok(estimate(&trace, &hand.config.name, hand.config.seed)?.0)
        });
        match identified {
            Ok(identified) => {
                for checked in check(&identified, &probing)? {
                    quantities.entry(checked.name).or_default().push(checked);
                }
            }
            Err(error) => {
                failed += 1;
                println!("hand {number}: {error}");
            }
        }
    }
    println!(
        "{} hands, {failed} failed, longest {longest:.1} s, greatest force {hardest:.2} F2",
        hands.len()
    );
    println!(
        "{:28} {:>9} {:>9} {:>9} {:>9}",
        "quantity", "covered %", "bias", "median", "95th"
    );
    for (name, checked) in &quantities {
        print(name, checked);
    }
    Ok(())
}

fn print(name: &str, checked: &[Checked]) {
    let count = checked.len() as f64;
    let covered = checked.iter().filter(|c| c.covered).count() as f64 / count;
    let bias = checked.iter().map(|c| c.error).sum::<f64>() / count;
    let mut errors: Vec<f64> = checked.iter().map(|c| c.error.abs()).collect();
    errors.sort_by(f64::total_cmp);
    let quantile = |q: f64| errors[((errors.len() - 1) as f64 * q).round() as usize];
    println!(
        "{name:28} {:9.1} {bias:9.4} {:9.4} {:9.4}",
        100.0 * covered,
        quantile(0.5),
        quantile(0.95)
    );
}

/// Draws plausible hands with `seed`, with F2 scaled to their stiffness.
fn hands(settings: &[String], count: u64, seed: u64) -> Result<Vec<Experiment>, AnyError> {
    let files: [&Path; 0] = [];
    let mut ranges = ranges::load(&files, "cap-closing")?;
    ranges.parameter.retain(|entry| entry.group == "apparatus");
    let settings = [settings, &["sensing=direct".into()]].concat();
    let experiment = Experiment::load("cap-closing", &settings)?;
    let design = Design {
        rows: count,
        controls: 0,
        pairs: 1,
    };
    let plan = Plan::designed(&experiment, "cap-closing", ranges.parameter, design, seed)?;
    let trials = Trials::new(&plan)?;
    (0..count)
        .map(|trial| {
            let hand = trials.experiment(trial)?;
            let stiffness = hand.config.simulation()?.feeler.normal_stiffness;
            let over_force = OVER_FORCE * (stiffness / REFERENCE_STIFFNESS).sqrt();
            Ok(hand.with_settings(&[format!("control.over_force={over_force}")])?)
        })
        .collect()
}

/// Compares all estimates of `probing` with the ground truth.
fn check(identified: &Identified, probing: &Experiment) -> Result<Vec<Checked>, AnyError> {
    let session = Session::new(probing)?;
    let world = session.rig().world();
    let sim = probing.config.simulation()?;
    let axis = world.state().objects[0].pose.position;
    let radius = feeler_lab::experiment::run_facts(&probing.config)?.cap_radius;
    let compare = |name, estimate: &Estimate, truth: f64, unit: f64| Checked {
        name,
        covered: (estimate.low..=estimate.high).contains(&truth),
        error: (estimate.value - truth) / unit,
    };
    let object = &identified.object;
    let mut all = vec![
        compare("pivot x, mm", &object.pivot_x, axis.x, 1e-3),
        compare("pivot y, mm", &object.pivot_y, axis.y, 1e-3),
        compare("radius, mm", &object.radius, radius, 1e-3),
    ];
    for (index, finger) in identified.finger.iter().enumerate() {
        let feeler = &world.model().fingers[index].feelers[0];
        let latency = sim.fault.iter().filter_map(|fault| match fault.kind {
            FaultKind::CameraLatency { finger, delay } if finger == index => Some(delay),
            _ => None,
        });
        let (normal, shear) = (feeler.normal_stiffness, feeler.shear_stiffness);
        let noise = sim.direct_sensing.normal_noise;
        all.extend([
            compare("force noise, %", &finger.force_noise, noise, 0.01 * noise),
            compare(
                "normal stiffness, %",
                &finger.normal_stiffness,
                normal,
                0.01 * normal,
            ),
            compare(
                "shear stiffness, %",
                &finger.shear_stiffness,
                shear,
                0.01 * shear,
            ),
            compare("hysteresis, %", &finger.hysteresis, 0.0, 0.01),
            compare(
                "static friction",
                &finger.static_friction,
                feeler.static_friction,
                1.0,
            ),
            compare(
                "kinetic friction",
                &finger.kinetic_friction,
                feeler.kinetic_friction,
                1.0,
            ),
            compare("servo lag, ms", &finger.servo_lag, sim.servo.lag, 1e-3),
            compare("dead time, ms", &finger.dead_time, latency.sum(), 1e-3),
        ]);
    }
    Ok(all)
}
