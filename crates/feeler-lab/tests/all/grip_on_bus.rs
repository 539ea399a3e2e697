//! A gripper on emulated servos whose bus fails while an object is lifted that needs more force than the servos may exert.

#![cfg(target_os = "linux")]

#[path = "../../../feeler-drives/tests/support/mod.rs"]
mod bus;

use bus::ages_of_goal_positions;
use feeler_drives::emulator::{BusFault, Lockstep};
use feeler_drives::packet::Protocol;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::rigs::driven::{EmulatedBus, session};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

/// Limit of each motor's current (A), and the sum of forces on its jaws at it (N): 0.215 N m at 1.47 A, 40 mm of travel per
/// turn.
const CURRENT: f64 = 0.2;
const FORCE: f64 = CURRENT * 0.215 / 1.47 * std::f64::consts::TAU / 0.04;
/// Maximum age of the data that a goal may be based on (s): 3.5 periods.
const MAX_AGE: f64 = 0.035;
/// Maximum time until a fault is known (s): the health of one servo after the other is read.
const KNOWN: f64 = 0.1;
/// Time of the fault (s): the object is being lifted.
const FAULT_AT: f64 = 3.3;

/// A heavy and slippery object, held by one or two servos in this `mode`.
fn experiment(mode: &str, servos: usize) -> Experiment {
    let grip = include_str!("../../experiments/grip.toml");
    let table = include_str!("../../experiments/grip.servos.toml");
    let mut settings = vec![
        "sim.object.box.motion.free.mass=0.5".to_string(),
        "sim.object.box.friction.static_friction=0.3".into(),
        "sim.object.box.friction.kinetic_friction=0.28".into(),
    ];
    if servos == 2 {
        let own = ["shared=false", "id=2", "model=XL330-M077"];
        settings.extend(own.map(|setting| format!("drives.finger.1.joint.0.{setting}")));
    }
    for finger in 0..2 {
        let joint = format!("drives.finger.{finger}.joint.0");
        settings.push(format!("{joint}.travel_per_turn=0.04"));
        if finger >= servos {
            continue;
        }
        settings.push(format!("{joint}.mode={mode}"));
        if mode == "current-limited-position" {
            settings.push(format!("{joint}.current_limit={CURRENT}"));
        }
    }
    let text = format!("{grip}\n{table}");
    Experiment::parse(&text, "grip", &settings, None).expect("an experiment")
}

/// End of a run with a fault.
struct Ended {
    bus: Lockstep,
    /// Error that ended the run, if any.
    error: Option<String>,
    /// Largest sum of the forces of the fingers that a servo moves (N).
    peak: f64,
}

/// Runs until the end, with `fault` from [`FAULT_AT`] on, and half a second longer.
fn run(mode: &str, servos: usize, fault: Option<BusFault>) -> Ended {
    let experiment = experiment(mode, servos);
    let (mut session, bus) = session(&experiment, f64::INFINITY).expect("a session");
    let mut schedule = bus
        .schedule(experiment.config.control.period)
        .expect("a schedule");
    let EmulatedBus::Lockstep(bus) = bus else {
        panic!("a bus in real time");
    };
    let peak = Arc::new(Mutex::new(0.0_f64));
    let own = peak.clone();
    session.rig().world().observe(move |_, state| {
        let forces = state.fingers.iter().map(|finger| {
            let touching = finger.contacts.iter();
            let forces = touching.map(|contact| finger.forces[contact.element]);
            forces.sum::<glam::DVec3>().x.abs()
        });
        let of_servo = match servos {
            1 => forces.sum(),
            _ => forces.fold(0.0, f64::max),
        };
        let mut peak = own.lock().unwrap();
        *peak = peak.max(of_servo);
    });
    let mut fault = fault;
    let ran = session.run(
        &mut schedule,
        &AtomicBool::new(false),
        |control_loop, _, _| {
            if control_loop.state().stamp >= FAULT_AT
                && let Some(fault) = fault.take()
            {
                bus.inject(fault);
            }
            ControlFlow::<Infallible>::Continue(())
        },
    );
    bus.wait(0.5);
    let peak = *peak.lock().unwrap();
    Ended {
        error: ran.err().map(|error| error.to_string()),
        bus,
        peak,
    }
}

