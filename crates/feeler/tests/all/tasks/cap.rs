//! A cap between two fingers that turns freely, reaches a seat, or does not turn.

use super::fingers::{DOME, FEELER, Finger, PERIOD, Run};
use feeler::control::Phase;
use feeler::control::task::Task;
use feeler::control::task::cap::CapTask;
use feeler::control::task::cap_config::{CapConfig, Until};
use feeler::control::task::screw::{FingerPathConfig, ScrewConfig};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

const RADIUS: f64 = 0.03;
const AXIS: DVec2 = DVec2::new(0.001, -0.002);
/// Distance from the axis to the centre of a touching tip.
const REACH: f64 = RADIUS + FEELER.tip_radius;
const STATIC_FRICTION: f64 = 0.8;
const KINETIC_FRICTION: f64 = 0.6;

fn config(until: Until) -> (ScrewConfig, CapConfig) {
    let finger = |side: f64| FingerPathConfig {
        home: [AXIS.x + side * (REACH + DOME + 0.005), AXIS.y, 0.1],
        approach: [-side, 0.0, 0.0],
        stroke: [0.0, -side, 0.0],
    };
    let screw = ScrewConfig {
        until,
        strokes: 30,
        search_speed: 0.01,
        grasp_force: 2.0,
        search_limit: 0.02,
        move_speed: 0.01,
        travel: 0.016,
        return_speed: 0.04,
        home_tolerance: 0.0005,
        cap: None,
        finger: vec![finger(1.0), finger(-1.0)],
    };
    let cap = CapConfig {
        axis: AXIS.into(),
        grip: 6.0,
        damage_force: 9.0,
        grip_gain: 0.002,
        clearance: 0.002,
        still_turn: 0.05,
        most_friction: 1.5,
        softest_seat: 0.1,
        least_turns: 0.1,
        most_turns: 0.5,
        open_turns: 0.3,
        feeler: FEELER,
    };
    (screw, cap)
}

fn start((screw, cap): &(ScrewConfig, CapConfig)) -> Run<CapTask> {
    let finger = |f: &FingerPathConfig| Finger::new(f.home, f.approach.into(), 100.0);
    Run::new(
        CapTask::new(screw, cap),
        screw.finger.iter().map(finger).collect(),
    )
}

/// A cap that turns clockwise, in the direction of the strokes, if the fingers' torque overcomes its resistance.
struct Cap<F> {
    /// Resistance of the cap at an angle (rad) in N m.
    resistance: F,
    friction: [f64; 2],
    angle: f64,
    /// Angle of each touching tip around the axis (rad), positive in the direction of the stroke.
    tips: [Option<f64>; 2],
    slips: u64,
    /// Torque of both fingers (N m).
    torque: f64,
}

impl<F: Fn(f64) -> f64> Cap<F> {
    fn new(resistance: F) -> Self {
        Self {
            resistance,
            friction: [STATIC_FRICTION, KINETIC_FRICTION],
            angle: 0.0,
            tips: [None; 2],
            slips: 0,
            torque: 0.0,
        }
    }

    /// Force of each finger along its stroke (N), from the deflection of its feeler.
    fn along(&self, free: [f64; 2]) -> [f64; 2] {
        let bent = |i: usize| self.tips[i].map_or(0.0, |tip| free[i] - tip);
        [0, 1].map(|i| FEELER.shear_stiffness * REACH * bent(i))
    }

    /// Torque of these forces (N m).
    fn torque_of(forces: [f64; 2]) -> f64 {
        RADIUS * (forces[0] + forces[1])
    }

