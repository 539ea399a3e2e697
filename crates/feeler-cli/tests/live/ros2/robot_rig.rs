//! `feeler ros2-rig`: an experiment on a third-party ROS 2 robot with a third-party fingertip.

use super::peers::{self, Words, pyzeros, script};
use crate::ports::unused_endpoint;
use crate::program::{feeler, folder, run};
use crate::rig::{Running, alone, reasons, within_reason};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::fingers_at_home;
use feeler_record::Recording;
use serde_json::{Value, json};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, Stdio};
use std::sync::MutexGuard;

/// Clock of the robot, and freshness of its data.
#[derive(Clone, Copy)]
struct Timing {
    /// `true` if the robot publishes simulated time.
    sim_time: bool,
    /// Ratio of the robot's time to real time.
    speed: f64,
    /// Number of periods of 10 ms after which data are stale: longer than a busy computer delays a program.
    stale_periods: f64,
    strokes: u32,
}

const SIMULATED: Timing = Timing {
    sim_time: true,
    speed: 0.25,
    stale_periods: 50.0,
    strokes: 1,
};
const REAL: Timing = Timing {
    sim_time: false,
    speed: 1.0,
    stale_periods: 200.0,
    // More than fit in the test's time.
    strokes: 1000,
};

/// Maximum delay from the freshness check of a command to its stamp (s): a few instructions on a busy computer.
const HELD_UP: f64 = 0.5;

/// Writes the experiment `own_rig` with a table `[ros2]` to `folder`, and loads it.
fn experiment(folder: &Path) -> Experiment {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/own_rig.toml");
    let text = fs::read_to_string(examples).expect("an experiment");
    let text = text.replace("../../feeler-lab/experiments/", "");
    let table = "\n[ros2]\n\n[[ros2.finger]]\njoints = ['first', 'second', 'third']\ncloud = '/finger/forces'\n";
    fs::write(folder.join("robot.toml"), text + table).expect("an experiment");
    let name = "reference-fingertip.coupled.calibration.toml";
    let calibration = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../feeler-lab/experiments")
        .join(name);
    fs::copy(calibration, folder.join(name)).expect("a calibration");
    let path = folder.join("robot.toml");
    Experiment::load(path.to_str().expect("a path"), &[]).expect("an experiment")
}

/// A robot, its rig program and its hand.
struct Lab {
    folder: PathBuf,
    link: String,
    graph: String,
    rig: Running,
    hand: Running,
    robot: peers::Running,
    words: Words,
    orders: ChildStdin,
    /// Dropped last, after the programs have ended.
    _alone: MutexGuard<'static, ()>,
}

impl Lab {
    fn start(name: &str, python: &str, timing: Timing) -> Self {
        let alone = alone();
        let folder = folder(name);
        let experiment = experiment(&folder);
        let (link, graph) = (unused_endpoint(), unused_endpoint());
        let robot = robot(&experiment, timing).to_string();
        let robot = script(python, "robot.py", &[&graph, &robot])
            .stdin(Stdio::piped())
            .spawn();
        let mut robot = peers::Running(robot.expect("the robot"));
        let mut lab = Self {
            rig: rig(&folder, timing, &link, &graph),
            hand: hand(&folder, timing, &link),
            words: Words::of(&mut robot),
            orders: robot.0.stdin.take().expect("its input"),
            robot,
            link,
            graph,
            folder,
            _alone: alone,
        };
        assert_eq!(lab.words.next()["ready"], true);
        lab
    }

    /// Waits until the hand controls the robot, which is when its recording exists.
    fn wait_for_control(&self) {
        let record = self.folder.join("run/recording.mcap");
        within_reason(&self.hand, || record.exists());
    }

    /// Sends a fault or the end order to the robot.
    fn order(&mut self, order: &str) {
        writeln!(self.orders, "{order}").expect("an order");
    }

