//! `feeler ros2-rig` drives a third-party gripper by the action `control_msgs/ParallelGripperCommand`.

use super::peers::{self, Words, pyzeros, script};
use crate::ports::unused_endpoint;
use crate::program::{feeler, folder, run};
use crate::rig::{Running, alone, within_reason};
use feeler::sensor::fingertip::ElementLayout;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::fingers_at_home;
use serde_json::{Value, json};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, Stdio};
use std::sync::MutexGuard;

/// Maximum effort sent with each goal (N).
const MAX_EFFORT: f64 = 8.0;
/// Maximum delay from the freshness check of a goal to its stamp (s): a few instructions on a busy computer.
const HELD_UP: f64 = 0.5;
/// Number of periods of 10 ms after which data are stale: longer than a busy computer delays a program.
const STALE_PERIODS: f64 = 200.0;

/// Table of a gripper whose joint moves both jaws.
const ROS2: &str = "
[ros2.gripper]
max_effort = 8.0

[[ros2.finger]]
joints = ['jaw']
cloud = '/jaw_0/forces'

[[ros2.finger]]
joints = ['jaw']
cloud = '/jaw_1/forces'
";

/// Writes the experiment `grip` for this gripper to `folder`, and loads it.
fn experiment(folder: &Path) -> Experiment {
    run(
        folder,
        &["init", "gripper.toml", "--from", "grip", "--full"],
    )
    .done();
    let path = folder.join("gripper.toml");
    let text = fs::read_to_string(&path).expect("an experiment");
    let (rig, _) = text.split_once("\n[sim]").expect("a simulation");
    fs::write(&path, format!("{rig}\n{ROS2}")).expect("an experiment");
    Experiment::load(path.to_str().expect("a path"), &[]).expect("an experiment")
}

/// A gripper, its rig program and its hand.
struct Lab {
    folder: PathBuf,
    link: String,
    rig: Running,
    hand: Running,
    gripper: peers::Running,
    words: Words,
    orders: ChildStdin,
    _alone: MutexGuard<'static, ()>,
}

impl Lab {
    fn start(name: &str, python: &str, sim_time: bool) -> Self {
        let alone = alone();
        let folder = folder(name);
        let experiment = experiment(&folder);
        let (link, graph) = (unused_endpoint(), unused_endpoint());
        let config = config(&experiment, sim_time).to_string();
        let gripper = script(python, "gripper.py", &[&graph, &config])
            .stdin(Stdio::piped())
            .spawn();
        let mut gripper = peers::Running(gripper.expect("the gripper"));
        let start = |name: &str, arguments: &[&str]| {
            let mut command = feeler(&folder, arguments);
            let settings = [
                format!("control.stale_periods={STALE_PERIODS}"),
                "control.resume=fresh".into(),
                "task.grip.law=known-friction".into(),
                "time_limit=600".into(),
            ];
            command.args(settings.map(|setting| format!("--set={setting}")));
            if sim_time {
                command.args(["--speed", "0.25"]);
            }
            Running::start(&folder, name, command)
        };
        let mut rig = vec![
            "ros2-rig",
            "gripper.toml",
            "--domain-id=0",
            "--connect",
            &link,
        ];
        let router = unused_endpoint();
        rig.extend(["--ros-listen", &graph, "--ros-connect", &router]);
        if sim_time {
            rig.push("--use-sim-time");
        }
        let mut lab = Self {
            rig: start("rig", &rig),
            hand: start(
                "hand",
                &["hand", "gripper.toml", "--out=run", "--listen", &link],
            ),
            words: Words::of(&mut gripper),
            orders: gripper.0.stdin.take().expect("its input"),
            gripper,
            link: link.clone(),
            folder: folder.clone(),
            _alone: alone,
        };
        assert_eq!(lab.words.next()["ready"], true);
        lab
    }

    fn order(&mut self, order: &str) {
        writeln!(self.orders, "{order}").expect("an order");
    }

