//! Sensors that lie stop the hand, with a reason that says which one; through the program, and read from its record.

use crate::program::{folder, run, summary};
use feeler::control::Phase;
use feeler_record::Recording;
use std::path::Path;

/// Runs `cap-closing` with `settings` in `folder`: why it ended, and its record.
fn fault(folder: &Path, name: &str, settings: &[&str]) -> (String, Recording) {
    let mut arguments = vec!["run", "cap-closing", "--out", name];
    arguments.extend(settings.iter().flat_map(|&setting| ["--set", setting]));
    let ended = run(folder, &arguments);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    let run_folder = folder.join(name);
    let reason = summary(&run_folder)["reason"].clone();
    let reason = reason.as_str().unwrap_or_default().to_string();
    let recording = Recording::read(run_folder.join("recording.mcap")).expect("a recording");
    (reason, recording)
}

/// When the hand stopped, s; asserts that nothing was commanded from then on.
fn stopped_at(recording: &Recording) -> f64 {
    let stopped = (recording.task.iter()).find(|task| task.phase == Phase::Stopped);
    let stamp = stopped.expect("a stop").stamp;
    for finger in &recording.fingers {
        let after = finger.command.iter().filter(|c| c.stamp >= stamp);
        assert!(after.clone().count() > 0);
        for command in after {
            assert_eq!(command.joint_velocity, [0.0; 3]);
        }
    }
    stamp
}

#[test]
fn joints_that_freeze_or_lie_stop_the_hand() {
    let folder = folder("lying-joints");
    // Joint 0 turns the strokes, joint 1 and 2 close the fingers.
    for joint in 0..3 {
        for (name, kind) in [
            (
                "freeze",
                format!("joint_freeze={{finger=1, joint={joint}}}"),
            ),
            (
                "half",
                format!("joint_gain={{finger=1, joint={joint}, gain=0.5}}"),
            ),
            (
                "reverse",
                format!("joint_gain={{finger=1, joint={joint}, gain=-1.0}}"),
            ),
            ("stall", format!("servo_stall={{finger=1, joint={joint}}}")),
        ] {
            let name = format!("{name}-{joint}");
            let setting = format!("sim.fault=[{{from=0.5, kind.{kind}}}]");
            let (reason, recording) = fault(&folder, &name, &["sensing=direct", &setting]);
            let words = format!("joint {joint} of finger 1 turned by");
            assert!(reason.contains(&words), "{name}: {reason}");
            // Within the first stroke.
            assert!(stopped_at(&recording) < 4.0, "{name}: {reason}");
        }
    }
}

#[test]
fn joints_that_jump_stop_the_hand_in_the_same_step() {
    let folder = folder("jumping-joints");
    for (name, angle, words) in [
        ("jump", "0.1", "joint 2 of finger 0 jumped by"),
        ("far", "1e6", "joint 2 of finger 0 reads"),
        (
            "absurd",
            "1e308",
            "finger 0 has a joint state that is not a finite number",
        ),
    ] {
        let setting = format!(
            "sim.fault=[{{from=0.5, kind.joint_jump={{finger=0, joint=2, angle={angle}}}}}]"
        );
        let (reason, recording) = fault(&folder, name, &["sensing=direct", &setting]);
        assert!(reason.contains(words), "{name}: {reason}");
        // The first reading after the fault begins.
        assert!((stopped_at(&recording) - 0.51).abs() < 1e-9, "{name}");
    }
}

#[test]
fn a_camera_that_is_frozen_stops_the_hand() {
    let folder = folder("frozen-camera");
    for sensing in ["sensing=direct", "sensing=image"] {
        let setting = "sim.fault=[{from=0.5, kind.frozen_frame={finger=1}}]";
        let (reason, recording) = fault(&folder, sensing, &[sensing, setting]);
        let words = "the last 10 images of finger 1 gave forces identical";
        assert!(reason.contains(words), "{sensing}: {reason}");
        // The picture of 0.49 s comes again at 0.5 s, and for the tenth time at 0.59 s.
        assert!((stopped_at(&recording) - 0.59).abs() < 1e-9, "{sensing}");
    }
}

/// Simulated sensors without noise rightly say the same while the fingers stand still; and each check can be switched off.
#[test]
fn what_is_no_fault_does_not_stop_the_hand() {
    let folder = folder("no-fault");
    let quiet = [
        "sim.direct_sensing.normal_noise=0.0",
        "sim.direct_sensing.shear_noise=0.0",
        "sim.optics.read_noise=0.0",
        "sim.optics.shot_noise=0.0",
    ];
    for sensing in ["sensing=direct", "sensing=image"] {
        let mut arguments = vec!["run", "cap-closing", "--out", sensing, "--set", sensing];
        arguments.extend(quiet.iter().flat_map(|&setting| ["--set", setting]));
        assert_eq!(run(&folder, &arguments).status, Some(0), "{sensing}");
    }
    let settings = [
        "sensing=direct",
        "time_limit=1.0",
        "control.monitor.joint_jump=0",
        "control.monitor.joint_deviation=0",
        "control.monitor.frozen_frames=0",
        "sim.fault=[{from=0.3, kind.frozen_frame={finger=1}}, \
         {from=0.5, kind.joint_jump={finger=0, joint=0, angle=0.05}}]",
    ];
    let (reason, _) = fault(&folder, "off", &settings);
    assert!(reason.contains("time limit"), "{reason}");
}

/// Of two fingertips that are alike, no picture tells that they are swapped: the hand stops when a finger finds nothing.
#[test]
fn swapped_sensors_of_fingertips_that_are_alike_are_noticed_late() {
    let folder = folder("swapped");
    let swapped = "sim.fault=[{kind.swapped_sensors={finger=0, other=1}}]";
    let (reason, _) = fault(&folder, "swapped", &["sensing=image", swapped]);
    assert!(reason.contains("without a grasp"), "{reason}");
}
