//! Random parameters of a sweep's trials, and resuming interrupted sweeps.

use feeler_lab::config::Experiment;
use feeler_lab::sweep::results::{GROWING, line};
use feeler_lab::sweep::trial::Trials;
use feeler_lab::sweep::{Ended, Plan, Progress, Store, engine};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::{fs, io};

/// A sweep over `vary` with `trials` trials of a tenth of a second.
fn trials(vary: &[&str], trials: u64) -> Trials {
    let settings = ["sensing=direct", "time_limit=0.1"].map(String::from);
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/stiff-feelers.toml");
    let experiment = Experiment::load(file, &settings).expect("the rig");
    let vary: Vec<_> = vary.iter().map(|text| (*text).to_string()).collect();
    let plan = Plan::new(&experiment, file, &vary, 7, trials).expect("a plan");
    Trials::new(&plan).expect("a sweep")
}

const FRICTION: &str = "sim.variation.friction=uniform(0,0.5)";
const SPEED: &str = "control.recompression_speed=uniform(0.001,0.005)";
const OVER: &str = "control.over_force=uniform(1,3)";

/// Seeds and parameter values of trials 0 to 399; values are scaled to the range 0 to 1.
fn drawn(vary: &[&str]) -> (Vec<u64>, Vec<Vec<f64>>) {
    let trials = trials(vary, 400);
    let draws: Vec<_> = (0..400).map(|trial| trials.draw(trial)).collect();
    let number = |text: &str| -> f64 { text.parse().expect("a number") };
    let values = vary.iter().enumerate().map(|(index, parameter)| {
        let range = parameter.split(['(', ',', ')']).skip(1).take(2).map(number);
        let [low, high] = range.collect::<Vec<_>>()[..] else {
            panic!("a range: {parameter}")
        };
        let values = draws.iter().map(|drawn| number(&drawn.values[index]));
        values.map(|value| (value - low) / (high - low)).collect()
    });
    (draws.iter().map(|d| d.seed).collect(), values.collect())
}

#[test]
fn values_of_a_parameter_do_not_depend_on_other_parameters() {
    let (seeds, one) = drawn(&[OVER]);
    let (seeds_beside, beside) = drawn(&[FRICTION, SPEED, OVER]);
    assert_eq!(seeds, seeds_beside);
    assert_eq!(one[0], beside[2]);
}

#[test]
fn trials_and_parameters_draw_independently() {
    let (seeds, values) = drawn(&[FRICTION, SPEED, OVER]);
    assert_eq!(seeds.iter().collect::<BTreeSet<_>>().len(), 400);
    // Values are uniform from 0 to 1: mean 1/2, variance 1/12. The bounds are five standard deviations: 1/sqrt(12 *
    // 400) of the mean of 400 values, and 1/sqrt(400) of the correlation of independent ones.
    let deviation = |v: &[f64]| -> Vec<f64> { v.iter().map(|x| x - 0.5).collect() };
    let seeds: Vec<f64> = seeds.iter().map(|&s| s as f64 / 2_f64.powi(63)).collect();
    let series: Vec<_> = values
        .iter()
        .chain([&seeds])
        .map(|v| deviation(v))
        .collect();
    for (index, a) in series.iter().enumerate() {
        let mean = a.iter().sum::<f64>() / 400.0;
        assert!(mean.abs() < 0.0722, "mean {mean} of {index}");
        for (other, b) in series.iter().enumerate().skip(index + 1) {
            let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            let correlation = 12.0 * product / 400.0;
            assert!(
                correlation.abs() < 0.25,
                "{correlation} of {index} and {other}"
            );
        }
        // Successive trials.
        let product: f64 = a.windows(2).map(|pair| pair[0] * pair[1]).sum();
        let correlation = 12.0 * product / 399.0;
        assert!(
            correlation.abs() < 0.25,
            "{correlation} of {index} and the next trial"
        );
    }
}

/// Counts completed trials.
#[derive(Default)]
struct Count(u64);

impl Progress for Count {
    fn show(&mut self, _: u64, of: u64, _: u64) {
        assert_eq!(of, 5);
        self.0 += 1;
    }
}

/// An empty folder for a test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    match fs::remove_dir_all(&folder) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => panic!("{error}"),
        _ => folder,
    }
}