/// Faults of the bus, of servo 1, and of servo `last`.
fn faults(last: u8) -> [BusFault; 9] {
    [
        BusFault::Silent(1),
        BusFault::Reboot(last),
        BusFault::CablePulled,
        BusFault::FlipBytes(0.2),
        BusFault::LoseBytes(0.2),
        BusFault::Late(0.2),
        BusFault::Overheat(1),
        BusFault::Hardware(last, 0x20),
        BusFault::Jump(1),
    ]
}

#[test]
fn no_fault_moves_a_jaw_by_old_data_or_exceeds_the_force_limit() {
    for mode in ["position", "current-limited-position"] {
        for servos in [1, 2] {
            for fault in faults(servos as u8) {
                check_fault(mode, servos, fault);
            }
        }
    }
}

fn check_fault(mode: &str, servos: usize, fault: BusFault) {
    let ended = run(mode, servos, Some(fault));
    let what = format!("{mode}, {servos} servos, {fault:?}: {:?}", ended.error);
    assert!(ended.error.is_some(), "{what}");
    let bus = ended.bus.servos();
    assert_eq!(bus.servos().len(), servos);
    let ages = ages_of_goal_positions(&bus, Protocol::Dynamixel);
    let late = ages.iter().filter(|(time, _)| *time > FAULT_AT + KNOWN);
    // No goal changes once the fault is known, and none was based on old data.
    assert_eq!(late.count(), 0, "{what}");
    let oldest = ages.iter().map(|(_, age)| *age).fold(0.0, f64::max);
    assert!(ages.len() > 100 && oldest <= MAX_AGE, "{oldest} s: {what}");
    if mode == "current-limited-position" {
        // To within a unit of the goal current, and the settling of the simulated contact.
        assert!(ended.peak <= 1.05 * FORCE, "{} N: {what}", ended.peak);
    }
}

/// The force limit of the test above binds.
#[test]
fn the_object_needs_more_force_than_the_limit() {
    for servos in [1, 2] {
        let free = run("position", servos, None);
        assert!(
            free.error.is_none() && free.peak > 1.5 * FORCE,
            "{} N",
            free.peak
        );
        let limited = run("current-limited-position", servos, None);
        assert!(limited.error.is_none(), "{:?}", limited.error);
        assert!(
            (0.8 * FORCE..1.05 * FORCE).contains(&limited.peak),
            "{} N",
            limited.peak
        );
    }
}

/// One servo moves both jaws of the simulated world alike, and a stalled jaw stops both.
#[test]
fn one_servo_moves_both_jaws_alike() {
    for stalled in [false, true] {
        let mut experiment = experiment("position", 1);
        if stalled {
            let fault = "sim.fault=[{from=0.5, kind.servo_stall={finger=1, joint=0}}]";
            experiment = experiment.with_settings(&[fault.into()]).expect("a fault");
        }
        let (mut session, bus) = session(&experiment, f64::INFINITY).expect("a session");
        let mut schedule = bus
            .schedule(experiment.config.control.period)
            .expect("a schedule");
        let rig = session.rig().clone();
        let positions = || [0, 1].map(|finger| rig.world().encoded(finger)[0]);
        let begin = positions();
        let ran = session.run(
            &mut schedule,
            &AtomicBool::new(false),
            |control_loop, _, _| {
                let [first, other] = positions();
                // A stalled jaw stops at once, the other one with the lag of its drive, 5 ms.
                assert!((first - other).abs() < 1e-4, "{first} {other}");
                match control_loop.state().stamp < 1.5 {
                    true => ControlFlow::Continue(()),
                    false => ControlFlow::Break(()),
                }
            },
        );
        ran.expect("a run");
        let moved = positions()[0] - begin[0];
        // At 12 mm/s, for 0.5 s if stalled.
        match stalled {
            false => assert!(moved > 0.008, "{moved} m"),
            true => assert!((0.004..0.0075).contains(&moved), "{moved} m"),
        }
    }
}

#[test]
fn one_servo_requires_a_task_that_moves_both_jaws_alike() {
    let experiment = experiment("position", 1);
    let error = experiment.with_settings(&["task.grip.law=policy".into()]);
    let error = error.expect_err("another task").to_string();
    let words = [
        "drives.finger[1].joint[0].shared = true",
        "moves the fingers independently",
    ];
    assert!(words.iter().all(|word| error.contains(word)), "{error}");
}
