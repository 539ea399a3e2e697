//! `feeler identify`, and the probing routine that it runs.

use crate::program::{folder, run};
use assert_no_alloc::assert_no_alloc;
use feeler::control::Phase;
use feeler::hand::HandCommand;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Session, controller, fingers_at_home};
use feeler_lab::identify::{Estimate, Identified, probe, probing};
use std::fs;

const NAMES: [&str; 2] = ["identified.toml", "identify.html"];

fn probing_of(settings: &[&str]) -> Experiment {
    let settings: Vec<_> = settings.iter().map(|s| (*s).to_string()).collect();
    let experiment = Experiment::load("cap-closing", &settings).expect("an experiment");
    probing(&experiment).expect("an experiment with a rectangle")
}

#[test]
fn identify_estimates_the_reference_hand_and_writes_a_page() {
    let folder = folder("identify");
    let command = ["identify", "cap-closing", "--sensing", "direct"];
    let printed = run(&folder, &command).done();
    assert!(
        printed.contains("pivot, x, object") && !printed.contains("warning"),
        "{printed}"
    );

    let out = folder.join("runs/cap-closing-identified");
    let [text, page] = NAMES.map(|name| fs::read_to_string(out.join(name)).expect("a file"));
    let found: Identified = toml_of(&text);
    let within = |estimate: &Estimate, truth: f64, error: f64| {
        assert!(
            (estimate.value - truth).abs() <= error,
            "{truth}: {estimate:?}"
        );
        assert!(estimate.low <= estimate.value && estimate.value <= estimate.high);
    };
    // The required accuracies. The position of the bottle varies by at most 0.3 mm.
    within(&found.object.pivot_x, 0.0, 1.3e-3);
    within(&found.object.pivot_y, 0.0, 1.3e-3);
    within(&found.object.radius, 0.014, 1.5e-3);
    assert_eq!(found.finger.len(), 2);
    for finger in &found.finger {
        within(&finger.force_noise, 0.002, 0.0002);
        within(&finger.normal_stiffness, 205.0, 20.5);
        within(&finger.shear_stiffness, 127.0, 12.7);
        within(&finger.hysteresis, 0.0, 0.05);
        // Friction varies by 5 % from seed to seed.
        within(&finger.static_friction, 1.14, 0.06 + 0.057);
        within(&finger.kinetic_friction, 0.78, 0.06 + 0.039);
        within(&finger.servo_lag, 0.0125, 0.004);
        within(&finger.dead_time, 0.0, 0.004);
    }
    for words in [
        "Identification: cap-closing",
        "No warnings",
        "Pressing",
        "Sliding",
        "<svg",
    ] {
        assert!(page.contains(words), "no {words:?}");
    }

    let before = text;
    run(&folder, &command).refused(&["identified.toml", "exists already", "--force"]);
    run(&folder, &[&command[..], &["--force"]].concat()).done();
    let again = fs::read_to_string(out.join(NAMES[0])).expect("a file");
    assert_eq!(before, again, "runs with the same seed differ");
}

fn toml_of(text: &str) -> Identified {
    toml::from_str(text).expect("estimates")
}

#[test]
fn delayed_forces_are_identified() {
    let folder = folder("identify-late");
    let printed = run(
        &folder,
        &[
            "identify",
            "cap-closing",
            "--sensing=direct",
            "--set=sim.fault=[{kind={camera_latency={finger=1,delay=0.04}}}]",
            "--set=control.stale_periods=8",
            "--out=late",
        ],
    )
    .done();
    let text = fs::read_to_string(folder.join("late").join(NAMES[0])).expect("a file");
    let found = toml_of(&text);
    assert!(
        (found.finger[1].dead_time.value - 0.04).abs() < 0.004,
        "{text}"
    );
    assert!(found.finger[0].dead_time.value < 0.004, "{text}");
    assert!(
        printed.contains("warning: the forces of finger 1 follow commands after"),
        "{printed}"
    );
}

#[test]
fn probe_without_contact_or_rectangle_is_refused() {
    let folder = folder("identify-refused");
    let refused = |arguments: &[&str], words: &[&str]| {
        let start = [
            "identify",
            arguments[0],
            "--sensing=direct",
            "--out=refused",
        ];
        run(&folder, &[&start[..], &arguments[1..]].concat()).refused(words);
        assert!(!folder.join("refused").exists());
    };
    refused(
        &[
            "cap-closing",
            "--set=sim.object.cap.position=[0.0, 0.0, 0.2]",
        ],
        &[
            "the hand stopped before the probe was complete",
            "without a grasp",
            "limit 0.012 m",
        ],
    );
    refused(
        &[
            "cap-closing",
            "--set=sim.object.cap.shape.cylinder.height=0.003",
        ],
        &[
            "the hand stopped before the probe was complete",
            "lost contact",
        ],
    );
    refused(
        &["contour"],
        &[
            "expected an experiment with [task.screw]",
            "got [task.contour]",
        ],
    );
    refused(
        &["cap-closing", "--set=time_limit=10"],
        &["time_limit = 10 s", "30 s or more"],
    );
}

/// Hands that are difficult to probe: soft and stiff feelers, slow drives, high and low friction.
#[test]
fn probe_takes_at_most_30_seconds_and_overloads_nothing() {
    let hands = [
        [
            "sim.feeler.normal_stiffness=120",
            "sim.feeler.shear_stiffness=30",
            "sim.servo.lag=0.03",
        ],
        [
            "sim.feeler.normal_stiffness=800",
            "sim.feeler.shear_stiffness=600",
            "sim.servo.lag=0.03",
        ],
        [
            "sim.feeler.static_friction=0.4",
            "sim.feeler.kinetic_friction=0.3",
            "sim.servo.lag=0.003",
        ],
    ];
    for hand in hands {
        let experiment = probing_of(&[&hand[..], &["sensing=direct"]].concat());
        let trace = probe(&experiment).expect("a probe");
        for row in trace.fingers.iter().flat_map(|finger| &finger.rows) {
            assert!(row.time <= 30.0, "{hand:?}");
            let most = 1.25 * experiment.config.control.over_force;
            assert!(row.greatest() <= most, "{hand:?} {}", row.greatest());
        }
    }
}

#[test]
fn probe_does_not_allocate() {
    let experiment = probing_of(&["sensing=direct"]);
    let (fingers, _) = fingers_at_home(&experiment.config).expect("fingers");
    let mut session = Session::new(&experiment).expect("a session");
    let mut controller =
        controller(&experiment, &fingers, session.layouts()).expect("a controller");
    let mut command = HandCommand::stop(fingers.len());
    while !session.finished() {
        session.step().expect("a step");
        let control_loop = session.control_loop();
        let (touches, state) = (control_loop.touches(), control_loop.state());
        assert_no_alloc(|| controller.decide(touches, state, &mut command));
        assert_eq!(command, *control_loop.command());
    }
    assert_eq!(controller.phase(), Phase::Done);
}

/// The fingers of any-hand start farther from the cap than those of cap-closing.
#[test]
fn probe_searches_as_far_as_the_task() {
    let folder = folder("identify-any-hand");
    let said = run(&folder, &["identify", "any-hand", "--out", "found"]).done();
    assert!(said.contains("found/identified.toml"), "{said}");
}
