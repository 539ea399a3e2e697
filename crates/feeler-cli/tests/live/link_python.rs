//! An independent Python program watches forces over the link and stops the hand.
//!
//! Requires `pip install eclipse-zenoh==1.10.2 mcap-ros2-support==0.6.0` in the Python named by `FEELER_PYTHON`
//! (default `python3`). Without them the test reports that it is skipped, or fails if `FEELER_REQUIRE_ALL` is set.

use crate::program::{Ended, feeler, folder};
use feeler_record::Recording;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;

/// Name of the program that requests the stop.
const WATCHER: &str = "the watcher of the test";

/// Processes that are killed on drop.
#[derive(Default)]
struct Running(Vec<(String, Child)>);

impl Running {
    fn start(&mut self, name: &str, command: &mut Command) -> &mut Child {
        let child = command.spawn().expect(name);
        self.0.push((name.into(), child));
        &mut self.0.last_mut().expect("it was started").1
    }

    /// Waits until `child` has ended. The other processes must keep running.
    fn wait(&mut self, child: &mut Child) {
        while child.try_wait().expect("its state").is_none() {
            for (name, other) in &mut self.0 {
                let ended = other.try_wait().expect("its state");
                assert!(ended.is_none(), "{name} ended by itself: {ended:?}");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        for (_, child) in &mut self.0 {
            // The process may have ended already.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// The Python interpreter, or `None` if it does not have the packages.
fn python() -> Option<String> {
    let python = std::env::var("FEELER_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe = Command::new(&python)
        .args(["-c", "import zenoh, mcap_ros2"])
        .output();
    if probe.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    crate::skip::skipped(&format!(
        "{python} has no packages eclipse-zenoh and mcap-ros2-support"
    ));
    None
}

/// A program of the rig that logs its output to a separate file.
fn of_the_rig(folder: &Path, name: &str, arguments: &[&str], endpoint: &str) -> Command {
    let mut command = feeler(folder, arguments);
    command.args(["--sensing", "direct", "--connect", endpoint]);
    let log = File::create(folder.join(format!("{name}.log"))).expect("a file");
    command.stdout(log.try_clone().expect("the file again"));
    command.stderr(log);
    command
}

fn watcher(python: &str, endpoint: &str) -> Command {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut command = Command::new(python);
    command
        .arg(root.join("examples/python/watch_forces.py"))
        .args(["cap-closing", "--connect", endpoint])
        .args(["--stop-above", "1.0", "--from", WATCHER])
        .args(["--feeler", env!("CARGO_BIN_EXE_feeler")])
        .stdout(Stdio::piped());
    command
}

/// Reads until the watcher has reported the hand and both sensors, and returns its output.
fn read_until_all_are_there(said: &mut BufReader<ChildStdout>) -> String {
    let mut text = String::new();
    let expected = ["hand", "sense of finger 0", "sense of finger 1"];
    let heard = |text: &str, what: &&str| text.contains(&format!("found {what}, feeler "));
    while !expected.iter().all(|what| heard(&text, what)) {
        let read = said.read_line(&mut text).expect("lines");
        assert!(read > 0, "the watcher ended: {text}");
    }
    text
}

#[test]
fn python_program_reads_forces_and_stops_the_hand() {
    let Some(python) = python() else { return };
    let folder = folder("link-python");
    let endpoint = crate::ports::unused_endpoint();

    let mut running = Running::default();
    let arguments = ["hand", "cap-closing", "--sensing", "direct", "--out", "run"];
    let hand = feeler(&folder, &arguments)
        .args(["--listen", &endpoint, "--speed", "max"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut hand = hand.expect("the hand");
    for finger in ["0", "1"] {
        let arguments = ["sense", "rig:", "--finger", finger, "--publish"];
        let name = format!("sense-{finger}");
        running.start(
            &name,
            &mut of_the_rig(&folder, &name, &arguments, &endpoint),
        );
    }
    let watcher = running.start("watcher", &mut watcher(&python, &endpoint));
    let mut said = BufReader::new(watcher.stdout.take().expect("its output"));
    let mut text = read_until_all_are_there(&mut said);

    // The rig starts only now and runs in lockstep with the hand, so that the speed of this computer does not matter. A
    // hand that does not move ends at the experiment's time limit.
    let arguments = ["world", "cap-closing", "--speed", "max"];
    let mut world = of_the_rig(&folder, "world", &arguments, &endpoint);
    running.start("world", &mut world);
    running.wait(&mut hand);
    drop(running);
    said.read_to_string(&mut text).expect("the rest");

    // Lines such as `1.330 s  finger 1   1.1359 N  touch  element  0: 0.1578 -0.0026 0.8915 N`.
    for finger in 0..2 {
        let of_finger = format!("s  finger {finger}  ");
        let touches = |line: &str| line.contains(&of_finger) && line.contains("touch");
        let whole = |line: &&str| touches(line) && line.contains("element");
        assert!(text.lines().any(|line| whole(&line)), "{text}");
    }
    assert!(
        text.contains("more than 1.0 N, sent a stop to the hand"),
        "{text}"
    );
    let reason = format!("stop requested by {WATCHER}");
    let ended = Ended::of(hand.wait_with_output().expect("its output"));
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stderr.contains(&reason), "{ended:?}");
    assert!(ended.stdout.contains(&reason), "{ended:?}");
    let recording = Recording::read(folder.join("run/recording.mcap")).expect("a recording");
    let told = recording.task.iter().any(|task| task.reason == reason);
    assert!(told, "{:?}", recording.task.last());
}
