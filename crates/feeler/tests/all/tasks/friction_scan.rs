//! A specimen on which a feeler sticks and slips.

use super::fingers::{Finger, PERIOD, PHASES, Run};
use feeler::control::task::Task;
use feeler::control::task::friction_scan::{FrictionScan, FrictionScanConfig};
use feeler::control::{Phase, StopReason};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Stiffness of the contact (N/m).
const NORMAL_STIFFNESS: f64 = 200.0;
const SHEAR_STIFFNESS: f64 = 100.0;
/// Maximum error of each force component (N).
const NOISE: f64 = 0.003;
const HOME: [f64; 3] = [0.01, 0.02, 0.023];

fn config() -> FrictionScanConfig {
    FrictionScanConfig {
        home: HOME,
        approach: [0.0, 0.0, -2.0],
        // Only the part perpendicular to the approach counts.
        slide: [3.0, 0.0, -1.0],
        search_speed: 0.01,
        search_limit: 0.02,
        load: 1.0,
        load_gain: 0.02,
        settle_time: 0.3,
        slide_speed: 0.005,
        travel: 0.012,
        slide_limit: 0.03,
        strokes: 5,
        return_speed: 0.03,
        home_tolerance: 0.0005,
    }
}

/// A plane through W's origin that rises along x by the angle `tilt`.
struct Specimen {
    tilt: f64,
    static_friction: f64,
    kinetic_friction: f64,
    /// Contact point of the sticking feeler.
    anchor: Option<DVec3>,
    /// Number of slips in each stroke, and the finger's position at the first one.
    slips: Vec<(u64, f64)>,
    rng: Pcg64,
}

impl Specimen {
    fn new(tilt: f64, [static_friction, kinetic_friction]: [f64; 2]) -> Self {
        Self {
            tilt,
            static_friction,
            kinetic_friction,
            anchor: None,
            slips: vec![(0, 0.0); 6],
            rng: Pcg64::seed_from_u64(1),
        }
    }

    /// Force on a feeler whose unloaded tip would be at `tip`.
    fn force(&mut self, tip: DVec3, stroke: u32) -> DVec3 {
        let normal = DVec3::new(-self.tilt.sin(), 0.0, self.tilt.cos());
        let pressed = -NORMAL_STIFFNESS * tip.dot(normal);
        if pressed <= 0.0 {
            self.anchor = None;
            return DVec3::ZERO;
        }
        let anchor = self.anchor.get_or_insert(tip);
        let mut shear = SHEAR_STIFFNESS * (*anchor - tip).reject_from_normalized(normal);
        if shear.length() > self.static_friction * pressed {
            shear = self.kinetic_friction * pressed * shear.normalize();
            *anchor = tip + shear / SHEAR_STIFFNESS;
            let (slips, first) = &mut self.slips[stroke as usize];
            *slips += 1;
            if *slips == 1 {
                *first = tip.x;
            }
        }
        let noise = DVec3::from_array([(); 3].map(|()| self.rng.random_range(-NOISE..NOISE)));
        pressed * normal + shear + noise
    }
}

fn start(config: &FrictionScanConfig) -> Run<FrictionScan> {
    let finger = Finger::new(HOME, DVec3::NEG_Z, 10.0);
    Run::new(FrictionScan::new(config), vec![finger])
}

/// Runs the task to its end and calls `seen` after each step with the finger's velocity.
fn run(
    run: &mut Run<FrictionScan>,
    specimen: &mut Specimen,
    mut seen: impl FnMut(&Run<FrictionScan>, DVec3),
) {
    while !run.done() {
        assert!(run.steps < 10_000, "{:?}", run.task.phase());
        let tip = run.fingers[0].free_tip();
        // Slips before and after the strokes do not count.
        let stroke = match run.task.phase() {
            Phase::Move => run.task.stroke(),
            _ => 0,
        };
        run.fingers[0].force = specimen.force(tip, stroke);
        let plans = run.step().expect("no reason to stop");
        assert_eq!(plans[0].towards_object, DVec3::NEG_Z);
        seen(run, plans[0].velocity);
    }
}

#[test]
fn friction_coefficients_and_tilt_are_measured_and_slips_counted() {
    for (tilt, friction) in [(0.0, [0.8, 0.6]), (0.06, [0.5, 0.3]), (-0.05, [1.1, 0.9])] {
        let (mut task, mut specimen) = (start(&config()), Specimen::new(tilt, friction));
        run(&mut task, &mut specimen, |_, _| {});
        assert_eq!(task.task.outcome(), Some("measured"));
        assert!(!task.task.failed());
        let found = ["static_friction", "kinetic_friction", "tilt"].map(|n| task.finding(n));
        // The angle rises by 5 mrad per frame. Half of that is corrected; noise is smaller than the rest.
        for (found, expected) in found.into_iter().zip([friction[0], friction[1], tilt]) {
            assert!(
                (found - expected).abs() < 0.01,
                "{found} instead of {expected}"
            );
        }
        // The first stroke removes the deflection from pressing and does not count.
        let counted = specimen.slips[2..].iter().map(|s| s.0).sum::<u64>();
        assert!(counted >= 12, "{counted}");
        assert_eq!(task.finding("slips"), counted as f64);
        let home = task.fingers[0].position.distance(HOME.into());
        assert!(home <= config().home_tolerance, "{home} m");
    }
}