#[test]
fn a_resumed_sweep_runs_all_missing_trials() {
    let trials = trials(&["control.recompression_speed=uniform(0.002,0.004)"], 5);
    let stop = AtomicBool::new(false);
    let row = |trial| trials.run(trial, &stop).expect("an uninterrupted trial");
    let rows: Vec<_> = (0..5).map(row).collect();
    // Threads finish in any order, so rows on disk may have gaps before, between and after them.
    for (number, kept) in [vec![], vec![2], vec![4, 1], vec![3, 0, 4]]
        .iter()
        .enumerate()
    {
        let folder = folder(&format!("resumed-{number}"));
        let plan = trials.plan();
        let store = Store::create(&folder, plan, trials.header()).expect("a folder");
        drop(store);
        let lines = kept.iter().map(|&trial: &usize| line(&rows[trial]));
        let text = [line(&trials.header()), lines.flatten().collect()].concat();
        fs::write(folder.join(GROWING), text).expect("the table");
        let mut store = Store::resume(&folder, plan, trials.header()).expect("a sweep");
        let mut count = Count::default();
        let ended = engine::run(&trials, &mut store, 5, 2, &stop, &mut count).expect("a run");
        assert_eq!(
            (ended, count.0),
            (Ended::Whole, 5 - kept.len() as u64),
            "{kept:?}"
        );
        let table = store.finish().expect("the table");
        assert!(
            table.rows.into_values().eq(rows.iter().cloned()),
            "{kept:?}"
        );
    }
}

#[test]
fn a_stopped_trial_has_no_row() {
    let trials = trials(&[], 1);
    assert_eq!(trials.run(0, &AtomicBool::new(true)), None);
}

#[test]
fn rows_of_another_machine_are_merged_once_and_completely_or_rejected() {
    let trials = trials(&[], 3);
    let plan = trials.plan();
    let stop = AtomicBool::new(false);
    let rows = |numbers: &[u64]| {
        let rows = numbers.iter().filter_map(|&n| trials.run(n, &stop));
        let lines = rows.map(|row| line(&row));
        [line(&trials.header()), lines.flatten().collect()].concat()
    };
    let folder = folder("pushed");
    let mut store = Store::create(&folder, plan, trials.header()).expect("a folder");
    store
        .push_table(plan, &rows(&[2, 0]))
        .expect("rows of this sweep");
    assert_eq!(store.missing(plan, 3), [1]);
    let torn = rows(&[1]);
    for (wrong, expected) in [
        (rows(&[1, 0]), "does not belong to this table"),
        (rows(&[1, 1]), "twice"),
        (b"trial,seed\n1,2\n".to_vec(), "columns"),
        (torn[..torn.len() - 2].to_vec(), "within a line"),
        ([&torn[..torn.len() / 2], b"\n"].concat(), "columns"),
        (Vec::new(), "complete lines"),
    ] {
        let error = store.push_table(plan, &wrong).expect_err(expected);
        assert!(error.to_string().contains(expected), "{error}");
        assert_eq!(store.missing(plan, 3), [1], "{expected}");
    }
}

/// Files that trials of the built-in `cap-closing` read with these settings.
fn files(settings: &[&str], vary: &[&str]) -> Result<Vec<String>, String> {
    let texts = |texts: &[&str]| texts.iter().map(|t| (*t).to_string()).collect::<Vec<_>>();
    let experiment = Experiment::load("cap-closing", &texts(settings)).expect("an experiment");
    let plan = Plan::new(&experiment, "cap-closing", &texts(vary), 0, 1).expect("a plan");
    let files = plan.files().map_err(|error| error.to_string())?;
    assert!(files.values().all(|bytes| !bytes.is_empty()));
    Ok(files.into_keys().collect())
}

#[test]
fn other_machines_require_the_files_that_trials_may_read() {
    const REFERENCE: &str = "reference-fingertip.calibration.toml";
    const COUPLED: &str = "reference-fingertip.coupled.calibration.toml";
    let both = format!("calibration=choice({REFERENCE},{COUPLED})");
    assert_eq!(
        files(&[], &[&both]),
        Ok([REFERENCE, COUPLED].map(String::from).to_vec())
    );
    let named = |file: &str| files(&[&format!("sensor.calibration={file}")], &[]);
    let missing = named("no/such.toml").expect_err("a missing file");
    assert!(
        missing.contains("no/such.toml") && missing.contains("sensor.calibration"),
        "{missing}"
    );
    for outside in ["../Cargo.toml", "/etc/hostname"] {
        let said = named(outside).expect_err("a file outside the experiment's folder");
        assert!(
            said.contains("in the experiment's folder or below"),
            "{said}"
        );
    }
    assert_eq!(
        files(&["sensing=direct", "sensor.calibration=no/such.toml"], &[]),
        Ok(Vec::new())
    );
}