    /// Ends all programs and returns the gripper's summary. Asserts that every goal was that of the gripper's joint,
    /// within its limits, with the maximum effort, and based on fresh joint states.
    fn end(&mut self) -> Value {
        self.order("end");
        let told = self.words.next();
        assert!(self.gripper.0.wait().expect("its end").success());
        let goals = told["goals"].as_u64().expect("a number");
        assert!(goals > 0 && told["unique"] == goals, "{told}");
        assert_eq!(told["names"], json!(["jaw"]), "{told}");
        assert_eq!(told["efforts"], json!([MAX_EFFORT]), "{told}");
        let [low, high] = [0, 1].map(|end| told["range"][end].as_f64().expect("a number"));
        assert!(0.0 <= low && high <= 0.045, "{told}");
        let most = STALE_PERIODS * 0.01 + HELD_UP;
        assert!(told["most_age"].as_f64() <= Some(most), "{told}");
        told
    }
}

/// Configuration of the simulated gripper: at the home position of `experiment`, with an object of 0.2 kg.
fn config(experiment: &Experiment, sim_time: bool) -> Value {
    let (_, home) = fingers_at_home(&experiment.config).expect("fingers");
    let layout = ElementLayout::new(&experiment.config.sensor.fingertip(0).layout);
    let elements: Vec<_> = (0..layout.elements.len())
        .map(|n| layout.tip(n).to_array())
        .collect();
    json!({
        "joint": "jaw",
        "home": home[0][0],
        "speed": 0.1,
        "max_effort": MAX_EFFORT,
        "object": 0.025,
        "weight": 2.0,
        "elements": elements,
        "sim_time": sim_time,
        "speed_of_time": if sim_time { 0.25 } else { 1.0 },
    })
}

#[test]
fn a_gripper_holds_an_object_until_it_is_put_down() {
    let Some(python) = pyzeros() else { return };
    let mut lab = Lab::start("ros2-gripper", &python, true);
    let (status, said) = lab.hand.wait();
    assert_eq!(status, Some(0), "{said}");
    lab.rig.signal("INT");
    let (status, said) = lab.rig.wait();
    assert_eq!(status, Some(0), "{said}");
    let told = lab.end();
    let summary = fs::read_to_string(lab.folder.join("run/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&summary).expect("JSON");
    assert_eq!(summary["outcome"], "put down", "{summary}");
    assert_eq!(
        (&told["grasped"], &told["slipped"]),
        (&json!(true), &json!(false)),
        "{told}"
    );
    // Load / (utilisation x friction) = 1 / (0.7 x 0.5) N, with the lag of goals.
    let most = told["most_grip"].as_f64().expect("a force");
    assert!((2.5..4.5).contains(&most), "{told}");
    // Home again, to within the task's tolerance of 2 mm.
    let home = told["position"].as_f64().expect("a position");
    assert!((home - 0.010).abs() < 2e-3, "{told}");
}

#[test]
fn faults_of_a_gripper_stop_the_hand() {
    let Some(python) = pyzeros() else { return };
    let mut lab = Lab::start("ros2-gripper-faults", &python, false);
    let recording = lab.folder.join("run/recording.mcap");
    within_reason(&lab.hand, || recording.exists());
    let count = |lab: &Lab, words: &str| lab.hand.said().matches(words).count();
    for (fault, words) in [
        ("silent", "stopped: the joint angles"),
        ("late 5", "stopped: the "),
    ] {
        let stops = count(&lab, words);
        lab.order(fault);
        lab.hand.wait_for_times(words, stops + 1);
        let resumed = count(&lab, "resuming");
        lab.order("well");
        lab.hand.wait_for_times("resuming", resumed + 1);
    }
    for (fault, words) in [
        ("reject", "rejected a goal"),
        ("deaf", "expected a response"),
    ] {
        let stops = count(&lab, "stopped: joint 0");
        lab.order(fault);
        lab.rig.wait_for(words);
        lab.hand.wait_for_times("stopped: joint 0", stops + 1);
        lab.order("well");
        // Joints that do not move are not a matter of age, so the hand must be resumed explicitly.
        let resumed = count(&lab, "resuming");
        within_reason(&lab.hand, || {
            let told = run(
                &lab.folder,
                &["resume", "gripper.toml", "--connect", &lab.link],
            );
            assert_ne!(told.status, Some(2), "{told:?}");
            count(&lab, "resuming") > resumed
        });
    }
    lab.hand.signal("INT");
    lab.hand.wait();
    lab.rig.signal("INT");
    lab.rig.wait();
    lab.end();
}
