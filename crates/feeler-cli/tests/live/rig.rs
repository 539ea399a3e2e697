//! The programs of one rig, each a process; they end with the test.

// Not every test program uses all of it.
#![allow(dead_code)]

use crate::ports::unused_endpoint;
use crate::program::{Ended, feeler, folder, run};
use feeler_link::transport::Link;
use feeler_link::transport::LinkConfig;
use feeler_record::{Phase, Recording};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// After this a program is taken to hang: far longer than any takes on a busy machine.
pub const HANGS: Duration = Duration::from_secs(400);

/// Seconds of the rig in a second, unless a test says otherwise: so slow that data stay fresh for 3.5 s of the computer's
/// time, for which a busy one may hold up any program.
pub const SLOW: &str = "0.01";

/// The same for rigs that must get somewhere: data stay fresh for 0.14 s, and a busy computer makes them stale at times.
pub const QUARTER: &str = "0.25";

/// Rigs whose data are soon stale need the computer for themselves; rigs that mostly wait run beside them.
static ALONE: Mutex<()> = Mutex::new(());

/// Holds back the other rigs in a hurry until it is dropped.
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
    /// Starts `command`, its output in the log `name` of `folder`.
    pub fn start(folder: &Path, name: &str, command: Command) -> Self {
        Self::start_with(folder, name, command, Stdio::null())
    }

    /// The same with an `input`.
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

    /// What it has said.
    pub fn said(&self) -> String {
        fs::read_to_string(&self.log).expect("its log")
    }

    /// Waits until it says `words`.
    pub fn wait_for(&mut self, words: &str) {
        self.wait_for_times(words, 1);
    }

    /// Waits until it has said `words` so many `times`.
    pub fn wait_for_times(&mut self, words: &str, times: usize) {
        let start = Instant::now();
        while self.said().matches(words).count() < times {
            let ended = self.child.try_wait().expect("its status");
            let hangs = start.elapsed() > HANGS;
            assert!(
                ended.is_none() && !hangs,
                "not {times} times {words:?} in {}",
                self.said()
            );
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Its standard input, where it was started with one.
    pub fn input(&mut self) -> ChildStdin {
        self.child.stdin.take().expect("an input")
    }

    /// Its memory that is resident, KiB.
    pub fn resident(&self) -> u64 {
        let path = format!("/proc/{}/status", self.child.id());
        let status = fs::read_to_string(path).expect("its status");
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let number = line.and_then(|line| line.trim().split(' ').next());
        number.expect("its memory").parse().expect("KiB")
    }

    /// Sends it a signal, as in `KILL`.
    pub fn signal(&self, signal: &str) {
        let signal = format!("-{signal}");
        let id = self.child.id().to_string();
        let status = Command::new("kill").args([&signal, &id]).status();
        assert!(status.expect("kill").success(), "{}", self.said());
    }

    /// Kills it, and waits until it is gone.
    pub fn kill(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// Whether it has not ended.
    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().expect("its status").is_none()
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
        self.kill();
    }
}

/// How the programs of a rig are started.
#[derive(Debug, Clone)]
pub struct Setup {
    pub folder: PathBuf,
    /// The experiment, and what the rig is called.
    pub experiment: &'static str,
    /// Where the hand listens.
    pub endpoint: String,
    /// Of the rig's time, as hand and world are told.
    pub speed: &'static str,
    /// The program that is the rig, with arguments of its own.
    pub rig_program: Vec<String>,
    /// Of all programs that work by the experiment.
    pub settings: Vec<String>,
    /// How the hand takes part in the link, and how the others do.
    pub hand_link: Vec<String>,
    pub link: Vec<String>,
    /// Network namespaces of the hand and of the others.
    pub namespaces: Option<[String; 2]>,
}

impl Setup {
    /// A [`SLOW`] rig of the test called `name`; its forces are sensed without pictures, for speed.
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

    /// The same of another experiment.
    pub fn of(self, experiment: &'static str) -> Self {
        Self { experiment, ..self }
    }

    /// The same at another `speed`.
    pub fn at(self, speed: &'static str) -> Self {
        Self { speed, ..self }
    }

    /// What `time` (s) of the rig takes of the computer's time; nothing where the rig waits for the hand.
    pub fn takes(&self, time: f64) -> Duration {
        let speed = self.speed.parse().unwrap_or(f64::INFINITY);
        Duration::from_secs_f64(time / speed)
    }

    /// The same with `settings` of the experiment.
    pub fn with(mut self, settings: &[&str]) -> Self {
        let settings = settings.iter().map(|setting| format!("--set={setting}"));
        self.settings.extend(settings);
        self
    }

    /// The same over TLS, the hand listening at the address `hand` and the others at `others`.
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

    /// The rig as far as the hand: world and sensors, which wait for it.
    pub fn start(self) -> Rig {
        let alone = self.is_in_a_hurry().then(alone);
        Rig {
            world: self.world(),
            senses: vec![self.sense(0), self.sense(1)],
            setup: self,
            _alone: alone,
        }
    }

    /// Whether a busy computer makes its data stale: it is neither in lockstep nor slow.
    fn is_in_a_hurry(&self) -> bool {
        let speed: Option<f64> = self.speed.parse().ok();
        speed.is_some_and(|speed| speed > 0.05)
    }

    /// The same with servos as its rig: `more` arguments of `feeler rig`.
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

    /// The same of a program that reads from the test.
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

    /// Starts the hand, whose files the system lets grow to so many blocks (512 B, or 1 KiB by some shells).
    #[cfg(target_os = "linux")]
    pub fn hand_with_files_up_to(&self, blocks: usize) -> Running {
        let hand = self.command(0, &["hand", self.experiment, "--out", "run"]);
        // What exceeds it is an error then, and not the end.
        let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &limited, "sh"]);
        command.arg(hand.get_program()).args(hand.get_args());
        command.args(["--listen", &self.endpoint, "--flush-interval=0.05"]);
        command.args(["--speed", self.speed]);
        command.args(&self.settings).current_dir(&self.folder);
        Running::start(&self.folder, "hand", command)
    }

    /// Says `stop` or `resume` to the hand, by `link`.
    pub fn order(&self, order: &str, link: &[String]) -> Ended {
        self.say(order, "the test", link)
    }

    /// Says `stop` or `resume` to the hand, in the name of `from`.
    pub fn order_from(&self, order: &str, from: &str) -> Ended {
        self.say(order, from, &self.hand_link)
    }

    fn say(&self, order: &str, from: &str, link: &[String]) -> Ended {
        let mut command = self.command(0, &[order, self.experiment, "--from", from]);
        command.args(["--connect", &self.endpoint]).args(link);
        Ended::of(command.output().expect("the program"))
    }

    /// The program with these arguments, in one of the namespaces.
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

    /// What the hand recorded.
    pub fn recording(&self) -> Recording {
        Recording::read(self.folder.join("run/recording.mcap")).expect("a recording")
    }
}

