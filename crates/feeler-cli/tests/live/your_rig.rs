//! The check list of docs/your-rig.md. Every command of the page that works without hardware is run against emulated
//! servos, and the output quoted on the page must equal the printed output except for numbers.

#![cfg(target_os = "linux")]

use crate::ports::unused_endpoint;
use crate::printed::{Printed, blocks};
use crate::program::{Ended, feeler, folder, run};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

const PAGE: &str = include_str!("../../../../docs/your-rig.md");

/// Time after which a program is considered hung.
const HANGS: Duration = Duration::from_secs(400);

/// Maximum number of attempts of a command that needs servos. The emulated servos run in a separate process, which a
/// busy computer may delay for longer than the response timeout.
const TRIES: usize = 20;

/// Method by which a command of the page is tested.
#[derive(Debug, Clone, Copy, PartialEq)]
enum How {
    /// Not a command of feeler; skipped.
    Other,
    /// Run unchanged; must succeed.
    Run,
    /// Like [`Self::Run`], but with emulated servos.
    WithServos,
    /// Must be refused because there is no camera.
    WithoutCamera,
    /// Runs until it is interrupted, together with the other programs of a rig.
    InARig,
}
use How::{InARig, Other, Run, WithServos, WithoutCamera};

/// All commands of the page, in order.
const COMMANDS: &[(&str, How)] = &[
    (
        "cargo install --path crates/feeler-cli --features camera,drives,link,top",
        Other,
    ),
    ("feeler init my-rig.toml --from bench-rig --full", Run),
    ("feeler check my-rig.toml", Run),
    ("feeler rig my-rig.toml --drives emulated", InARig),
    (
        "feeler sense rig: --experiment my-rig.toml --finger 0 --publish",
        InARig,
    ),
    (
        "feeler sense rig: --experiment my-rig.toml --finger 1 --publish",
        InARig,
    ),
    ("feeler hand my-rig.toml", InARig),
    ("feeler top my-rig", InARig),
    ("feeler stop my-rig", InARig),
    ("feeler resume my-rig", InARig),
    ("sudo usermod -aG dialout,video $USER", Other),
    ("ls -l /dev/serial/by-id /dev/v4l/by-id", Other),
    (
        "echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer",
        Other,
    ),
    (
        "feeler drives scan /dev/ttyUSB0 --protocol dynamixel --baud-rate 1000000 --largest-id 10",
        WithServos,
    ),
    ("feeler check my-rig.toml", Run),
    ("feeler drives check my-rig.toml", WithServos),
    (
        "feeler drives home my-rig.toml --output homed.toml",
        WithServos,
    ),
    ("mv homed.toml my-rig.toml", Run),
    ("feeler drives check my-rig.toml", WithServos),
    (
        "feeler drives jog my-rig.toml --finger 0 --joint 1 --by 3 --dry-run",
        WithServos,
    ),
    (
        "feeler drives jog my-rig.toml --finger 0 --joint 1 --by 3",
        WithServos,
    ),
    ("feeler rig my-rig.toml --dry-run", WithServos),
    ("feeler rig my-rig.toml --real-time", InARig),
    (
        "feeler sense /dev/video0 --experiment my-rig.toml --rate 60 --exposure 0.005 --record-frames -o look0.mcap",
        WithoutCamera,
    ),
    (
        "feeler sense /dev/video1 --experiment my-rig.toml --rate 60 --exposure 0.005 --record-frames -o look1.mcap",
        WithoutCamera,
    ),
    (
        "feeler locate untouched.png -o layout.toml --preview found.png",
        Run,
    ),
    (
        "feeler calibrate finger0 --live /dev/video0 --layout layout.toml \
         --force-sensor \"netft://192.168.1.1?cpf=1000000&cpt=1000000\" --force-axes y,x,-z -o finger0.calibration.toml",
        WithoutCamera,
    ),
    ("feeler hand my-rig.toml --real-time", InARig),
    (
        "feeler sense /dev/video0 --experiment my-rig.toml --finger 0 --publish",
        WithoutCamera,
    ),
    (
        "feeler sense /dev/video1 --experiment my-rig.toml --finger 1 --publish",
        WithoutCamera,
    ),
    ("feeler top my-rig", InARig),
    ("feeler rig my-rig.toml --real-time", InARig),
    (
        "feeler hand my-rig.toml --real-time --out runs/first-touch",
        InARig,
    ),
    (
        "feeler hand my-rig.toml --real-time --out runs/first-grasp",
        InARig,
    ),
    ("feeler report runs/first-grasp", Run),
    ("feeler resume my-rig", InARig),
    ("feeler resume my-rig --number 2", InARig),
];

