//! Specified accuracy of the simulated 41-element sensor with the coupled calibration: 640x480 pixels, noise of the
//! reference experiment, full scale 2 N of compression and 1 N of shear.

use super::optics::of_experiment;
use feeler::sensor::calibration::{Calibration, ForceValidity, ModelChoice};
use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::forces::{DriftConfig, OpticalSensor, TactileFrame, TactileSensor};
use feeler::sensor::image::{Camera, CameraError, Frame};
use feeler_sim::bench::{CalibrationBenchConfig, calibrate_simulated};
use feeler_sim::optics::{OpticsConfig, OpticsModel, OpticsScratch, render};
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::sync::LazyLock;

const ELEMENTS: usize = 41;
/// Full scale in x, y, z of an element's frame (N).
const FULL_SCALE: DVec3 = DVec3::new(1.0, 1.0, 2.0);

/// Fingertip and optics of the reference experiment.
fn reference() -> (FingertipConfig, OpticsConfig) {
    of_experiment("cap-closing")
}

static COUPLED: LazyLock<Calibration> = LazyLock::new(|| {
    let (fingertip, optics) = reference();
    let bench = CalibrationBenchConfig {
        model: ModelChoice::Coupled,
        ..CalibrationBenchConfig::default()
    };
    calibrate_simulated(&fingertip, &optics, &bench).unwrap()
});

/// Camera of a simulated fingertip under forces and illumination set by a test.
struct Bench {
    model: OpticsModel,
    scratch: OpticsScratch,
    rng: Pcg64,
    forces: Vec<DVec3>,
}

impl Bench {
    fn new(seed: u64) -> Self {
        let model = lit(1.0);
        Self {
            scratch: OpticsScratch::new(&model),
            model,
            rng: Pcg64::seed_from_u64(seed),
            forces: vec![DVec3::ZERO; ELEMENTS],
        }
    }
}

/// Optics of the fingertip at a brightness relative to its calibration's.
fn lit(light: f64) -> OpticsModel {
    let (fingertip, mut optics) = reference();
    optics.background_gray *= light;
    optics.spot_gray *= light;
    let fingertip = Fingertip::layout_and_projection(&fingertip).unwrap();
    OpticsModel::new(&optics, &fingertip.0, &fingertip.1).unwrap()
}

impl Camera for Bench {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        let Self {
            model,
            scratch,
            forces,
            rng,
        } = self;
        render(model, scratch, forces, rng, &mut frame.picture).unwrap();
        Ok(())
    }
}

fn sensor(seed: u64) -> OpticalSensor<Bench> {
    OpticalSensor::new(Bench::new(seed), &reference().0, COUPLED.clone()).unwrap()
}

/// Readings of all elements under the forces `load(element)`.
fn read(sensor: &mut OpticalSensor<Bench>, load: impl FnMut(usize) -> DVec3) -> Vec<DVec3> {
    sensor.camera_mut().forces = (0..ELEMENTS).map(load).collect();
    let mut reading = TactileFrame::unloaded(ELEMENTS);
    sensor.read(&mut reading).unwrap();
    reading.forces
}

/// A random load within a friction cone of 0.9 whose shear does not exceed full scale.
fn load(rng: &mut Pcg64) -> DVec3 {
    let normal = FULL_SCALE.z * rng.random::<f64>();
    let shear = (0.9 * normal).min(FULL_SCALE.x) * rng.random::<f64>();
    (shear * DVec2::from_angle(TAU * rng.random::<f64>())).extend(normal)
}

/// Maximum over all elements (%).
fn largest(values: &[DVec3]) -> DVec3 {
    100.0 * values.iter().copied().reduce(DVec3::max).unwrap()
}

/// Root mean square error of each element over `pictures` images of random loads, relative to full scale.
fn errors(sensor: &mut OpticalSensor<Bench>, pictures: u32, seed: u64) -> Vec<DVec3> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut squares = vec![DVec3::ZERO; ELEMENTS];
    for _ in 0..pictures {
        let loads: Vec<_> = (0..ELEMENTS).map(|_| load(&mut rng)).collect();
        let forces = read(sensor, |element| loads[element]);
        for ((squares, force), load) in squares.iter_mut().zip(forces).zip(loads) {
            let error = (force - load) / FULL_SCALE;
            *squares += error * error;
        }
    }
    (squares.into_iter())
        .map(|s| (s / f64::from(pictures)).map(f64::sqrt))
        .collect()
}