    /// Ends the robot and returns its last output. Asserts that it has moved, and that it was stopped at the end.
    fn robots_end(&mut self) -> Value {
        self.order("end");
        let told = self.words.next();
        assert!(self.robot.0.wait().expect("its end").success());
        assert!(told["moved"].as_u64() > Some(0), "{told}");
        assert_eq!(told["last"], json!([0.0, 0.0, 0.0]), "{told}");
        told
    }

    fn recording(&self) -> Recording {
        Recording::read(self.folder.join("run/recording.mcap")).expect("a recording")
    }
}

/// Configuration of the simulated robot: the finger of `experiment` at home, and a wall.
fn robot(experiment: &Experiment, timing: Timing) -> Value {
    let (_, home) = fingers_at_home(&experiment.config).expect("a finger");
    let layout = ElementLayout::new(&LayoutConfig::default());
    let elements: Vec<_> = (0..layout.elements.len())
        .map(|n| layout.tip(n).to_array())
        .collect();
    let finger = experiment.config.hand.finger[0].three_joints();
    let finger = finger.expect("three joints");
    json!({
        "joints": ["first", "second", "third"],
        "home": home[0].as_slice(),
        "speed": timing.speed,
        "sim_time": timing.sim_time,
        "finger": {
            "links": finger.links, "base": finger.base_position, "elements": elements, "wall": -0.018, "stiffness": 200.0,
        },
    })
}

/// Settings of all programs: the hand resumes automatically when data are fresh again, and has a long time limit.
fn settings(timing: Timing) -> [String; 4] {
    [
        format!("--set=control.stale_periods={}", timing.stale_periods),
        format!("--set=task.screw.strokes={}", timing.strokes),
        "--set=control.resume=fresh".into(),
        "--set=time_limit=600".into(),
    ]
}

fn rig(folder: &Path, timing: Timing, link: &str, graph: &str) -> Running {
    let mut command = feeler(
        folder,
        &["ros2-rig", "robot.toml", "--domain-id=0", "--connect", link],
    );
    command.args(["--ros-listen", graph, "--ros-connect", &unused_endpoint()]);
    if timing.sim_time {
        command.args(["--use-sim-time", "--speed", &timing.speed.to_string()]);
    }
    command.args(settings(timing));
    Running::start(folder, "rig", command)
}

fn hand(folder: &Path, timing: Timing, link: &str) -> Running {
    let mut command = feeler(
        folder,
        &["hand", "robot.toml", "--out=run", "--listen", link],
    );
    command
        .args(["--speed", &timing.speed.to_string()])
        .args(settings(timing));
    Running::start(folder, "hand", command)
}

