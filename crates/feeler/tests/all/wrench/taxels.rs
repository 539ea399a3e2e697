//! Wrenches from a taxel array: a synthetic magnetic skin with creep, and the sensor for the control loop.

use feeler::sensor::fingertip::CalibrationTarget;
use feeler::sensor::forces::{NO_FORCE, TactileFrame, TactileSensor};
use feeler::sensor::taxel::{BuiltInTaxels, TaxelLayout, TaxelSensor};
use feeler::sensor::wrench::taxels::{
    MeasuredAt, Memory, TIME_CONSTANTS, TaxelCalibration, TaxelInput, TaxelSeries,
    TaxelWrenchEstimator, TaxelWrenchSensor, TermKind, join,
};
use feeler::sensor::wrench::{AXES, WrenchAxis, WrenchError, fit};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::fmt::Write;
use std::sync::LazyLock;

fn layout() -> TaxelLayout {
    BuiltInTaxels::named("eflesh").unwrap().layout().unwrap()
}

fn target() -> CalibrationTarget {
    layout().calibration_target().unwrap()
}

/// Readings of five magnetometers, counts, if the skin is pressed by `depth` (mm) at `place` (mm): each measures the
/// field of a dipole with another direction that moves with the skin, less at a distance.
fn readings(place: [f64; 2], depth: f64, random: &mut Pcg64) -> Vec<DVec3> {
    let chips = [[0.0, 0.0], [-7.0, 0.0], [7.0, 0.0], [0.0, 7.0], [0.0, -7.0]];
    let reading = |(index, chip): (usize, &[f64; 2])| {
        let away = DVec3::new(place[0] - chip[0], place[1] - chip[1], 8.0);
        let near = depth * (-away.length_squared() / 150.0).exp();
        let turn = 0.9 * index as f64;
        let field = DVec3::new(turn.cos(), turn.sin(), 0.5 + 0.1 * near) * 300.0 * near;
        let noise = [(); 3].map(|()| random.random_range(-3.0..3.0));
        field + away * 4.0 * near + DVec3::from_array(noise)
    };
    chips.iter().enumerate().map(reading).collect()
}

fn input(memory: &mut Memory, stamp: f64, values: &[DVec3]) -> TaxelInput {
    let mut input = TaxelInput::default();
    memory.update(stamp, values, &mut input);
    input
}

/// Depth of a slow press at `time` (s), mm.
fn depth(time: f64) -> f64 {
    1.2 - 1.2 * (0.37 * time).cos() + 0.4 * (0.11 * time).sin().powi(2)
}

/// Presses with a viscoelastic skin: the force is 5 N/mm of depth, plus a Maxwell arm of 2 N/mm and 5 s, which the
/// magnetometers do not measure.
fn presses(rows: usize, seed: u64) -> TaxelSeries {
    const STEP: f64 = 0.05;
    let mut random = Pcg64::seed_from_u64(seed);
    let mut memory = Memory::new(5);
    let mut series = TaxelSeries::default();
    let mut slow = 0.0;
    for row in 0..rows {
        let stamp = STEP * row as f64;
        let now = depth(stamp + seed as f64);
        slow += (STEP / 5.0) * (now - slow);
        let mut wrench = [None; AXES];
        wrench[2] = Some(5.0 * now + 2.0 * (now - slow));
        series.measured.push(MeasuredAt {
            time: stamp,
            wrench,
        });
        series.stamps.push(stamp);
        let values = readings([1.0, -2.0], now, &mut random);
        series.inputs.push(input(&mut memory, stamp, &values));
    }
    series
}

/// Calibration to two recordings of presses.
static CALIBRATED: LazyLock<TaxelCalibration> = LazyLock::new(|| {
    let samples = join(&[presses(1200, 0), presses(1200, 7)], 0.0);
    let names = ["a".to_owned(), "b".to_owned()];
    fit(target(), &names, &samples, false).unwrap().calibration
});

