//! A path around an upright cylinder with friction.

use super::fingers::{FEELER, Finger, PERIOD, PHASES, Run};
use feeler::control::task::Task;
use feeler::control::task::contour::{Contour, ContourConfig};
use feeler::control::{Phase, StopReason};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

const RADIUS: f64 = 0.03;
const CENTRE: DVec2 = DVec2::new(0.01, -0.02);
const HOME: [f64; 3] = [0.08, -0.02, 0.1];

fn config() -> ContourConfig {
    ContourConfig {
        home: HOME,
        approach: [-1.0, 0.0, 0.3],
        search_speed: 0.01,
        search_limit: 0.03,
        follow_speed: 0.01,
        contact_force: 1.0,
        touch_force: 0.05,
        force_gain: 0.01,
        press_speed: 0.008,
        friction_gain: 2.0,
        closing_distance: 0.001,
        lost_time: 0.2,
        follow_limit: 60.0,
        clearance: 0.005,
        return_speed: 0.02,
        home_tolerance: 0.001,
        feeler: FEELER,
    }
}

fn start(config: &ContourConfig) -> Run<Contour> {
    let finger = Finger::new(HOME, DVec3::NEG_X, 100.0);
    Run::new(Contour::new(config), vec![finger])
}

/// Applies the force on a feeler that faces the cylinder's axis and slides counterclockwise.
fn press(run: &mut Run<Contour>, friction: f64) {
    let finger = &mut run.fingers[0];
    let normal = (finger.position.truncate() - CENTRE).normalize();
    finger.axis = -normal.extend(0.0);
    let distance = finger.free_tip().truncate().distance(CENTRE);
    let pressed = FEELER.normal_stiffness * (RADIUS + FEELER.tip_radius - distance);
    let sliding = if run.task.phase() == Phase::Move {
        friction
    } else {
        0.0
    };
    let direction = normal - sliding * normal.perp();
    finger.force = pressed.max(0.0) * direction.extend(0.0);
}

#[test]
fn a_cylinder_is_circled_and_its_size_and_friction_measured() {
    for friction in [0.0, 0.3] {
        let mut run = start(&config());
        let mut phases = vec![];
        let mut off_height = 0.0_f64;
        while !run.done() {
            assert!(run.steps < 10_000, "{:?}", run.task.phase());
            press(&mut run, friction);
            let plans = run.step().expect("no reason to stop");
            let (velocity, phase) = (plans[0].velocity, run.task.phase());
            if phases.last() != Some(&phase) {
                phases.push(phase);
            }
            match phase {
                Phase::Search => assert_eq!(velocity, 0.01 * DVec3::NEG_X),
                Phase::Move => off_height = off_height.max((velocity.z).abs()),
                Phase::Release => assert!((velocity.length() - 0.02).abs() < 1e-12),
                Phase::Return => assert!(velocity.length() <= 0.02 + 1e-12),
                _ => assert_eq!(velocity, DVec3::ZERO),
            }
            // No outline point exists in the step in which following starts.
            if phase == Phase::Move && !run.finding("surface_x_m").is_nan() {
                let point = DVec2::new(run.finding("surface_x_m"), run.finding("surface_y_m"));
                // Before the lean is learned, the normal has an error of up to the friction angle.
                let error = (point.distance(CENTRE) - RADIUS).abs();
                assert!(error < 0.3 * 0.3 * FEELER.tip_radius, "{error} m");
            }
        }
        assert_eq!(phases, PHASES);
        assert_eq!(
            (run.task.outcome(), run.task.failed()),
            (Some("closed"), false)
        );
        for size in ["size_x_m", "size_y_m"] {
            // A step is 0.1 mm.
            let error = run.finding(size) - 2.0 * RADIUS;
            assert!(error.abs() < 2e-4, "{size}: {error} m");
        }
        let found = run.finding("friction");
        assert!(
            (found - friction).abs() < 0.02,
            "{found} instead of {friction}"
        );
        let turned = run.finding("turned_rad");
        // It ends within a millimetre of its start, where the friction was still unknown.
        let expected = TAU + f64::atan(friction);
        assert!(
            (turned - expected).abs() < 0.1,
            "{turned} instead of {expected}"
        );
        assert_eq!(off_height, 0.0);
        assert!(run.fingers[0].position.distance(HOME.into()) <= 0.001);
    }
}

#[test]
fn a_finger_returns_to_its_height() {
    let mut run = start(&config());
    while run.task.phase() == Phase::Search {
        press(&mut run, 0.0);
        run.step().expect("no reason to stop");
    }
    run.fingers[0].position.z += 0.002;
    press(&mut run, 0.0);
    assert!(run.step().expect("no reason to stop")[0].velocity.z < 0.0);
    for _ in 0..100 {
        press(&mut run, 0.0);
        run.step().expect("no reason to stop");
    }
    let off = run.fingers[0].position.z - HOME[2];
    // The error falls to about a third in each tenth of a second.
    assert!(off.abs() < 1e-6, "{off} m");
}

/// Speeds along the normal and along the surface (m/s) with a normal force (N).
fn velocity(force: f64) -> [f64; 2] {
    let mut run = start(&config());
    run.fingers[0].force = DVec3::X;
    run.step().expect("no reason to stop");
    assert_eq!(run.task.phase(), Phase::Move);
    run.fingers[0].force = force * DVec3::X;
    let velocity = run.step().expect("no reason to stop")[0].velocity;
    [velocity.x, velocity.y]
}

#[test]
fn speed_along_the_surface_is_proportional_to_the_force_up_to_its_target() {
    for (force, off, along) in [(1.0, 0.0, 0.01), (1.2, 0.002, 0.01), (9.0, 0.008, 0.01)] {
        let found = velocity(force);
        assert!(
            (found[0] - off).abs() < 1e-12 && (found[1] - along).abs() < 1e-12,
            "{found:?}"
        );
    }
    // At half of the target force it presses, and moves along at half speed.
    let [off, along] = velocity(0.5);
    assert!(
        (off + 0.005).abs() < 1e-12 && (along - 0.005).abs() < 1e-12,
        "{off} {along}"
    );
    assert_eq!(velocity(0.0), [-0.008, 0.0]);
}

#[test]
fn lost_contact_or_an_unclosed_outline_ends_the_task() {
    let mut run = start(&config());
    run.fingers[0].force = DVec3::X;
    run.step().expect("no reason to stop");
    run.fingers[0].force = DVec3::ZERO;
    // Lost for 0.2 s at step 20, detected one step later.
    for _ in 0..20 {
        run.step().expect("no reason to stop");
        assert_eq!(run.task.outcome(), None);
    }
    run.step().expect("no reason to stop");
    assert_eq!(
        (run.task.outcome(), run.task.failed()),
        (Some("contact lost"), true)
    );

    let short = ContourConfig {
        follow_limit: 0.5,
        ..config()
    };
    let mut run = start(&short);
    while run.task.outcome().is_none() {
        assert!(run.steps < 1000);
        press(&mut run, 0.0);
        run.step().expect("no reason to stop");
    }
    assert_eq!(run.task.outcome(), Some("not closed"));
}

#[test]
fn a_search_without_contact_fails() {
    let mut run = start(&config());
    let reason = loop {
        match run.step() {
            Ok(_) => assert!(run.steps < 1000),
            Err(reason) => break reason,
        }
    };
    let StopReason::NothingToGrasp { travel, .. } = reason else {
        panic!("{reason}")
    };
    assert!(
        travel > 0.03 && travel < 0.03 + 1.1 * 0.01 * PERIOD,
        "{travel} m"
    );
}
