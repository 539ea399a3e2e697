//! The programs of one rig, each a process; they end with the test.

use super::program::{Ended, feeler};
use feeler::record::{Phase, Recording};
use std::fs::{self, File};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// After this a program is taken to hang: far longer than any takes on a busy machine.
const HANGS: Duration = Duration::from_secs(90);

/// Programs in real time need the computer for themselves, and free ports stay free.
static ALONE: Mutex<()> = Mutex::new(());

/// Holds back the other tests of programs until it is dropped.
pub fn alone() -> MutexGuard<'static, ()> {
    // A test that failed has ended its programs, too.
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A program that runs, its output in files.
pub struct Running {
    child: Child,
    log: PathBuf,
}

impl Running {
    /// Starts the program `name` in `folder`.
    pub fn start(folder: &Path, name: &str, arguments: &[&str]) -> Self {
        let log = folder.join(format!("{name}.log"));
        let file = File::create(&log).expect("a log");
        let mut command = feeler(folder, arguments);
        command.stdout(file.try_clone().expect("the log"));
        let child = command.stderr(file).stdin(Stdio::null()).spawn();
        Self {
            child: child.expect("the program"),
            log,
        }
    }

    /// What it has said.
    pub fn said(&self) -> String {
        fs::read_to_string(&self.log).expect("its log")
    }

    /// Waits until it says `words`.
    pub fn wait_for(&mut self, words: &str) {
        let start = Instant::now();
        while !self.said().contains(words) {
            let ended = self.child.try_wait().expect("its status");
            let hangs = start.elapsed() > HANGS;
            assert!(ended.is_none() && !hangs, "no {words:?} in {}", self.said());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Sends it a signal, as in `KILL`.
    pub fn signal(&self, signal: &str) {
        let signal = format!("-{signal}");
        let id = self.child.id().to_string();
        let status = Command::new("kill").args([&signal, &id]).status();
        assert!(status.expect("kill").success(), "{}", self.said());
    }

    /// Its exit status and all it said, once it has ended.
    pub fn wait(&mut self) -> (Option<i32>, String) {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("its status") {
                return (status.code(), self.said());
            }
            assert!(start.elapsed() < HANGS, "it hangs: {}", self.said());
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// World and both sensors of the reference experiment, and where their hand listens.
pub struct Rig {
    pub folder: PathBuf,
    pub endpoint: String,
    pub settings: Vec<String>,
    pub world: Running,
    pub senses: Vec<Running>,
    /// Released last: after the programs have ended.
    _alone: MutexGuard<'static, ()>,
}

impl Rig {
    /// The programs, all but the hand: `settings` for each, `speed` for the world.
    pub fn start(folder: PathBuf, speed: &str, settings: &[&str]) -> Self {
        let _alone = alone();
        let port = TcpListener::bind("127.0.0.1:0").expect("a port");
        let endpoint = format!("tcp/{}", port.local_addr().expect("its address"));
        drop(port);
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        let mut world = vec![
            "world",
            "cap-closing",
            "--speed",
            speed,
            "--connect",
            &endpoint,
        ];
        world.extend(settings.iter().map(String::as_str));
        let world = Running::start(&folder, "world", &world);
        let sense = |finger| sense(&folder, &endpoint, finger, &settings);
        Self {
            senses: (0..2).map(sense).collect(),
            world,
            folder,
            endpoint,
            settings,
            _alone,
        }
    }

    /// Starts the sensor program of `finger`, again.
    pub fn start_sense(&mut self, finger: usize) {
        self.senses[finger] = sense(&self.folder, &self.endpoint, finger, &self.settings);
    }

    /// Starts the hand, with `more` arguments.
    pub fn hand(&self, more: &[&str]) -> Running {
        let mut hand = vec![
            "hand",
            "cap-closing",
            "--out",
            "run",
            "--listen",
            &self.endpoint,
        ];
        hand.extend(self.settings.iter().map(String::as_str));
        hand.extend(more);
        Running::start(&self.folder, "hand", &hand)
    }

    /// Says `stop` or `resume` to the hand.
    pub fn order(&self, order: &str) -> Ended {
        let arguments = [
            order,
            "cap-closing",
            "--connect",
            &self.endpoint,
            "--from",
            "the test",
        ];
        Ended::of(
            feeler(&self.folder, &arguments)
                .output()
                .expect("the program"),
        )
    }

    /// What the hand recorded.
    pub fn recording(&self) -> Recording {
        Recording::read(self.folder.join("run/recording.mcap")).expect("a recording")
    }
}

fn sense(folder: &Path, endpoint: &str, finger: usize, settings: &[String]) -> Running {
    let number = finger.to_string();
    let mut sense = vec![
        "sense",
        "rig:",
        "--publish",
        "--finger",
        &number,
        "--connect",
        endpoint,
    ];
    sense.extend(settings.iter().map(String::as_str));
    Running::start(folder, &format!("sense{finger}"), &sense)
}

/// The reasons for which the hand was stopped, by the record, in order.
pub fn reasons(recording: &Recording) -> Vec<String> {
    let stopped = recording
        .task
        .iter()
        .filter(|task| task.phase == Phase::Stopped);
    let reasons = stopped.map(|task| task.reason.clone());
    reasons.filter(|reason| !reason.is_empty()).collect()
}

/// Control steps whose command moves a finger, and how old the oldest data were that they were made from,
/// s by the rig's time.
pub fn ages_of_moves(recording: &Recording) -> Vec<f64> {
    let fingers = &recording.fingers;
    let moves = (0..recording.task.len()).filter(|&step| {
        let mut velocities = fingers
            .iter()
            .map(|finger| finger.command[step].joint_velocity);
        velocities.any(|velocity| velocity != [0.0; 3])
    });
    let age = |step: usize| {
        let felt = fingers.iter().map(|finger| finger.tactile[step].stamp);
        recording.task[step].stamp - felt.fold(f64::INFINITY, f64::min)
    };
    moves.map(age).collect()
}