#[test]
fn robot_and_fingertip_complete_an_experiment() {
    let Some(python) = pyzeros() else { return };
    let mut lab = Lab::start("ros2-robot", &python, SIMULATED);
    let (status, said) = lab.hand.wait();
    assert_eq!(status, Some(0), "{said}");
    lab.rig.signal("INT");
    let (status, said) = lab.rig.wait();
    assert_eq!(status, Some(0), "{said}");
    lab.robots_end();
    let recording = lab.recording();
    let pressed = recording.fingers[0]
        .flags
        .iter()
        .map(|flags| flags.grasp_force);
    let most = pressed.fold(0.0, f64::max);
    assert!((0.4..2.0).contains(&most), "{most} N");
    let summary = fs::read_to_string(lab.folder.join("run/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&summary).expect("JSON");
    assert_eq!(summary["state"], "done", "{summary}");
    assert!(!summary["strokes"].as_array().expect("strokes").is_empty());
}

#[test]
fn faults_of_robot_and_fingertip_stop_the_hand() {
    let Some(python) = pyzeros() else { return };
    let mut lab = Lab::start("ros2-robot-faults", &python, REAL);
    lab.wait_for_control();
    let faults = [
        ("silent", "stopped: the joint angles"),
        ("numb", "stopped: the forces of finger 0"),
        ("late 5", "stopped: the "),
        ("late -5", "stopped: the "),
    ];
    let count = |lab: &Lab, words: &str| lab.hand.said().matches(words).count();
    for (fault, words) in faults {
        let stops = count(&lab, words);
        lab.order(fault);
        lab.hand.wait_for_times(words, stops + 1);
        let resumed = count(&lab, "resuming");
        lab.order("well");
        lab.hand.wait_for_times("resuming", resumed + 1);
    }
    // NaN forces are not a matter of age, so the hand must be resumed explicitly.
    lab.order("nan");
    lab.hand
        .wait_for("stopped: element 0 of finger 0 has no valid force");
    lab.order("well");
    let resumed = count(&lab, "resuming");
    within_reason(&lab.hand, || {
        // The hand stops again if valid forces have not arrived yet.
        let told = run(
            &lab.folder,
            &["resume", "robot.toml", "--connect", &lab.link],
        );
        assert_ne!(told.status, Some(2), "{told:?}");
        count(&lab, "resuming") > resumed
    });
    let said = lab.rig.said();
    for words in ["receiving the robot's joint states", "ahead of the clock"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    // For a silent robot, the message reports either old stamps or the time without messages; this extracts the latter.
    let silences = said
        .split("/joint_states: ")
        .filter_map(|told| told.split_once("no message for "))
        .filter_map(|(_, told)| told.split_once(" s")?.0.parse().ok());
    let silence = silences.fold(0.0, f64::max);
    assert!(silence > 0.005 * REAL.stale_periods, "{silence} s: {said}");
    lab.hand.signal("INT");
    lab.hand.wait();
    lab.rig.signal("INT");
    lab.rig.wait();
    // No command to move was based on older data than permitted.
    let most = REAL.stale_periods * 0.01 + HELD_UP;
    let told = lab.robots_end();
    assert!(told["most_age"].as_f64() <= Some(most), "{told}");
    assert!(reasons(&lab.recording()).len() >= 5);
}

#[test]
fn robot_works_again_after_its_programs_were_killed() {
    let Some(python) = pyzeros() else { return };
    let mut lab = Lab::start("ros2-robot-killed", &python, SIMULATED);
    lab.wait_for_control();
    // Without a hand, the rig stops the robot and accepts the next hand.
    lab.hand.kill();
    let link = unused_endpoint();
    lab.rig.kill();
    fs::remove_dir_all(lab.folder.join("run")).expect("the run");
    lab.hand = hand(&lab.folder, SIMULATED, &link);
    lab.rig = rig(&lab.folder, SIMULATED, &link, &lab.graph);
    let (status, said) = lab.hand.wait();
    assert_eq!(status, Some(0), "{said}");
    lab.rig.signal("TERM");
    lab.rig.wait();
    lab.robots_end();
}

#[test]
fn experiments_without_a_robot_are_refused() {
    let folder = folder("ros2-robot-refused");
    let refused = |arguments: &[&str], words: &[&str]| {
        let arguments = [&["ros2-rig"], arguments].concat();
        run(&folder, &arguments).refused(words);
    };
    experiment(&folder);
    refused(&["cap-closing"], &["[ros2]", "cap-closing"]);
    refused(
        &["robot.toml"],
        &["tcp/localhost:7447", "--listen tcp/127.0.0.1:7557"],
    );
    refused(
        &["robot.toml", "--use-sim-time", "--speed=max"],
        &["--speed max", "a number"],
    );
    let set = |setting: &str, words: &[&str]| refused(&["robot.toml", "--set", setting], words);
    set(
        "ros2.finger.0.wrench=/w",
        &["ros2.finger[0].wrench", "not both", "has 41"],
    );
    set(
        "ros2.finger.0.joints.1=first",
        &["ros2.finger[0].joints", "a different name for each joint"],
    );
    set("ros2.commands=", &["ros2.commands"]);
}