#[test]
fn page_contains_exactly_these_commands() {
    let page: Vec<_> = blocks(PAGE, "sh").collect();
    let tried: Vec<_> = COMMANDS.iter().map(|(command, _)| *command).collect();
    assert_eq!(page, tried);
}

/// Splits a command line like a shell: quoted parts stay together.
fn words(command: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (index, part) in command.split('"').enumerate() {
        match index % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_string)),
            _ => words.push(part.to_string()),
        }
    }
    words
}

/// A program that logs its output to a file and is killed on drop.
struct Running {
    child: Child,
    log: PathBuf,
}

impl Running {
    fn start(folder: &Path, name: &str, arguments: &[String]) -> Self {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let log = folder.join(format!("{name}.log"));
        let file = File::create(&log).expect("a log");
        let mut command = feeler(folder, &arguments);
        command
            .stdout(file.try_clone().expect("the log"))
            .stderr(file);
        let child = command.spawn().expect("the program");
        Self { child, log }
    }

    fn said(&self) -> String {
        fs::read_to_string(&self.log).expect("its log")
    }

    fn wait_for(&mut self, words: &str) {
        let start = Instant::now();
        while !self.said().contains(words) {
            let ended = self.child.try_wait().expect("its status");
            let hangs = start.elapsed() > HANGS;
            assert!(ended.is_none() && !hangs, "no {words:?} in {}", self.said());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Interrupts the program like Ctrl-C, and returns its output.
    fn interrupt(mut self) -> String {
        let id = self.child.id().to_string();
        let status = Command::new("kill").args(["-INT", &id]).status();
        assert!(status.expect("kill").success());
        self.child.wait().expect("its end");
        self.said()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs a command until it succeeds, at most [`TRIES`] times.
fn try_with_servos(folder: &Path, arguments: &[&str]) -> Ended {
    let mut ended = run(folder, arguments);
    for _ in 1..TRIES {
        if ended.status == Some(0) {
            break;
        }
        ended = run(folder, arguments);
    }
    ended
}

#[test]
fn check_list_works_with_emulated_servos() {
    let folder = folder("your-rig");
    let mut printed = Printed::default();
    let mut bus = None;
    for &(command, how) in COMMANDS {
        let mut arguments = words(command);
        if how == WithServos && bus.is_none() {
            bus = Some(connect(&folder));
        }
        if let Some((_, port)) = &bus {
            for argument in &mut arguments {
                *argument = argument.replace("/dev/ttyUSB0", port);
            }
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        match (how, arguments[0]) {
            (Other | InARig, _) => continue,
            (Run, "mv") => {
                fs::rename(folder.join(arguments[1]), folder.join(arguments[2])).expect("a file");
                continue;
            }
            _ => {}
        }
        prepare(&folder, command);
        let arguments = &arguments[1..];
        match how {
            Run => printed.add(&run(&folder, arguments).done()),
            WithServos => {
                let ended = try_with_servos(&folder, arguments);
                assert_eq!(ended.status, Some(0), "{command}: {ended:?}");
                printed.add(&ended.stdout);
            }
            WithoutCamera => {
                let arguments = arguments
                    .iter()
                    .map(|a| a.replace("/dev/video", "/dev/video9"));
                let arguments: Vec<String> = arguments.collect();
                let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
                let said = run(&folder, &arguments).refused(&["feeler: "]);
                let usage = ["Usage:", "error:"];
                assert!(
                    !usage.iter().any(|word| said.contains(word)),
                    "{command}: {said}"
                );
            }
            Other | InARig => {}
        }
    }
    // Step 6 serves the servos that the earlier steps have configured, also from a file without a simulated world.
    let text = fs::read_to_string(folder.join("my-rig.toml")).expect("the file");
    let (real, _) = text.split_once("\n[sim]\n").expect("a simulated world");
    fs::write(folder.join("real.toml"), real).expect("a file");
    let checked = run(&folder, &["check", "real.toml"]).done();
    assert!(checked.contains("real rig"), "{checked}");
    let rig = ["rig", "real.toml"].map(String::from);
    let nowhere = format!("--connect={}", unused_endpoint());
    let mut rig = Running::start(&folder, "rig", &[&rig[..], &[nowhere]].concat());
    rig.wait_for("serving the servos of my-rig");
    let said = rig.interrupt();
    assert!(said.contains("torque is off"), "{said}");
    printed.add(&said);
    drop(bus);
    rehearse(&folder, &mut printed);
    assert!(blocks(PAGE, "text").count() > 20);
    printed.check(blocks(PAGE, "text"));
}

/// Performs the manual work that the page requires before `command`.
fn prepare(folder: &Path, command: &str) {
    if command.starts_with("feeler locate") {
        let loads =
            "calibrate --simulated my-rig.toml --loads 40 --write-loads loads -o simulated.toml";
        let arguments: Vec<&str> = loads.split(' ').collect();
        run(folder, &arguments);
        fs::copy(
            folder.join("loads/untouched.png"),
            folder.join("untouched.png"),
        )
        .expect("an image");
    } else if command.starts_with("feeler report") {
        let grasp =
            "run my-rig.toml --sensing direct --set task.screw.strokes=1 --out runs/first-grasp";
        let arguments: Vec<&str> = grasp.split(' ').collect();
        run(folder, &arguments);
    }
}

/// Starts emulated servos for my-rig.toml, and writes their port and longer timeouts to that file.
fn connect(folder: &Path) -> (Running, String) {
    let arguments = ["drives", "emulate", "my-rig.toml"].map(String::from);
    let mut bus = Running::start(folder, "bus", &arguments);
    bus.wait_for("/dev/pts/");
    let port = bus.said().trim().to_string();
    let file = folder.join("my-rig.toml");
    let text = fs::read_to_string(&file).expect("the file");
    let patient = [
        ("/dev/ttyUSB0", port.as_str()),
        ("reply_timeout = 0.015", "reply_timeout = 1.0"),
        ("bus_watchdog = 0.2", "bus_watchdog = 2.5"),
        ("stale_periods = 5.0", "stale_periods = 100.0"),
    ];
    let patient = patient.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "no {from:?} in {text}");
        text.replacen(from, to, 1)
    });
    fs::write(file, patient).expect("the file");
    (bus, port)
}

/// Starts the programs of a rig like the page, but slowly; stops and resumes the hand; and collects all output.
fn rehearse(folder: &Path, printed: &mut Printed) {
    let endpoint = unused_endpoint();
    let with = |command: &str, more: &[&str]| {
        let known = COMMANDS.iter().any(|(listed, _)| *listed == command);
        assert!(known, "{command}");
        let more = more.iter().map(ToString::to_string);
        words(command)
            .into_iter()
            .skip(1)
            .chain(more)
            .collect::<Vec<_>>()
    };
    let (connect, listen) = (
        format!("--connect={endpoint}"),
        format!("--listen={endpoint}"),
    );
    let (connect, listen) = (connect.as_str(), listen.as_str());
    let settings = [
        "--sensing=direct",
        "--set=control.stale_periods=5.0",
        "--set=time_limit=600",
    ];
    let member = [&settings[..], &[connect]].concat();
    let slow = ["--speed=0.02"];
    let rig = with(
        "feeler rig my-rig.toml --drives emulated",
        &[&member[..], &slow].concat(),
    );
    let mut programs = vec![Running::start(folder, "rig", &rig)];
    for finger in 0..2 {
        let sense =
            format!("feeler sense rig: --experiment my-rig.toml --finger {finger} --publish");
        let name = format!("sense{finger}");
        programs.push(Running::start(folder, &name, &with(&sense, &member)));
    }
    let hand = with(
        "feeler hand my-rig.toml --real-time --out runs/first-touch",
        &[&settings[..], &slow, &[listen]].concat(),
    );
    let mut hand = Running::start(folder, "hand", &hand);
    hand.wait_for("waiting for");
    let recording = folder.join("runs/first-touch/recording.mcap");
    let start = Instant::now();
    while !recording.exists() {
        assert!(start.elapsed() < HANGS, "{}", hand.said());
        std::thread::sleep(Duration::from_millis(10));
    }
    let order = |command: &str| {
        let arguments = with(command, &[connect]);
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        run(folder, &arguments)
    };
    let stopped = order("feeler stop my-rig");
    assert_eq!(stopped.status, Some(0), "{stopped:?}");
    printed.add(&stopped.stdout);
    hand.wait_for("stopped: stop requested by the command line");
    // A busy computer may also have made data stale, which causes another stop.
    let start = Instant::now();
    loop {
        let resumed = order("feeler resume my-rig");
        printed.add(&resumed.stdout);
        if resumed.stdout.contains("the hand has resumed") {
            break;
        }
        assert!(start.elapsed() < HANGS, "{resumed:?}");
    }
    printed.add(&hand.interrupt());
    for program in programs {
        printed.add(&program.interrupt());
    }
}

/// Step 11: the finger that finds nothing gives up. Here, a small cap is near the other finger.
#[test]
fn a_finger_that_finds_nothing_gives_up() {
    let folder = folder("your-rig-touch");
    let arguments = [
        "run",
        "bench-rig",
        "--sensing=direct",
        "--set=sim.object.cap.position=[-0.006, 0.0, 0.1]",
        "--set=sim.object.cap.shape.cylinder.radius=0.010",
        "--out=run",
    ];
    let ended = run(&folder, &arguments);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    let words = "finger 1 travelled 0.0100 m from home without a grasp (limit 0.01 m)";
    assert!(ended.stdout.contains(words), "{ended:?}");
    assert!(PAGE.contains(words));
}

#[test]
fn invalid_rigs_and_arguments_are_refused() {
    let folder = folder("your-rig-refused");
    let refused = |arguments: &[&str], words: &[&str]| run(&folder, arguments).refused(words);
    let nowhere = format!("--connect={}", unused_endpoint());
    refused(
        &["rig", "cap-closing", &nowhere],
        &["expected a table [drives]"],
    );
    let port = "--port=/dev/not-there";
    refused(
        &["rig", "bench-rig", &nowhere, port],
        &["/dev/not-there", "serial port"],
    );
    refused(
        &["rig", "bench-rig", "--dry-run", port],
        &["/dev/not-there", "serial port"],
    );
    refused(
        &["rig", "bench-rig", "--speed=0.5"],
        &["--speed 0.5", "real time"],
    );
    let max = ["rig", "bench-rig", "--drives=emulated", "--speed=max"];
    refused(&max, &["--speed max", "a number"]);
    refused(
        &["rig", "bench-rig", "--drives=emulated", port],
        &["--port", "--drives"],
    );
    refused(
        &["drives", "emulate", "--fault=fire"],
        &["\"fire\"", "silent=ID"],
    );
    refused(&["drives", "emulate", "--speed=2"], &["0.01 to 1"]);
    fs::write(folder.join("bus.csv"), "mine").expect("a file");
    refused(
        &["drives", "emulate", "--log=bus.csv"],
        &["bus.csv", "--force"],
    );
}
