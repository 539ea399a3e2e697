//! Implausible sensor data stop the hand, with a recorded reason that names the sensor.

use crate::program::{folder, run, summary};
use feeler::control::Phase;
use feeler_record::Recording;
use std::path::Path;

/// Runs `cap-closing` with `settings` in `folder`. Returns the reason for its end, and its recording.
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

/// Time at which the hand stopped (s). Asserts that all commands from then on are zero.
fn stopped_at(recording: &Recording) -> f64 {
    let stopped = (recording.task.iter()).find(|task| task.phase == Phase::Stopped);
    let stamp = stopped.expect("a stop").stamp;
    for finger in &recording.fingers {
        let after = finger.command.iter().filter(|c| c.stamp >= stamp);
        assert!(after.clone().count() > 0);
        for command in after {
            assert_eq!(command.joint_velocity, [0.0; 3].into());
        }
    }
    stamp
}

#[test]
fn frozen_and_wrong_joint_angles_stop_the_hand() {
    let folder = folder("lying-joints");
    // Joint 0 performs the strokes, joints 1 and 2 close the fingers.
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
            let words = format!("joint {joint} of finger 1 moved by");
            assert!(reason.contains(&words), "{name}: {reason}");
            // Within the first stroke.
            assert!(stopped_at(&recording) < 4.0, "{name}: {reason}");
        }
    }
}

#[test]
fn jumping_joint_angles_stop_the_hand_in_the_same_step() {
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
        // The first reading after the start of the fault.
        assert!((stopped_at(&recording) - 0.51).abs() < 1e-9, "{name}");
    }
}

#[test]
fn frozen_camera_stops_the_hand() {
    let folder = folder("frozen-camera");
    for sensing in ["sensing=direct", "sensing=image"] {
        let setting = "sim.fault=[{from=0.5, kind.frozen_frame={finger=1}}]";
        let (reason, recording) = fault(&folder, sensing, &[sensing, setting]);
        let words = "the last 10 images of finger 1 gave forces identical";
        assert!(reason.contains(words), "{sensing}: {reason}");
        // The image of 0.49 s is repeated at 0.5 s, and for the tenth time at 0.59 s.
        assert!((stopped_at(&recording) - 0.59).abs() < 1e-9, "{sensing}");
    }
}

/// Noise-free simulated sensors repeat their values while the fingers are at rest, which is not a fault. Each check can
/// be disabled.
#[test]
fn noise_free_sensors_and_disabled_checks_do_not_stop_the_hand() {
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

/// Images do not reveal that identical fingertips are swapped. The hand stops when a finger finds no object.
#[test]
fn swapped_identical_sensors_stop_the_hand_without_a_grasp() {
    let folder = folder("swapped");
    let swapped = "sim.fault=[{kind.swapped_sensors={finger=0, other=1}}]";
    let (reason, _) = fault(&folder, "swapped", &["sensing=image", swapped]);
    assert!(reason.contains("without a grasp"), "{reason}");
}
