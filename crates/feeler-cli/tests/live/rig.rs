//! The programs of a rig, each a process that is killed on drop.

// Not every test binary uses all items.
#![allow(dead_code)]

use crate::ports::unused_endpoint;
use crate::program::{Ended, feeler, folder, run};
use feeler_link::transport::{Link, LinkConfig};
use feeler_record::{Phase, Recording};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Time after which a program is considered hung, far longer than any needs on a busy computer.
pub const HANGS: Duration = Duration::from_secs(400);

/// Default ratio of the rig's time to real time, so slow that data stay fresh for 3.5 s of real time, even if a busy
/// computer delays a program.
pub const SLOW: &str = "0.01";

/// Speed for tests that must complete strokes. Data stay fresh for only 0.14 s of real time, so a busy computer makes
/// them stale at times.
pub const QUARTER: &str = "0.25";

/// Lock of the rigs whose data soon become stale: they run one at a time. Slow rigs run in parallel.
static ALONE: Mutex<()> = Mutex::new(());

/// Locks out the other fast rigs until the guard is dropped.
pub fn alone() -> MutexGuard<'static, ()> {
    // A failed test has ended its programs, too.
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A running program that logs its output to a file.
pub struct Running {
    child: Child,
    log: PathBuf,
}

impl Running {
    /// Starts `command` with its output in the log `name` in `folder`.
    pub fn start(folder: &Path, name: &str, command: Command) -> Self {
        Self::start_with(folder, name, command, Stdio::null())
    }

    /// Like [`Self::start`], but with `input` as standard input.
    pub fn start_with(folder: &Path, name: &str, mut command: Command, input: Stdio) -> Self {
        let log = folder.join(format!("{name}.log"));
        let file = File::create(&log).expect("a log");
        command.stdout(file.try_clone().expect("the log"));
        let child = command.stderr(file).stdin(input).spawn();
        Self {
            child: child.expect("the program"),
            log,
        }
    }

    /// The output so far.
    pub fn said(&self) -> String {
        fs::read_to_string(&self.log).expect("its log")
    }

    /// Waits until the output contains `words`.
    pub fn wait_for(&mut self, words: &str) {
        self.wait_for_times(words, 1);
    }