/// The hidden arm has up to 2 N; without memory its standard deviation would remain. Noise of the readings (1.7 counts
/// of 100 per mm and taxel) is worth about 0.02 N.
#[test]
fn memory_explains_the_creep_of_a_skin() {
    let calibration = CALIBRATED.clone();
    let model = calibration.axis(WrenchAxis::ForceZ).unwrap();
    assert!(model.terms.memory, "{:?}", model.terms);
    let mut estimator = TaxelWrenchEstimator::new(calibration).unwrap();
    let unseen = presses(1200, 3);
    let (mut squares, mut arm, mut valid) = (0.0, 0.0, 0);
    for ((stamp, input), measured) in unseen
        .stamps
        .iter()
        .zip(&unseen.inputs)
        .zip(&unseen.measured)
    {
        let estimate = estimator.estimate(*stamp, &input.values);
        let force = measured.wrench[2].unwrap();
        squares += (estimate.component(WrenchAxis::ForceZ).unwrap() - force).powi(2);
        arm += (force - 5.0 * depth(stamp + 3.0)).powi(2);
        valid += usize::from(estimate.valid);
    }
    let error = (squares / arm).sqrt();
    assert!(error < 0.2, "{error} of the hidden arm is left");
    assert!(valid > 1000, "{valid} of 1200 rows are valid");
}

/// The direction of all readings together reveals the place of touches of unknown depth, which products of readings do
/// not. A grid of 1 mm; 0.25 mm is what the noise of 3 counts allows at the smallest depth.
#[test]
fn place_is_read_from_the_pattern() {
    let mut random = Pcg64::seed_from_u64(11);
    let mut touches = |count: usize| {
        let mut series = TaxelSeries::default();
        for row in 0..count {
            let place = [(); 2].map(|()| random.random_range(-7.0..7.0));
            let depth = random.random_range(0.5..3.0);
            let mut wrench = [None; AXES];
            (wrench[6], wrench[7]) = (Some(place[0] * 1e-3), Some(place[1] * 1e-3));
            let stamp = 4.0 * row as f64;
            let values = readings(place, depth, &mut random);
            series
                .inputs
                .push(input(&mut Memory::new(5), stamp, &values));
            series.measured.push(MeasuredAt {
                time: stamp,
                wrench,
            });
            series.stamps.push(stamp);
        }
        series.forget_if_sparse();
        series
    };
    let samples = join(&[touches(1000)], 0.0);
    let fitted = fit(target(), &["touches".to_owned()], &samples, false).unwrap();
    let axes = [WrenchAxis::PlaceX, WrenchAxis::PlaceY];
    for axis in axes {
        let terms = fitted.calibration.axis(axis).unwrap().terms;
        assert_eq!((terms.kind, terms.memory), (TermKind::Pattern, false));
    }
    let mut estimator = TaxelWrenchEstimator::new(fitted.calibration).unwrap();
    let unseen = touches(300);
    let mut sum = 0.0;
    for (input, measured) in unseen.inputs.iter().zip(&unseen.measured) {
        estimator.restart();
        let estimate = estimator.estimate(0.0, &input.values);
        for axis in axes {
            let place = measured.wrench[axis.index()].unwrap();
            sum += (estimate.component(axis).unwrap() - place).abs() / 600.0;
        }
    }
    assert!(sum < 0.25e-3, "mean absolute error {sum} m");
    // An untouched skin has no place of contact.
    let untouched = readings([0.0; 2], 0.0, &mut Pcg64::seed_from_u64(1));
    let estimate = estimator.estimate(1.0, &untouched);
    assert_eq!(axes.map(|axis| estimate.component(axis)), [None; 2]);
}

#[test]
fn filters_follow_a_step_as_in_the_closed_form() {
    let mut memory = Memory::new(1);
    let step = [DVec3::new(0.0, 0.0, 8.0)];
    let mut last = input(&mut memory, 0.0, &step);
    for row in 1..=200 {
        last = input(&mut memory, 0.01 * f64::from(row), &step);
        // Neither a row of the same time nor a missing reading has an effect.
        input(&mut memory, 0.01 * f64::from(row), &step);
    }
    let missing = input(&mut memory, 2.0, &[DVec3::NAN]);
    assert_eq!(missing.filtered, last.filtered);
    for (filtered, constant) in last.filtered[0].iter().zip(TIME_CONSTANTS) {
        let exact = 8.0 * (1.0 - (-2.0 / constant).exp());
        assert!(
            (filtered.z - exact).abs() < 1e-9,
            "{} for {exact}",
            filtered.z
        );
    }
    // A clock that starts again does not stop the filters.
    input(&mut memory, 0.0, &step);
    let again = input(&mut memory, 1.0, &step);
    assert!(again.filtered[0][4].z > last.filtered[0][4].z);
}