/// Specified: 0.6 % in z, 1.3 % in x and y, on every element. Measured: 0.16 % in z, 0.53 % in x and y.
///
/// The calibration reports 0.18 and 0.54 % on held-out loads with shear up to 1.8 N; a separable calibration has 0.37
/// and 9.9 %. `--nocapture` prints the measurements.
#[test]
fn every_element_is_accurate_on_unseen_combined_loads() {
    let largest = largest(&errors(&mut sensor(101), 300, 7));
    println!("rms, largest of all elements: {largest} %");
    assert!(
        largest.z <= 0.6 && largest.x.max(largest.y) <= 1.3,
        "{largest}"
    );
    // The calibration's held-out errors, with shear up to 1.8 N, agree.
    let account = COUPLED
        .elements
        .iter()
        .map(|e| e.quality.held_out.rms / FULL_SCALE);
    let account = self::largest(&account.collect::<Vec<_>>());
    println!("by the calibration: {account} %");
    assert!(
        account.z <= 0.6 && account.x.max(account.y) <= 1.3,
        "{account}"
    );
}

/// Specified: 1 % of full scale for the mean of 40 readings, which suppresses noise.
/// Measured: 0.40 % normal into shear, 0.31 % shear into normal, 0.39 % between shear axes.
#[test]
fn cross_talk_between_axes_is_small() {
    let mean = |force: DVec3| {
        let mut sensor = sensor(102);
        let mut sums = vec![DVec3::ZERO; ELEMENTS];
        for _ in 0..40 {
            for (sum, force) in sums.iter_mut().zip(read(&mut sensor, |_| force)) {
                *sum += force / 40.0;
            }
        }
        sums
    };
    let relative = |a: &[DVec3], b: &[DVec3]| -> Vec<DVec3> {
        a.iter()
            .zip(b)
            .map(|(a, b)| ((a - b) / FULL_SCALE).abs())
            .collect()
    };
    let pressed = largest(&relative(&mean(DVec3::Z), &[DVec3::ZERO; ELEMENTS]));
    println!("1 N normal into shear: {pressed} %");
    assert!(pressed.x.max(pressed.y) <= 1.0, "{pressed}");
    // Shear requires compression by friction, so the reading without shear is subtracted.
    let base = mean(1.5 * DVec3::Z);
    let along_x = largest(&relative(&mean(DVec3::new(1.0, 0.0, 1.5)), &base));
    let along_y = largest(&relative(&mean(DVec3::new(0.0, 1.0, 1.5)), &base));
    println!("1 N along x: {along_x} %, along y: {along_y} %");
    assert!(along_x.z <= 1.0 && along_y.z <= 1.0);
    assert!(along_x.y <= 1.0 && along_y.x <= 1.0);
}

/// Specified: 2 % of full scale over 1,000 cycles, maximum minus minimum reading of the same load.
/// Measured: 1.72 % in x, 1.57 % in y, 0.67 % in z.
#[test]
fn readings_are_repeatable_over_a_thousand_cycles() {
    let mut sensor = sensor(103);
    let load = DVec3::new(0.5, -0.3, 1.5);
    let mut range = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); ELEMENTS];
    for _ in 0..1000 {
        read(&mut sensor, |_| DVec3::ZERO);
        for (range, force) in range.iter_mut().zip(read(&mut sensor, |_| load)) {
            *range = (range.0.min(force), range.1.max(force));
        }
    }
    let spread: Vec<_> = range
        .iter()
        .map(|(low, high)| (high - low) / FULL_SCALE)
        .collect();
    let spread = largest(&spread);
    println!("maximum minus minimum reading: {spread} %");
    assert!(spread.max_element() <= 2.0, "{spread}");
}