    /// Slides the tips and turns the cap until forces are in equilibrium, and applies the forces to the feelers.
    fn hold(&mut self, fingers: &mut [Finger]) {
        let away = [0, 1].map(|i| (fingers[i].position.truncate() - AXIS).normalize());
        for (finger, away) in fingers.iter_mut().zip(away) {
            finger.axis = -away.extend(0.0);
        }
        let free = away.map(|away| -away.to_angle());
        let pressed = [0, 1].map(|i| {
            let depth = REACH - fingers[i].free_tip().truncate().distance(AXIS);
            (FEELER.normal_stiffness * depth).max(0.0)
        });
        for i in 0..2 {
            self.tips[i] = (pressed[i] > 0.0).then(|| {
                let tip = self.tips[i].unwrap_or(free[i]);
                // The angle wraps at half a turn.
                tip + ((free[i] - tip) / TAU).round() * TAU
            });
        }
        for i in 0..2 {
            let force = self.along(free)[i];
            if force.abs() > self.friction[0] * pressed[i] {
                let left = force.signum() * self.friction[1] * pressed[i];
                self.tips[i] = Some(free[i] - left / (FEELER.shear_stiffness * REACH));
                self.slips += u64::from(force.abs() > 0.0 && pressed[i] > 0.0);
            }
        }
        // The tips roll on the cap: their centres move as far as its surface.
        let sticking = self.tips.iter().flatten().count() as f64;
        let stiffness = sticking * FEELER.shear_stiffness * RADIUS * RADIUS;
        for _ in 0..60 {
            let excess = Self::torque_of(self.along(free)) - (self.resistance)(self.angle);
            if excess <= 0.0 || sticking == 0.0 {
                break;
            }
            // No seat here is stiffer than the fingers.
            let turn = 0.5 * excess / stiffness;
            self.angle += turn;
            for tip in self.tips.iter_mut().flatten() {
                *tip += turn * RADIUS / REACH;
            }
        }
        let along = self.along(free);
        self.torque = Self::torque_of(along);
        for (i, finger) in fingers.iter_mut().enumerate() {
            // Direction of the surface at the tip. Clockwise is opposite to the perpendicular, and the force on the
            // feeler is opposite to the stroke.
            let away = self.tips[i].map_or(DVec2::ZERO, |tip| DVec2::from_angle(-tip));
            finger.force = (pressed[i] * away + along[i] * away.perp()).extend(0.0);
        }
    }
}

/// Runs the task to its end. Returns the largest torque on the cap (N m) and the largest force along a feeler's axis
/// (N).
fn run<F: Fn(f64) -> f64>(run: &mut Run<CapTask>, cap: &mut Cap<F>) -> (f64, f64) {
    let (mut torque, mut pressed) = (0.0_f64, 0.0_f64);
    while !run.done() {
        assert!(run.steps < 60_000, "{:?} {}", run.task.phase(), cap.angle);
        let slips = cap.slips;
        cap.hold(&mut run.fingers);
        if run.task.phase() != Phase::Move {
            // Slips during the release do not count.
            cap.slips = slips;
        }
        if run.task.phase() == Phase::Move {
            torque = torque.max(cap.torque);
        }
        for finger in &run.fingers {
            pressed = pressed.max(-finger.force.dot(finger.axis));
        }
        let plans = run.step().expect("no reason to stop");
        for (plan, finger) in plans.iter().zip(&run.fingers) {
            match run.task.phase() {
                Phase::Search => assert!(plan.velocity.length() <= 0.04 + 1e-12),
                Phase::Release => assert!((plan.velocity.length() - 0.04).abs() < 1e-12),
                Phase::Return => assert!(plan.velocity.length() <= 0.04 + 1e-12),
                Phase::Done => assert_eq!(plan.velocity, DVec3::ZERO),
                _ => assert!(finger.position.z == 0.1),
            }
        }
    }
    (torque, pressed)
}

/// Resistance of 3 mN m, and a seat at `at` (rad) with this stiffness (N m/rad).
fn seat(at: f64, stiffness: f64) -> impl Fn(f64) -> f64 {
    move |angle| 0.003 + stiffness * (angle - at).max(0.0)
}