#[test]
fn files_are_read_back_and_checked() {
    let calibration = CALIBRATED.clone();
    let text = calibration.to_toml().unwrap();
    assert_eq!(TaxelCalibration::from_toml(&text).unwrap(), calibration);
    for (from, to, message) in [
        (
            "kind = \"taxel_wrench\"",
            "kind = \"wrench\"",
            "expected kind = \"taxel_wrench\"",
        ),
        (
            "norm_floor = ",
            "norm_floor = -",
            "model.elements.norm_floor",
        ),
        ("penalty = ", "penalty = -", "f_z.penalty"),
    ] {
        let broken = text.replacen(from, to, 1);
        let error = TaxelCalibration::from_toml(&broken)
            .unwrap_err()
            .to_string();
        assert!(error.contains(message), "{error}");
    }
}

/// Forces of all three axes of the table below, as read from its taxels.
fn sensor_of(table: &str) -> TaxelWrenchSensor<&[u8]> {
    let mut random = Pcg64::seed_from_u64(5);
    let mut memory = Memory::new(5);
    let mut series = TaxelSeries::default();
    for row in 0..400 {
        let stamp = 0.01 * f64::from(row);
        let force = [(); 3].map(|()| random.random_range(-2.0..2.0));
        let values = vec![100.0 * DVec3::from_array(force); 5];
        let mut wrench = [None; AXES];
        wrench[..3].copy_from_slice(&force.map(Some));
        series.inputs.push(input(&mut memory, stamp, &values));
        series.measured.push(MeasuredAt {
            time: stamp,
            wrench,
        });
        series.stamps.push(stamp);
    }
    let samples = join(&[series], 0.0);
    let calibration = fit(target(), &["random".to_owned()], &samples, false).unwrap();
    let estimator = TaxelWrenchEstimator::new(calibration.calibration).unwrap();
    let taxels = TaxelSensor::open(table.as_bytes(), &layout(), None).unwrap();
    TaxelWrenchSensor::new(taxels, estimator).unwrap()
}

/// The sensor reports the calibrated force with its z as compression, and no force far from the calibration.
#[test]
fn a_taxel_array_is_a_fingertip_of_one_element() {
    let names = (0..5).flat_map(|n| ["x", "y", "z"].map(|axis| format!("{n}_{axis}")));
    let mut table = names.collect::<Vec<_>>().join(",") + "\n";
    for z in [0.0, 150.0, 1e5] {
        let repeat = if z == 0.0 { 10 } else { 1 };
        for _ in 0..repeat {
            let cells: Vec<_> = (0..5).map(|_| format!("0,0,{z}")).collect();
            writeln!(table, "{}", cells.join(",")).unwrap();
        }
    }
    let mut sensor = sensor_of(&table);
    let mut frame = TactileFrame::unloaded(1);
    for _ in 0..10 {
        sensor.read(&mut frame).unwrap();
    }
    assert!(frame.forces[0].length() < 0.02, "{:?}", frame.forces[0]);
    sensor.read(&mut frame).unwrap();
    // Pressing gives a positive z of the element for a negative f_z.
    let felt = sensor.estimate().unwrap().force().unwrap();
    assert!((felt.z - 1.5).abs() < 0.03, "{felt}");
    assert_eq!(frame.forces[0].z, -felt.z);
    assert_eq!((frame.sequence, frame.stamp), (10, 0.1));
    sensor.read(&mut frame).unwrap();
    assert!(frame.forces[0].to_array().map(f64::to_bits) == NO_FORCE.to_array().map(f64::to_bits));
    assert!(sensor.read(&mut frame).is_err());
}

#[test]
fn a_sensor_requires_all_forces() {
    let table = "0_x,0_y,0_z,1_x,1_y,1_z,2_x,2_y,2_z,3_x,3_y,3_z,4_x,4_y,4_z\n";
    let taxels = TaxelSensor::open(table.as_bytes(), &layout(), None).unwrap();
    let estimator = TaxelWrenchEstimator::new(CALIBRATED.clone()).unwrap();
    let refused = TaxelWrenchSensor::new(taxels, estimator).unwrap_err();
    assert!(matches!(refused, WrenchError::Missing { missing: "f_x" }));
}