/// Specified: 5 mN normal and 10 mN shear, as three standard deviations of readings without load.
/// Measured: 3.3 mN normal, 5.2 mN shear.
#[test]
fn small_forces_are_resolved() {
    let mut sensor = sensor(104);
    let (mut sums, mut squares) = (vec![DVec3::ZERO; ELEMENTS], vec![DVec3::ZERO; ELEMENTS]);
    for _ in 0..400 {
        for (element, force) in read(&mut sensor, |_| DVec3::ZERO).into_iter().enumerate() {
            sums[element] += force / 400.0;
            squares[element] += force * force / 400.0;
        }
    }
    let noise = sums
        .iter()
        .zip(squares)
        .map(|(&mean, s)| (s - mean * mean).map(f64::sqrt));
    let resolution = 3e3 * noise.reduce(DVec3::max).unwrap();
    println!("resolution: {resolution} mN");
    assert!(
        resolution.z <= 5.0 && resolution.x.max(resolution.y) <= 10.0,
        "{resolution}"
    );
}

/// Specified: 2 % of full scale for a lamp that dims by 10 % over a run. Up to ten elements are loaded at a time, as in
/// a grasp.
///
/// Measured root mean square of the worst element at the worst brightness: 0.85 % in z and 0.67 % in x and y; without
/// correction 6.4 and 2.8 %; under a steady lamp 0.15 and 0.43 %.
#[test]
fn a_dimming_lamp_is_corrected() {
    let mut correcting = sensor(105).with_drift_correction(DriftConfig::default());
    let mut plain = sensor(105);
    let mut steady = sensor(105);
    let mut worst = [DVec3::ZERO; 3];
    for step in 0..=20_u32 {
        let model = lit(1.0 - 0.1 * f64::from(step) / 20.0);
        correcting.camera_mut().model = model.clone();
        plain.camera_mut().model = model;
        let sensors = [&mut correcting, &mut plain, &mut steady];
        // Only the correcting sensor depends on history; the others are compared at the worst brightness.
        let compared = if step == 20 { 3 } else { 1 };
        for (sensor, worst) in sensors.into_iter().zip(&mut worst).take(compared) {
            let mut rng = Pcg64::seed_from_u64(step.into());
            let mut squares = vec![DVec3::ZERO; ELEMENTS];
            for picture in 0..20 {
                let mut loads = [DVec3::ZERO; ELEMENTS];
                for touched in 0..10 {
                    loads[(picture / 5 * 10 + touched) % ELEMENTS] = load(&mut rng);
                }
                let forces = read(sensor, |element| loads[element]);
                for ((squares, force), load) in squares.iter_mut().zip(forces).zip(loads) {
                    let error = (force - load) / FULL_SCALE;
                    *squares += error * error / 20.0;
                }
            }
            let rms = largest(&squares.iter().map(|s| s.map(f64::sqrt)).collect::<Vec<_>>());
            *worst = worst.max(rms);
        }
    }
    let [corrected, uncorrected, steady] = worst;
    println!("corrected {corrected} %, uncorrected {uncorrected} %, steady lamp {steady} %");
    assert!(corrected.max_element() <= 2.0, "{corrected}");
    // Without correction the specification is not met.
    assert!(uncorrected.max_element() > 2.0, "{uncorrected}");
}

/// Dark and saturated images are marked, valid ones are not.
#[test]
fn invalid_readings_are_marked() {
    let mut sensor = sensor(106);
    let mut rng = Pcg64::seed_from_u64(1);
    read(&mut sensor, |_| load(&mut rng));
    assert!(sensor.validity().all(|v| v == ForceValidity::Calibrated));
    let validity = |gray: u8| {
        let mut moments = vec![Default::default(); ELEMENTS];
        let fingertip = Fingertip::new(&reference().0).unwrap();
        let mut picture = feeler::sensor::image::Picture::black(640, 480);
        picture.pixels.fill(gray);
        fingertip.kernel.measure(&picture, &mut moments).unwrap();
        let mut validity = vec![ForceValidity::Calibrated; ELEMENTS];
        COUPLED.validity(&moments, &mut validity);
        validity
    };
    assert!(validity(0).into_iter().all(|v| v == ForceValidity::Dark));
    assert!(
        validity(255)
            .into_iter()
            .all(|v| v == ForceValidity::Extrapolated)
    );
}
