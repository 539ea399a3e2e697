//! The programs of one rig.

use crate::process::Process;
use crate::program::{Ended, feeler, folder, run};
use crate::promises::Recorded;
use std::fs;
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::Command;
use std::thread;
use std::time::Duration;

/// How the programs of a rig are started.
pub struct Rig {
    pub folder: PathBuf,
    /// Where the hand listens.
    pub endpoint: String,
    pub speed: &'static str,
    /// Arguments of all programs that work by the experiment.
    pub common: Vec<String>,
    /// How the others reach the hand, and who they are.
    pub joining: Vec<String>,
    /// The same of the hand.
    pub hand_link: Vec<String>,
    /// Network namespaces of the hand and of the others.
    pub namespaces: Option<[String; 2]>,
}

/// World and sensors of a rig.
pub struct Others {
    pub world: Process,
    pub senses: Vec<Process>,
}

impl Rig {
    /// A rig of the test called `name` on a port of its own.
    pub fn new(name: &str, speed: &'static str) -> Self {
        let port = free_port();
        Self {
            folder: folder(&format!("link-{name}")),
            endpoint: format!("tcp/127.0.0.1:{port}"),
            speed,
            common: Vec::new(),
            joining: Vec::new(),
            hand_link: Vec::new(),
            namespaces: None,
        }
    }

    /// The same with more arguments for all programs.
    pub fn with(mut self, arguments: &[&str]) -> Self {
        self.common.extend(arguments.iter().map(|a| a.to_string()));
        self
    }

    pub fn world(&self, more: &[&str]) -> Process {
        let speed = format!("--speed={}", self.speed);
        self.join(&["world", "cap-closing", &speed], more)
    }

    pub fn sense(&self, finger: usize, more: &[&str]) -> Process {
        let finger = finger.to_string();
        self.join(&["sense", "rig:", "--publish", "--finger", &finger], more)
    }

    /// World and both sensors.
    pub fn others(&self, more: &[&str]) -> Others {
        Others {
            world: self.world(more),
            senses: vec![self.sense(0, more), self.sense(1, more)],
        }
    }

    /// The hand, which records in the folder `run`.
    pub fn hand(&self, more: &[&str]) -> Process {
        self.hand_in("run", more)
    }

    pub fn hand_in(&self, out: &str, more: &[&str]) -> Process {
        self.hand_at(&self.endpoint, out, more)
    }

    pub fn hand_at(&self, endpoint: &str, out: &str, more: &[&str]) -> Process {
        let mut command = self.command(0, &["hand", "cap-closing", "--out", out]);
        command.args(["--listen", endpoint]);
        command.args(&self.hand_link).args(&self.common).args(more);
        Process::start(command)
    }

    /// Says `order` (`stop` or `resume`) to the hand.
    pub fn order(&self, order: &str, more: &[&str]) -> Ended {
        let mut command = self.command(0, &[order, "cap-closing"]);
        command.args(["--connect", &self.endpoint]);
        Process::start({
            command.args(&self.hand_link).args(more);
            command
        })
        .end()
    }

    /// Tells the hand to stop by links of one's own.
    pub fn order_by(&self, link: &[String]) -> Ended {
        let mut command = feeler(&self.folder, &["stop", "cap-closing"]);
        command.args(link);
        Process::start(command).end()
    }

    fn join(&self, what: &[&str], more: &[&str]) -> Process {
        let mut command = self.command(1, what);
        command.args(["--connect", &self.endpoint]);
        command.args(&self.joining).args(&self.common).args(more);
        Process::start(command)
    }

    fn command(&self, namespace: usize, arguments: &[&str]) -> Command {
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

    /// Tells the hand to go on until it does: the data may not be fresh yet. How many lines it had said then.
    pub fn resume(&self, hand: &Process, said: usize) -> usize {
        for _ in 0..60 {
            let ended = self.order("resume", &[]);
            assert_eq!(ended.status, Some(0), "{ended:?}");
            thread::sleep(Duration::from_millis(300));
            if hand.warnings() > said {
                break;
            }
        }
        hand.wait_to_warn("going on", said)
    }

    /// What the hand recorded.
    pub fn recorded(&self) -> Recorded {
        self.recorded_in("run")
    }

    pub fn recorded_in(&self, run: &str) -> Recorded {
        Recorded::of(&self.folder.join(run))
    }

    /// Waits until the hand has recorded so many bytes.
    pub fn wait_for_record(&self, bytes: u64) {
        self.wait_for_record_of("run", bytes);
    }

    /// Waits until the hand has recorded a second or so more.
    pub fn wait_for_more_record(&self) {
        self.wait_for_record(self.record("run") + 300_000);
    }

    pub fn wait_for_record_of(&self, run: &str, bytes: u64) {
        for _ in 0..6000 {
            if self.record(run) >= bytes {
                return;
            }
            thread::sleep(Duration::from_millis(20));
        }
        panic!("{} bytes of {bytes} are recorded", self.record(run));
    }

    fn record(&self, run: &str) -> u64 {
        let path = self.folder.join(run).join("recording.mcap");
        fs::metadata(path).map_or(0, |file| file.len())
    }

    /// What `feeler run` makes of the same experiment.
    pub fn in_one_program(&self) -> Recorded {
        let mut arguments = vec!["run", "cap-closing", "--out", "alone"];
        arguments.extend(self.common.iter().map(String::as_str));
        run(&self.folder, &arguments);
        Recorded::of(&self.folder.join("alone"))
    }
}

impl Others {
    /// Ends them all; what the world said.
    pub fn interrupt(self) -> Ended {
        for sense in self.senses {
            sense.interrupt();
        }
        let world = self.world.interrupt();
        assert_eq!(world.status, Some(0), "{world:?}");
        world
    }
}

/// The number before `what` in the world's last line.
pub fn count(world: &Ended, what: &str) -> u64 {
    let before = world.stdout.split(what).next().unwrap_or_default();
    let number = before.trim_end().rsplit(' ').next().unwrap_or_default();
    number
        .parse()
        .unwrap_or_else(|_| panic!("no {what:?} in {world:?}"))
}

pub const STALE: &str = "stale commands refused";
pub const WATCHDOG: &str = "stops by the watchdog";

fn free_port() -> u16 {
    let socket = TcpListener::bind("127.0.0.1:0").expect("a free port");
    socket.local_addr().expect("its address").port()
}