#[test]
fn a_cap_is_screwed_until_it_stops_at_its_seat() {
    for stiffness in [0.2, 0.4] {
        let config = config(Until::Closed);
        let (mut task, mut cap) = (start(&config), Cap::new(seat(1.2, stiffness)));
        let (torque, pressed) = run(&mut task, &mut cap);
        assert_eq!(
            (task.task.outcome(), task.task.failed()),
            (Some("closed"), false)
        );
        // The friction limit at full grip. It is measured at the tip, which 5 mm of deflection displace by 0.15 rad,
        // and control has an error of a few percent.
        let limit = 2.0 * STATIC_FRICTION * 6.0 * RADIUS;
        assert!(
            (torque / limit - 1.0).abs() < 0.1,
            "{torque} N m with a limit of {limit} N m"
        );
        let found = task.finding("largest_torque_nm");
        assert!(
            (found / torque - 1.0).abs() < 0.03,
            "{found} N m instead of {torque} N m"
        );
        // Rotation while a finger slides is not counted.
        let found = task.finding("turned_rad");
        assert!(
            (found / cap.angle - 1.0).abs() < 0.1,
            "{found} rad instead of {} rad",
            cap.angle
        );
        let found = task.finding("stiffness_nm_per_rad");
        assert!((found / stiffness - 1.0).abs() < 0.15, "{found} N m/rad");
        assert!(pressed < 9.0 * 0.85, "{pressed} N");
        // It returns to a place close to the cap: 2 mm off it, and 5 mm less the depth that it presses in.
        for finger in &task.fingers {
            let off = (finger.position.truncate() - AXIS).length() - REACH - DOME;
            assert!(off < 0.0026, "{off} m");
        }
    }
}

#[test]
fn grip_and_radius_are_measured_while_the_cap_turns() {
    let config = config(Until::Closed);
    let (mut task, mut cap) = (start(&config), Cap::new(seat(1.2, 0.3)));
    let mut seen = 0;
    while task.task.stroke() < 3 {
        cap.hold(&mut task.fingers);
        let before = task.task.phase();
        task.step().expect("no reason to stop");
        if (before, task.task.phase()) == (Phase::Move, Phase::Move) {
            seen += 1;
            let forces = task.fingers.iter().map(|f| f.force.length());
            let least = forces.fold(f64::INFINITY, f64::min);
            let grip = task.finding("grip_n");
            // The shear of 0.1 N that corresponds to 3 mN m is perpendicular.
            assert!(
                (grip / least - 1.0).abs() < 0.01,
                "{grip} N instead of {least} N"
            );
            assert!(
                (grip - 2.0).abs() < 0.25,
                "gentle strokes grip with 2 N: got {grip} N"
            );
            let radius = task.finding("radius_m");
            assert!((radius - RADIUS).abs() < 1e-5, "{radius} m");
            let torque = task.finding("torque_nm");
            let expected: f64 = 0.003;
            assert!(torque < 1.02 * expected, "{torque} N m");
            let turned = task.finding("turned_rad");
            // Up to 3 mN m, feelers are deflected before the cap turns.
            assert!(
                (turned - cap.angle).abs() < 0.02,
                "{turned} rad instead of {} rad",
                cap.angle
            );
        }
    }
    assert!(seen > 100, "{seen}");
}

#[test]
fn strokes_have_the_configured_travel() {
    let config = config(Until::Closed);
    let (mut task, mut cap) = (start(&config), Cap::new(seat(1.2, 0.3)));
    let mut from = None;
    while task.task.stroke() < 2 {
        cap.hold(&mut task.fingers);
        let before = task.task.phase();
        let positions = [0, 1].map(|i| task.fingers[i].position);
        task.step().expect("no reason to stop");
        match (before, task.task.phase()) {
            (Phase::Search, Phase::Move) => from = Some(positions),
            (Phase::Move, Phase::Release) => {
                let from = from.expect("a beginning");
                for (i, way) in [(0, -1.0), (1, 1.0)] {
                    let travel = way * (positions[i] - from[i]).y;
                    // It moves around the axis: a step is at most 0.1 mm along the stroke.
                    assert!((0.016..0.016 + 1.1e-4).contains(&travel), "{travel} m");
                }
            }
            _ => {}
        }
    }
}

