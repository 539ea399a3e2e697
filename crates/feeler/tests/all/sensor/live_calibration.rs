//! Simulates a person who loads a fingertip of two elements on a force sensor, with camera latency and measurement
//! noise.

use feeler::sensor::calibration::{Coverage, Goal, LiveCalibration, Seen, Stage};
use feeler::sensor::moments::ElementMoments;
use glam::{DMat3, DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Latency of the camera's images and time between them (s).
const LATE: f64 = 0.0613;
const FRAME: f64 = 1.0 / 60.0;

/// Start of the loads and duration of each element's loads (s).
const LOADS: f64 = 6.0;
const EACH: f64 = 12.0;

/// Loaded element and the force on it in its frame (N) at `time`: three presses after the first second, then each
/// element is pressed and pushed in all directions.
fn load(time: f64) -> (usize, DVec3) {
    if time < LOADS {
        let press = (TAU * 0.5 * (time - 1.0) / 1.5).sin().powi(2);
        let is_pressed = (1.0..5.5).contains(&time);
        return (0, DVec3::Z * if is_pressed { 0.6 * press } else { 0.0 });
    }
    let element = usize::from(time >= LOADS + EACH);
    let time = (time - LOADS) % EACH;
    if time > EACH - 1.0 {
        return (element, DVec3::ZERO);
    }
    let wave = |rate: f64| (rate * time).sin();
    let normal = 0.98 * wave(1.3).powi(2);
    let shear = DVec2::new(wave(2.9), wave(3.7)) * 0.5 * normal;
    (element, shear.extend(normal))
}

fn moments(time: f64, random: &mut Pcg64) -> Vec<ElementMoments> {
    let (loaded, force) = load(time);
    let mut noise = || 1e-3 * (random.random::<f64>() - 0.5);
    (0..2)
        .map(|element| {
            let own = if element == loaded {
                force
            } else {
                DVec3::ZERO
            };
            ElementMoments {
                integrated_gray: 500.0 * (1.0 + 0.4 * own.z + noise()),
                centroid: DVec2::new(0.2 * own.x + noise(), 0.2 * own.y + noise()),
            }
        })
        .collect()
}

#[test]
fn loads_become_samples_of_the_loaded_elements() {
    let frames = vec![
        DMat3::IDENTITY,
        DMat3::from_rotation_y(0.6) * DMat3::from_rotation_z(1.1),
    ];
    let goal = Goal {
        normal: 1.0,
        shear: 0.4,
    };
    let mut live = LiveCalibration::new(frames.clone(), goal, vec![Coverage::default(); 2]);
    let mut random = Pcg64::seed_from_u64(4);
    let tare = DVec3::new(0.4, -2.0, 7.0);
    let (mut next_frame, mut worst, mut samples) = (0.0, 0.0_f64, [0; 2]);
    let mut found = None;
    for tick in 0..((LOADS + 2.0 * EACH) * 1e3) as u32 {
        let now = f64::from(tick) * 1e-3;
        let (element, force) = load(now);
        // In the fingertip's frame, outward forces are opposite to compression.
        let own = frames[element] * force.with_z(-force.z);
        let noise = DVec3::splat(2e-3 * (random.random::<f64>() - 0.5));
        live.force(now, own + tare + noise);
        if now < next_frame {
            continue;
        }
        next_frame += FRAME;
        match live.picture(now, &moments(now - LATE, &mut random)) {
            Seen::Sample { element, force } => {
                found = live.delay();
                let (loaded, truth) = load(now - LATE);
                assert_eq!(element, loaded);
                samples[element] += 1;
                worst = worst.max((force - truth).length());
            }
            Seen::Untouched => assert!(now < 1.0, "{now}"),
            _ => assert!(
                now < LOADS || live.stage() == Stage::Loads,
                "{:?}",
                live.stage()
            ),
        }
    }
    let found = found.expect("a delay");
    // The correlation is accurate to a third of a millisecond if image and force are proportional. Forces arrive
    // every millisecond, and an image at the next one after its time.
    assert!((found.seconds - LATE).abs() < 2e-3, "{found:?}");
    assert!(samples.iter().all(|&count| count >= 36), "{samples:?}");
    assert!(live.coverage().iter().all(Coverage::is_complete));
    // Two milliseconds of a force that changes by at most 2 N/s, and the sensor's noise.
    assert!(worst < 6e-3, "{worst} N");
}

#[test]
fn unrelated_forces_give_neither_delay_nor_samples() {
    let goal = Goal {
        normal: 1.0,
        shear: 0.4,
    };
    let mut live =
        LiveCalibration::new(vec![DMat3::IDENTITY; 2], goal, vec![Coverage::default(); 2]);
    let mut random = Pcg64::seed_from_u64(5);
    for tick in 0..1500 {
        let now = f64::from(tick) * FRAME;
        // The sensor measures an unrelated force, then nothing, then invalid values.
        let force = match tick {
            0..900 => DVec3::splat(random.random::<f64>()),
            900..1200 => continue,
            _ => DVec3::NAN,
        };
        live.force(now, force);
        let seen = live.picture(now, &moments(now, &mut random));
        assert!(matches!(seen, Seen::Untouched | Seen::Nothing), "{seen:?}");
    }
    assert!(matches!(live.stage(), Stage::Presses { .. }));
}
