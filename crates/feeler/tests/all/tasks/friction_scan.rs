//! A specimen on which a feeler sticks and slips.

use super::fingers::{Finger, PERIOD, PHASES, Run};
use feeler::control::Phase;
use feeler::control::StopReason;
use feeler::control::task::Task;
use feeler::control::task::friction_scan::{FrictionScan, FrictionScanConfig};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Of the contact, N/m.
const NORMAL_STIFFNESS: f64 = 200.0;
const SHEAR_STIFFNESS: f64 = 100.0;
/// Greatest error of each component of the force, N.
const NOISE: f64 = 0.003;
const HOME: [f64; 3] = [0.01, 0.02, 0.023];

fn config() -> FrictionScanConfig {
    FrictionScanConfig {
        home: HOME,
        approach: [0.0, 0.0, -2.0],
        // Only what is across the approach counts.
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

/// A plane through W's origin that rises along x by `tilt`.
struct Specimen {
    tilt: f64,
    static_friction: f64,
    kinetic_friction: f64,
    /// Anchor of the sticking feeler.
    anchor: Option<DVec3>,
    /// Slips so far in each stroke, and where the finger was at the first.
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

    /// The force on a feeler whose unloaded tip would be at `tip`.
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

/// Runs the task until it is done. Calls `seen` in each step with the phase and the velocity of the finger.
fn run(
    run: &mut Run<FrictionScan>,
    specimen: &mut Specimen,
    mut seen: impl FnMut(&Run<FrictionScan>, DVec3),
) {
    while !run.done() {
        assert!(run.steps < 10_000, "{:?}", run.task.phase());
        let tip = run.fingers[0].free_tip();
        // What slips before and after the strokes is none of theirs.
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
fn both_coefficients_and_the_tilt_are_told_and_slips_counted() {
    for (tilt, friction) in [(0.0, [0.8, 0.6]), (0.06, [0.5, 0.3]), (-0.05, [1.1, 0.9])] {
        let (mut task, mut specimen) = (start(&config()), Specimen::new(tilt, friction));
        run(&mut task, &mut specimen, |_, _| {});
        assert_eq!(task.task.outcome(), Some("measured"));
        assert!(!task.task.failed());
        let found = ["static_friction", "kinetic_friction", "tilt"].map(|n| task.finding(n));
        // From frame to frame the angle rises by 5 mrad. Half of that is made good; noise leaves less than the rest.
        for (found, expected) in found.into_iter().zip([friction[0], friction[1], tilt]) {
            assert!((found - expected).abs() < 0.01, "{found} for {expected}");
        }
        // The first stroke wipes away what pressing left, and does not count.
        let counted = specimen.slips[2..].iter().map(|s| s.0).sum::<u64>();
        assert!(counted >= 12, "{counted}");
        assert_eq!(task.finding("slips"), counted as f64);
        let home = task.fingers[0].position.distance(HOME.into());
        assert!(home <= config().home_tolerance, "{home} m");
    }
}

#[test]
fn it_presses_settles_slides_to_and_fro_and_returns() {
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
                // The control's error at 0.01 m/s, and where a slip takes load off.
                let load = run.fingers[0].force.z;
                assert!((load - 1.0).abs() < 0.15, "{load} N");
                // It presses where load is missing, with the gain, before noise.
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
    // 0.3 s and one step to see that they are over.
    assert!((30..=31).contains(&at_rest), "{at_rest}");
    assert_eq!(turned_at.len(), 5);
    for (stroke, turn) in (1..).zip(turned_at) {
        let travel = (turn - specimen.slips[stroke].1).abs();
        // One or two steps of 50 µm from the slip to where the stroke ends.
        assert!(
            (travel - 0.012).abs() < 1.1e-4,
            "stroke {stroke}: {travel} m"
        );
    }
}

#[test]
fn a_load_that_is_far_off_is_made_good_no_faster_than_it_searches() {
    let mut task = start(&config());
    while task.task.phase() == Phase::Search {
        task.fingers[0].force = 1.2 * DVec3::Z;
        task.step().expect("no reason to stop");
    }
    // The angle rises, so that nothing slides; then the load changes.
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
    // A force below the contact threshold is not a load.
    assert_eq!(press(&mut task, 0.04), 0.01);
}

#[test]
fn an_element_that_is_over_its_limit_is_pressed_no_further() {
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
        // As much as is wanted first; then less, but still over the limit.
        let load = if n < 5 {
            2.0
        } else {
            1.8 + 1e-3 * f64::from(n % 2)
        };
        task.fingers[0].force = DVec3::new(-0.005 * f64::from(n), 0.0, load);
        let plans = task.step().expect("no reason to stop");
        press = -plans[0].velocity.z;
    }
    assert_ne!(task.fingers[0].position.x, HOME[0], "it slides");
    assert_eq!(press, 0.0);
}

#[test]
fn what_does_not_slip_is_told_by_its_angle_or_by_the_way_gone() {
    // At 1 N the shear is three times the load after 30 mm.
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
        // A step is 50 µm; what the load is off by counts thirtyfold in the angle.
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
fn a_search_that_meets_nothing_is_given_up() {
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