/// World and both sensors of the reference experiment, each a process.
pub struct Rig {
    pub setup: Setup,
    pub world: Running,
    pub senses: Vec<Running>,
    /// Released last: after the programs have ended.
    _alone: Option<MutexGuard<'static, ()>>,
}

impl Rig {
    /// Starts the sensor program of `finger` again.
    pub fn start_sense(&mut self, finger: usize) {
        self.senses[finger] = self.setup.sense(finger);
    }

    /// Starts the world again.
    pub fn start_world(&mut self) {
        self.world = self.setup.world();
    }

    /// Starts the hand and waits until it moves: it approaches the cap for two seconds.
    pub fn moving_hand(&self, more: &[&str]) -> Running {
        let mut hand = self.setup.hand(more);
        hand.wait_for("waiting for");
        let log = self.setup.folder.join("run/recording.mcap");
        within_reason(&hand, || log.exists());
        // Two control periods.
        std::thread::sleep(Duration::from_millis(300) + self.setup.takes(0.02));
        // A machine that stood still for longer than data stay fresh.
        if hand.said().contains("stopped: the ") {
            self.resume(&hand);
        }
        hand
    }

    /// Tells the hand to go on until it does: the data may not be fresh yet, and it refuses then.
    pub fn resume(&self, hand: &Running) -> String {
        self.resume_from(hand, "the test")
    }

    /// The same in the name of `from`; what it was told then.
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

/// Somebody on the same computer, who connects to the hand.
pub fn connect(endpoint: &str) -> Arc<Link> {
    let peer = Link::open(&LinkConfig {
        rig: "cap-closing".into(),
        connect: vec![endpoint.into()],
        ..LinkConfig::default()
    });
    Arc::new(peer.expect("a place in the link"))
}

/// Waits until `done`, for no longer than until the `hand` is taken to hang.
pub fn within_reason(hand: &Running, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < HANGS, "{}", hand.said());
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Makes certificates of the authority `lab` for `computer`, of all rights; the arguments that name them.
pub fn certificates(folder: &Path, lab: &str, computer: &str) -> Vec<String> {
    run(folder, &["certificates", lab, computer]).done();
    vec!["--certificates".into(), format!("{lab}/{computer}")]
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