    /// Waits until the output contains `words` at least `times` times.
    pub fn wait_for_times(&mut self, words: &str, times: usize) {
        let start = Instant::now();
        while self.said().matches(words).count() < times {
            let ended = self.child.try_wait().expect("its status");
            let hangs = start.elapsed() > HANGS;
            assert!(
                ended.is_none() && !hangs,
                "expected {words:?} {times} times in {}",
                self.said()
            );
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Takes the program's standard input, which must be piped.
    pub fn input(&mut self) -> ChildStdin {
        self.child.stdin.take().expect("an input")
    }

    /// Resident memory (KiB).
    pub fn resident(&self) -> u64 {
        let path = format!("/proc/{}/status", self.child.id());
        let status = fs::read_to_string(path).expect("its status");
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let number = line.and_then(|line| line.trim().split(' ').next());
        number.expect("its memory").parse().expect("KiB")
    }

    /// Sends a signal such as `KILL`.
    pub fn signal(&self, signal: &str) {
        let signal = format!("-{signal}");
        let id = self.child.id().to_string();
        let status = Command::new("kill").args([&signal, &id]).status();
        assert!(status.expect("kill").success(), "{}", self.said());
    }

    /// Kills the program and waits until it has ended.
    pub fn kill(&mut self) {
        // The program may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// Returns `true` until the program has ended.
    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().expect("its status").is_none()
    }

    /// Waits until the program ends, and returns its exit status and its output.
    pub fn wait(&mut self) -> (Option<i32>, String) {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("its status") {
                return (status.code(), self.said());
            }
            assert!(
                start.elapsed() < HANGS,
                "the program hangs: {}",
                self.said()
            );
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Configuration of a rig's programs.
#[derive(Debug, Clone)]
pub struct Setup {
    pub folder: PathBuf,
    /// Experiment, whose name is also that of the rig.
    pub experiment: &'static str,
    /// Endpoint at which the hand listens.
    pub endpoint: String,
    /// Ratio of the rig's time to real time, for hand and world; "max" is lockstep.
    pub speed: &'static str,
    /// Command that serves the rig, with its additional arguments.
    pub rig_program: Vec<String>,
    /// Settings of all programs that load the experiment.
    pub settings: Vec<String>,
    /// Link arguments of the hand.
    pub hand_link: Vec<String>,
    /// Link arguments of the other programs.
    pub link: Vec<String>,
    /// Network namespaces of the hand and of the others.
    pub namespaces: Option<[String; 2]>,
}

impl Setup {
    /// A [`SLOW`] rig for the test `name`. Forces are sensed without images, for speed.
    pub fn new(name: &str) -> Self {
        Self {
            folder: folder(name),
            experiment: "cap-closing",
            endpoint: unused_endpoint(),
            speed: SLOW,
            rig_program: vec!["world".into()],
            settings: vec!["--sensing=direct".into()],
            hand_link: Vec::new(),
            link: Vec::new(),
            namespaces: None,
        }
    }

    /// Sets the experiment.
    pub fn of(self, experiment: &'static str) -> Self {
        Self { experiment, ..self }
    }

    /// Sets the speed.
    pub fn at(self, speed: &'static str) -> Self {
        Self { speed, ..self }
    }

    /// Real time that `time` (s of the rig's time) takes; zero in lockstep.
    pub fn takes(&self, time: f64) -> Duration {
        let speed = self.speed.parse().unwrap_or(f64::INFINITY);
        Duration::from_secs_f64(time / speed)
    }

    /// Adds `settings` of the experiment.
    pub fn with(mut self, settings: &[&str]) -> Self {
        let settings = settings.iter().map(|setting| format!("--set={setting}"));
        self.settings.extend(settings);
        self
    }

    /// Uses TLS with certificates for the hand at address `hand` and for the other programs at `others`.
    pub fn with_certificates(mut self, hand: &str, others: &str) -> Self {
        self.endpoint = self
            .endpoint
            .replace("tcp/127.0.0.1", &format!("tls/{hand}"));
        self.hand_link = certificates(&self.folder, "lab", hand);
        self.link = match others == hand {
            true => self.hand_link.clone(),
            false => certificates(&self.folder, "lab", others),
        };
        self
    }

    /// Starts world and sensors, which then wait for the hand.
    pub fn start(self) -> Rig {
        let alone = self.is_in_a_hurry().then(alone);
        Rig {
            world: self.world(),
            senses: vec![self.sense(0), self.sense(1)],
            setup: self,
            _alone: alone,
        }
    }

    /// Returns `true` if a busy computer makes the data stale: the rig is neither in lockstep nor slow.
    fn is_in_a_hurry(&self) -> bool {
        let speed: Option<f64> = self.speed.parse().ok();
        speed.is_some_and(|speed| speed > 0.05)
    }

    /// Serves servos with `feeler rig` and its arguments `more`.
    pub fn driven(mut self, more: &[&str]) -> Self {
        self.rig_program = ["rig"]
            .iter()
            .chain(more)
            .map(ToString::to_string)
            .collect();
        self
    }

    fn world(&self) -> Running {
        let mut arguments: Vec<&str> = self.rig_program.iter().map(String::as_str).collect();
        arguments.extend([self.experiment, "--speed", self.speed]);
        self.join("world", &arguments)
    }

    fn sense(&self, finger: usize) -> Running {
        let number = finger.to_string();
        let of_rig = ["sense", "rig:", "--experiment", self.experiment];
        let arguments = [&of_rig[..], &["--publish", "--finger", &number]].concat();
        self.join(&format!("sense{finger}"), &arguments)
    }

    /// Starts a program on the rig's computer.
    fn join(&self, name: &str, arguments: &[&str]) -> Running {
        Running::start(&self.folder, name, self.joining(arguments))
    }

    /// Like [`Self::join`], but with a piped standard input.
    pub fn join_with_input(&self, name: &str, arguments: &[&str]) -> Running {
        Running::start_with(&self.folder, name, self.joining(arguments), Stdio::piped())
    }

    fn joining(&self, arguments: &[&str]) -> Command {
        let mut command = self.command(1, arguments);
        command.args(["--connect", &self.endpoint]);
        command.args(&self.link).args(&self.settings);
        command
    }

    /// Starts the hand, with `more` arguments.
    pub fn hand(&self, more: &[&str]) -> Running {
        let mut command = self.command(0, &["hand", self.experiment, "--out", "run"]);
        command.args(["--listen", &self.endpoint, "--speed", self.speed]);
        command
            .args(&self.hand_link)
            .args(&self.settings)
            .args(more);
        Running::start(&self.folder, "hand", command)
    }

    /// Starts the hand with a file size limit of `blocks` blocks (512 B, or 1 KiB in some shells).
    #[cfg(target_os = "linux")]
    pub fn hand_with_files_up_to(&self, blocks: usize) -> Running {
        let hand = self.command(0, &["hand", self.experiment, "--out", "run"]);
        // A write beyond the limit then fails instead of ending the program.
        let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &limited, "sh"]);
        command.arg(hand.get_program()).args(hand.get_args());
        command.args(["--listen", &self.endpoint, "--flush-interval=0.05"]);
        command.args(["--speed", self.speed]);
        command.args(&self.settings).current_dir(&self.folder);
        Running::start(&self.folder, "hand", command)
    }

    /// Sends a `stop` or `resume` order to the hand over `link`.
    pub fn order(&self, order: &str, link: &[String]) -> Ended {
        self.say(order, "the test", link)
    }

    /// Sends a `stop` or `resume` order to the hand in the name of `from`.
    pub fn order_from(&self, order: &str, from: &str) -> Ended {
        self.say(order, from, &self.hand_link)
    }

    fn say(&self, order: &str, from: &str, link: &[String]) -> Ended {
        let mut command = self.command(0, &[order, self.experiment, "--from", from]);
        command.args(["--connect", &self.endpoint]).args(link);
        Ended::of(command.output().expect("the program"))
    }

    /// The program with `arguments`, in network namespace number `namespace` if the rig has namespaces.
    pub fn command(&self, namespace: usize, arguments: &[&str]) -> Command {
        let program = feeler(&self.folder, arguments);
        let Some(namespaces) = &self.namespaces else {
            return program;
        };
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &namespaces[namespace]]);
        command.arg(program.get_program()).args(program.get_args());
        command.current_dir(&self.folder);
        command
    }