#[test]
fn the_scan_presses_settles_slides_back_and_forth_and_returns() {
    let (mut task, mut specimen) = (start(&config()), Specimen::new(0.0, [0.8, 0.6]));
    let mut at_rest = 0;
    let mut phases = vec![];
    let mut turned_at = vec![];
    let mut last_stroke = 1;
    run(&mut task, &mut specimen, |run, velocity| {
        let (phase, stroke) = (run.task.phase(), run.task.stroke());
        if phases.last() != Some(&phase) {
            phases.push(phase);
        }
        match phase {
            Phase::Search => assert_eq!(velocity, 0.01 * DVec3::NEG_Z),
            Phase::Move if velocity == DVec3::ZERO => at_rest += 1,
            Phase::Move => {
                let way = if stroke % 2 == 1 { 0.005 } else { -0.005 };
                assert!(
                    (velocity.x - way).abs() < 1e-15,
                    "stroke {stroke}: {velocity}"
                );
                assert_eq!(velocity.y, 0.0);
                // Control error at 0.01 m/s, and the loss of load after a slip.
                let load = run.fingers[0].force.z;
                assert!((load - 1.0).abs() < 0.15, "{load} N");
                // It corrects the missing load with the gain, before noise.
                let press = 0.02 * (1.0 - load);
                assert!((-velocity.z - press).abs() < 1e-12, "{velocity}");
            }
            Phase::Release => assert_eq!(velocity, 0.03 * DVec3::Z),
            Phase::Return => assert!(velocity.length() <= 0.03 + 1e-15),
            _ => assert_eq!(velocity, DVec3::ZERO),
        }
        if stroke != last_stroke || (phase == Phase::Release && turned_at.len() == 4) {
            turned_at.push(run.fingers[0].position.x);
            last_stroke = stroke;
        }
    });
    assert_eq!(phases, PHASES);
    // 0.3 s, and one step to detect their end.
    assert!((30..=31).contains(&at_rest), "{at_rest}");
    assert_eq!(turned_at.len(), 5);
    for (stroke, turn) in (1..).zip(turned_at) {
        let travel = (turn - specimen.slips[stroke].1).abs();
        // One or two steps of 50 µm from the slip to the end of the stroke.
        assert!(
            (travel - 0.012).abs() < 1.1e-4,
            "stroke {stroke}: {travel} m"
        );
    }
}

#[test]
fn load_errors_are_corrected_at_most_at_the_search_speed() {
    let mut task = start(&config());
    while task.task.phase() == Phase::Search {
        task.fingers[0].force = 1.2 * DVec3::Z;
        task.step().expect("no reason to stop");
    }
    // The angle rises, so nothing slides; then the load changes.
    for n in 0..60 {
        task.fingers[0].force =
            DVec3::new(-0.005 * f64::from(n), 0.0, 1.0 + 1e-3 * f64::from(n % 2));
        task.step().expect("no reason to stop");
    }
    let press = |task: &mut Run<FrictionScan>, load: f64| {
        task.fingers[0].force = DVec3::new(-0.5 * load, 0.0, load);
        -task.step().expect("no reason to stop")[0].velocity.z
    };
    assert_eq!(press(&mut task, 0.1), 0.01);
    assert_eq!(press(&mut task, 9.0), -0.01);
    // A force below the contact threshold does not count as load.
    assert_eq!(press(&mut task, 0.04), 0.01);
}

#[test]
fn an_element_over_its_limit_is_not_pressed_further() {
    let config = FrictionScanConfig {
        load: 2.0,
        ..config()
    };
    let mut task = Run::new(
        FrictionScan::new(&config),
        vec![Finger::new(HOME, DVec3::NEG_Z, 1.5)],
    );
    let mut press = 0.0;
    for n in 0..60 {
        // The target load first, then less, but still over the limit.
        let load = if n < 5 {
            2.0
        } else {
            1.8 + 1e-3 * f64::from(n % 2)
        };
        task.fingers[0].force = DVec3::new(-0.005 * f64::from(n), 0.0, load);
        let plans = task.step().expect("no reason to stop");
        press = -plans[0].velocity.z;
    }
    assert_ne!(task.fingers[0].position.x, HOME[0], "the finger must slide");
    assert_eq!(press, 0.0);
}

#[test]
fn a_missing_slip_is_detected_by_angle_or_travel() {
    // At 1 N, the shear is three times the load after 30 mm.
    for (slide_limit, ends_after) in [(0.02, 0.02), (0.05, 0.03)] {
        let config = FrictionScanConfig {
            slide_limit,
            ..config()
        };
        let (mut task, mut specimen) = (start(&config), Specimen::new(0.0, [f64::INFINITY; 2]));
        let mut farthest = 0.0_f64;
        run(&mut task, &mut specimen, |run, _| {
            farthest = farthest.max(run.fingers[0].position.x - HOME[0]);
        });
        assert_eq!(task.task.outcome(), Some("no slip"));
        assert!(task.task.failed());
        // A step is 50 µm; an error of the load counts thirtyfold in the angle.
        let tolerance = if slide_limit == ends_after {
            1.1e-4
        } else {
            1e-3
        };
        assert!((farthest - ends_after).abs() < tolerance, "{farthest} m");
        assert!(task.finding("static_friction").is_nan());
    }
}

#[test]
fn a_search_without_contact_fails() {
    let mut task = start(&config());
    let reason = loop {
        match task.step() {
            Ok(_) => assert!(task.steps < 1000),
            Err(reason) => break reason,
        }
    };
    let StopReason::NothingToGrasp {
        finger: 0,
        travel,
        limit: 0.02,
    } = reason
    else {
        panic!("{reason}")
    };
    assert!(
        travel > 0.02 && travel < 0.02 + 1.1 * 0.01 * PERIOD,
        "{travel} m"
    );
}
