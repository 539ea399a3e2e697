//! Reading a sensor and rendering its simulated image do not allocate.

use assert_no_alloc::assert_no_alloc;
use feeler::sensor::calibration::ModelChoice;
use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::forces::{
    DriftConfig, ElementReading, OpticalSensor, SensingChain, TactileFrame, TactileSensor,
};
use feeler::sensor::image::{Camera, CameraError, Frame};
use feeler::sensor::taxel::{BuiltInTaxels, TaxelSensor};
use feeler::sensor::wrench::taxels::{
    MeasuredAt, Memory, TaxelInput, TaxelSeries, TaxelWrenchEstimator, join,
};
use feeler::sensor::wrench::{AXES, fit};
use feeler_sim::bench::{CalibrationBenchConfig, calibrate_simulated};
use feeler_sim::optics::{OpticsConfig, OpticsModel, OpticsScratch, render};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

struct SimulatedCamera(OpticsModel, OpticsScratch, Pcg64);

impl Camera for SimulatedCamera {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        let Self(model, scratch, rng) = self;
        let forces = [DVec3::new(0.1, -0.2, 0.7); 41];
        render(model, scratch, &forces, rng, &mut frame.picture)
            .map_err(|_| CameraError::Ended { count: 0 })
    }
}

#[test]
fn a_reading_does_not_allocate() {
    let config = FingertipConfig::default();
    let optics = OpticsConfig::default();
    let bench = CalibrationBenchConfig {
        combined: 20,
        held_out: 1,
        model: ModelChoice::Coupled,
        ..CalibrationBenchConfig::default()
    };
    let calibration = calibrate_simulated(&config, &optics, &bench).unwrap();
    let sensing = SensingChain::of_fingertip(&config).unwrap();
    let mut sensing = sensing.with_calibration(calibration.clone()).unwrap();
    let Fingertip {
        layout, projection, ..
    } = Fingertip::new(&config).unwrap();
    let model = OpticsModel::new(&optics, &layout, &projection).unwrap();
    let scratch = OpticsScratch::new(&model);
    let camera = SimulatedCamera(model, scratch, Pcg64::seed_from_u64(1));
    let mut sensor = OpticalSensor::new(camera, &config, calibration)
        .unwrap()
        .with_drift_correction(DriftConfig::default());
    let mut reading = TactileFrame::unloaded(sensor.element_count());
    assert!(assert_no_alloc(|| sensor.read(&mut reading)).is_ok());
    let mut readings = vec![ElementReading::default(); sensing.element_count()];
    let picture = &sensor.frame().picture;
    assert!(assert_no_alloc(|| sensing.sense(picture, &mut readings)).is_ok());
    assert!(readings.iter().all(|reading| reading.force.is_some()));
}

/// Valid and invalid rows of taxels do not allocate.
#[test]
fn a_row_of_taxels_does_not_allocate() {
    let mut layout = BuiltInTaxels::named("eflesh").unwrap().layout().unwrap();
    layout.columns.sequence = Some("sequence".into());
    let drift = "untouched = 5.0\ntime_constant = 1.0\nmost = 50.0";
    layout.drift = Some(toml::from_str(drift).unwrap());
    let names = (0..5).flat_map(|n| ["x", "y", "z"].map(|axis| format!(",{n}_{axis}")));
    let header: String = names.collect();
    let row = |sequence: &str, last: &str| format!("{sequence}{}{last}\n", ",1.5".repeat(14));
    let mut table = format!("sequence{header}\n");
    for (sequence, last) in [
        ("a", ",1"),
        ("a", ",2"),
        ("long name", ","),
        ("a", ",nan"),
        ("a", ""),
    ] {
        table += &row(sequence, last).repeat(20);
        table += "no row at all\n";
    }
    let mut sensor = TaxelSensor::open(table.as_bytes(), &layout, None).unwrap();
    let mut reading = TactileFrame::unloaded(5);
    let count = assert_no_alloc(|| {
        let mut count = 0;
        while sensor.read(&mut reading).is_ok() {
            count += 1;
        }
        count
    });
    assert_eq!((count, sensor.problems().skipped()), (100, 5));
}

/// Neither valid nor missing taxels allocate.
#[test]
fn a_wrench_of_taxels_does_not_allocate() {
    let layout = BuiltInTaxels::named("eflesh").unwrap().layout().unwrap();
    let values = |row: u32| {
        let time = 0.1 * f64::from(row);
        [1.0, 1.3, 0.7, 2.1, 0.4].map(|gain| DVec3::new(time.sin(), 0.5, gain) * gain * time.cos())
    };
    let mut memory = Memory::new(5);
    let mut series = TaxelSeries::default();
    for row in 0..200 {
        let mut input = TaxelInput::default();
        memory.update(0.1 * f64::from(row), &values(row), &mut input);
        let mut wrench = [None; AXES];
        wrench[2] = Some(input.values[0].z + input.values[3].x.powi(2));
        let time = 0.1 * f64::from(row);
        series.measured.push(MeasuredAt { time, wrench });
        series.stamps.push(time);
        series.inputs.push(input);
    }
    let target = layout.calibration_target().unwrap();
    let samples = join(&[series], 0.0);
    let fitted = fit(target, &["presses".to_owned()], &samples, false).unwrap();
    let mut estimator = TaxelWrenchEstimator::new(fitted.calibration).unwrap();
    let estimated = assert_no_alloc(|| {
        estimator.restart();
        let rows = (0..100).filter(|&row| {
            let mut values = values(row);
            if row % 7 == 0 {
                values[2] = DVec3::NAN;
            }
            let estimate = estimator.estimate(0.1 * f64::from(row), &values);
            estimate.components[2].is_some()
        });
        rows.count()
    });
    // One of five taxels is more than the tenth that may be missing.
    assert_eq!(estimated, 85);
}