    /// The hand's recording.
    pub fn recording(&self) -> Recording {
        Recording::read(self.folder.join("run/recording.mcap")).expect("a recording")
    }
}

/// World and both sensors of a rig, each a process.
pub struct Rig {
    pub setup: Setup,
    pub world: Running,
    pub senses: Vec<Running>,
    /// Dropped last, after the programs have ended.
    _alone: Option<MutexGuard<'static, ()>>,
}

impl Rig {
    /// Restarts the sensor program of `finger`.
    pub fn start_sense(&mut self, finger: usize) {
        self.senses[finger] = self.setup.sense(finger);
    }

    /// Restarts the world.
    pub fn start_world(&mut self) {
        self.world = self.setup.world();
    }

    /// Starts the hand and waits until it moves. It approaches the cap for two seconds.
    pub fn moving_hand(&self, more: &[&str]) -> Running {
        let mut hand = self.setup.hand(more);
        hand.wait_for("waiting for");
        let log = self.setup.folder.join("run/recording.mcap");
        within_reason(&hand, || log.exists());
        // Two control periods.
        std::thread::sleep(Duration::from_millis(300) + self.setup.takes(0.02));
        // The computer may have stalled for longer than data stay fresh.
        if hand.said().contains("stopped: the ") {
            self.resume(&hand);
        }
        hand
    }

    /// Repeats a resume order until the hand accepts it; the hand refuses while data are stale. Returns the response.
    pub fn resume(&self, hand: &Running) -> String {
        self.resume_from(hand, "the test")
    }

    /// Like [`Self::resume`], but in the name of `from`.
    pub fn resume_from(&self, hand: &Running, from: &str) -> String {
        let mut told = String::new();
        within_reason(hand, || {
            let ended = self.setup.order_from("resume", from);
            told = ended.stdout;
            ended.status == Some(0)
        });
        told
    }
}

/// Connects to the hand as another program on the same computer.
pub fn connect(endpoint: &str) -> Arc<Link> {
    let peer = Link::open(&LinkConfig {
        rig: "cap-closing".into(),
        connect: vec![endpoint.into()],
        ..LinkConfig::default()
    });
    Arc::new(peer.expect("a place in the link"))
}

/// Waits until `done` returns `true`. Panics with the output of `hand` after [`HANGS`].
pub fn within_reason(hand: &Running, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < HANGS, "{}", hand.said());
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Creates a certificate with all rights of the authority `lab` for `computer`, and returns the arguments that use it.
pub fn certificates(folder: &Path, lab: &str, computer: &str) -> Vec<String> {
    run(folder, &["certificates", lab, computer]).done();
    vec!["--certificates".into(), format!("{lab}/{computer}")]
}

/// Recorded reasons for which the hand was stopped, in order.
pub fn reasons(recording: &Recording) -> Vec<String> {
    let stopped = recording
        .task
        .iter()
        .filter(|task| task.phase == Phase::Stopped);
    let reasons = stopped.map(|task| task.reason.clone());
    reasons.filter(|reason| !reason.is_empty()).collect()
}

/// For each control step that moves a finger, the age of the oldest tactile data that it is based on (s of the rig's
/// time).
pub fn ages_of_moves(recording: &Recording) -> Vec<f64> {
    let fingers = &recording.fingers;
    let moves = (0..recording.task.len()).filter(|&step| {
        let mut velocities = fingers
            .iter()
            .map(|finger| finger.command[step].joint_velocity);
        velocities.any(|velocity| velocity != [0.0; 3].into())
    });
    let age = |step: usize| {
        let felt = fingers.iter().map(|finger| finger.tactile[step].stamp);
        recording.task[step].stamp - felt.fold(f64::INFINITY, f64::min)
    };
    moves.map(age).collect()
}