#[test]
fn an_early_or_soft_stop_is_cross_threaded() {
    let (screw, mut cap_config) = config(Until::Closed);
    cap_config.least_turns = 0.9;
    let early = (screw.clone(), cap_config.clone());
    cap_config.least_turns = 0.1;
    cap_config.softest_seat = 0.6;
    for config in [early, (screw, cap_config)] {
        let (mut task, mut cap) = (start(&config), Cap::new(seat(1.2, 0.3)));
        run(&mut task, &mut cap);
        assert_eq!(
            (task.task.outcome(), task.task.failed()),
            (Some("cross-threaded"), true)
        );
    }
}

#[test]
fn a_cap_without_a_seat_spins_freely() {
    let config = config(Until::Closed);
    let (mut task, mut cap) = (start(&config), Cap::new(|_| 0.003));
    run(&mut task, &mut cap);
    assert_eq!(
        (task.task.outcome(), task.task.failed()),
        (Some("spinning freely"), true)
    );
    // Half a turn, and at most one stroke more.
    assert!(
        cap.angle > 0.5 * TAU && cap.angle < 0.5 * TAU + 0.7,
        "{}",
        cap.angle
    );
    assert_eq!(cap.slips, 0);
}

#[test]
fn a_cap_is_opened_in_the_opening_direction() {
    // It breaks away at 0.1 N m and then turns easily.
    let resistance = |angle: f64| if angle < 0.02 { 0.1 } else { 0.003 };
    let config = config(Until::Open);
    let (mut task, mut cap) = (start(&config), Cap::new(resistance));
    run(&mut task, &mut cap);
    assert_eq!(
        (task.task.outcome(), task.task.failed()),
        (Some("open"), false)
    );
    assert!(
        cap.angle > 0.3 * TAU && cap.angle < 0.3 * TAU + 0.7,
        "{}",
        cap.angle
    );
    let (mut task, mut cap) = (start(&config), Cap::new(|_| 1.0));
    run(&mut task, &mut cap);
    assert_eq!(
        (task.task.outcome(), task.task.failed()),
        (Some("stuck"), true)
    );
    assert!(cap.slips > 0);
}

#[test]
fn too_few_strokes_leave_the_outcome_undecided() {
    let (mut screw, cap_config) = config(Until::Closed);
    screw.strokes = 3;
    let (mut task, mut cap) = (start(&(screw, cap_config)), Cap::new(|_| 0.003));
    run(&mut task, &mut cap);
    assert_eq!(
        (task.task.outcome(), task.task.failed()),
        (Some("undecided"), true)
    );
    assert_eq!(task.task.stroke(), 3);
}

#[test]
fn a_search_without_contact_finds_no_cap() {
    let config = config(Until::Closed);
    let mut task = start(&config);
    let mut farthest = 0.0_f64;
    while !task.done() {
        assert!(task.steps < 2000);
        task.step().expect("no reason to stop");
        farthest = farthest.max(task.fingers[1].position.x - config.0.finger[1].home[0]);
    }
    assert_eq!(
        (task.task.outcome(), task.task.failed()),
        (Some("no cap"), true)
    );
    // At 10 mm/s, because 6 N at 2 mm/(s N) would be faster; detected one step later.
    assert!(
        farthest > 0.02 && farthest < 0.02 + 2.1 * 0.01 * PERIOD,
        "{farthest} m"
    );
}

/// Knurls resist more than friction can. The torque stays below the limit of any plausible friction.
#[test]
fn a_cap_that_resists_more_than_friction_is_not_forced() {
    let mut config = config(Until::Open);
    config.0.travel = 0.03;
    let (mut task, mut cap) = (start(&config), Cap::new(|_| 1.0));
    cap.friction = [3.0, 2.0];
    let (torque, _) = run(&mut task, &mut cap);
    assert_eq!(task.task.outcome(), Some("stuck"));
    assert_eq!(cap.slips, 0);
    // 0.97 of a friction of 1.5 at a grip of 6 N, and one more step of up to 0.1 N.
    let limit = 2.0 * 1.5 * 6.0 * RADIUS;
    assert!(
        (0.95..1.0).contains(&(torque / limit)),
        "{torque} N m with a limit of {limit} N m"
    );
}
