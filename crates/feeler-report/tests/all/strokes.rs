//! Measures of one stroke on handmade columns.

use crate::support;
use feeler_record::Phase;
use feeler_report::StrokeMeasures;
use feeler_report::run::{FingerColumns, RunData, Stroke};
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;

const ROWS: usize = 1001;

/// A stroke in which the shear rate of each finger takes the values 0, 1, .. 1000 times its `rate` (N/s) in mixed order
/// and the torque rises to `torque` (N m).
fn data(rates: &[f64], torque: f64) -> RunData {
    let finger = |&rate: &f64| FingerColumns {
        grasp_force: vec![1.0; ROWS],
        touch: vec![true; ROWS],
        slip: vec![false; ROWS],
        over: vec![false; ROWS],
        slipped: vec![None; ROWS],
        largest_element: vec![Some(0); ROWS],
        // 389 and 1001 are coprime: each value occurs once.
        shear_rate: (0..ROWS)
            .map(|row| rate * (389 * row % ROWS) as f64)
            .collect(),
        forces: (0..ROWS).map(|_| [DVec3::Z]).collect(),
        largest_force: vec![1.0; ROWS],
        position: vec![DVec3::ZERO; ROWS],
        rotation: vec![DQuat::IDENTITY; ROWS],
        frames: (0..ROWS).map(|_| [0.0; 3]).collect(),
        geometry: None,
        tips: vec![DVec3::X],
    };
    RunData {
        facts: support::facts(),
        time: (0..ROWS).map(|row| row as f64 * support::PERIOD).collect(),
        phase: vec![Phase::Move; ROWS],
        torque: Some((0..ROWS).map(|row| torque * row as f64 / 1000.0).collect()),
        cap: None,
        fingers: rates.iter().map(finger).collect(),
        strokes: Vec::new(),
        findings: BTreeMap::new(),
        object: None,
        longest_loss: None,
        thinned: None,
    }
}

#[test]
fn the_peak_shear_rate_is_the_99th_percentile() {
    let stroke = Stroke {
        index: 1,
        rows: 0..ROWS,
        moving: 0..ROWS,
        whole: true,
    };
    let data = data(&[0.01, 0.03], 0.05);
    let measures = StrokeMeasures::new(&data, &stroke);
    // 990 of 0..=1000 for each finger, mean of both, up to rounding.
    let peak = measures.peak_shear_rate.expect("a shear rate");
    assert!((peak - 0.02 * 990.0).abs() < 1e-12, "{peak} N/s");
    let above = |finger: &FingerColumns| {
        let rates = finger.shear_rate.iter();
        rates
            .filter(|&&rate| rate > peak * finger.shear_rate[1] / (0.02 * 389.0))
            .count()
    };
    assert!(data.fingers.iter().all(|finger| above(finger) == 10));
    assert_eq!(measures.peak_torque, Some(0.05));
}
