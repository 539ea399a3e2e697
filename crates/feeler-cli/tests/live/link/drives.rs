//! Servos as the rig of a distributed hand: they close the cap, and every failure stops the hand and is named.

use super::faults::{GOES_ON, NO_HURRY, STALE};
use super::restarts::film;
use crate::printed::{Printed, blocks};
use crate::rig::{QUARTER, Rig, Running, Setup, ages_of_moves, reasons, within_reason};
use feeler_drives::RigClock;
use feeler_drives::bus::Bus;
use feeler_drives::packet::Protocol;
use feeler_drives::registers::Registers;
use std::io::Write;
use std::process::{ChildStdin, Stdio};
use std::time::Duration;

/// Page whose console blocks show a servo failure.
const YOUR_RIG: &str = include_str!("../../../../../docs/your-rig.md");

/// Slow enough that data stay fresh for 3.3 s of real time.
const SPEED: &str = "0.03";

/// At [`SPEED`], a timeout of 6.7 s for responses and of 3.3 s for the watchdogs.
const PATIENT: [&str; 2] = ["drives.reply_timeout=0.2", "drives.bus_watchdog=0.1"];

/// The template's servos, emulated by a separate process, with rig, sensors and hand.
struct Bench {
    hand: Running,
    faults: ChildStdin,
    port: String,
    bus: Running,
    /// Dropped last, because it locks out other tests.
    rig: Rig,
}

impl Bench {
    /// Starts all programs and waits until the hand moves.
    fn start(name: &str) -> Self {
        let setup = Setup::new(name).of("bench-rig").at(SPEED);
        let mut setup = setup.with(&PATIENT).with(&[NO_HURRY]);
        setup.settings[0] = "--sensing=image".into();
        let mut arguments = vec![
            "drives",
            "emulate",
            "bench-rig",
            "--log=bus.csv",
            "--fault=-",
        ];
        let speed = format!("--speed={SPEED}");
        arguments.push(&speed);
        let command = setup.command(1, &arguments);
        let mut bus = Running::start_with(&setup.folder, "bus", command, Stdio::piped());
        bus.wait_for("/dev/pts/");
        let port = bus.said().trim().to_string();
        let mut rig = setup.driven(&["--port", &port]).start();
        rig.world.wait_for("serving the servos");
        rig.senses = vec![film(&rig, 0), film(&rig, 1)];
        let hand = rig.moving_hand(&[]);
        let faults = bus.input();
        let bench = Self {
            hand,
            faults,
            port,
            bus,
            rig,
        };
        within_reason(&bench.hand, || bench.moves() > 0);
        bench
    }

    fn inject(&mut self, fault: &str) {
        writeln!(self.faults, "{fault}").expect("the bus");
    }

    /// Packets on the bus so far.
    fn log(&self) -> Vec<Said> {
        let folder = &self.rig.setup.folder;
        let text = std::fs::read_to_string(folder.join("bus.csv.part")).expect("a log");
        // The last line may be incomplete.
        let (whole, _) = text.rsplit_once('\n').unwrap_or_default();
        whole.lines().skip(1).map(Said::read).collect()
    }

    /// Number of commands to move so far.
    fn moves(&self) -> usize {
        self.log().iter().filter(|said| said.moves()).count()
    }

    /// Waits for another command to move.
    fn moves_again(&self) {
        let before = self.moves();
        within_reason(&self.hand, || self.moves() > before);
    }

    /// Output of `feeler resume`.
    fn resume(&self, more: &[&str]) -> String {
        let setup = &self.rig.setup;
        let mut command = setup.command(0, &["resume", setup.experiment]);
        command.args(["--connect", &setup.endpoint]).args(more);
        let output = command.output().expect("the program");
        let said = [output.stdout, output.stderr].concat();
        String::from_utf8(said).expect("text")
    }

    /// Resumes the hand's stop, and the rig's stop by the number in the output. Returns the output of the first resume.
    fn resume_those_of_the_rig(&self) -> String {
        let said = self.resume(&[]);
        let listed = said.split_once(": the rig: ");
        if let Some((_, number)) = listed.and_then(|(before, _)| before.rsplit_once("stop ")) {
            self.resume(&["--number", number]);
        }
        said
    }

    /// Repeats [`Self::resume_those_of_the_rig`] until the hand has resumed, and returns all output.
    fn resume_all(&self) -> Printed {
        let mut printed = Printed::default();
        within_reason(&self.hand, || {
            let said = self.resume_those_of_the_rig();
            printed.add(&said);
            said.contains("the hand has resumed")
        });
        printed
    }

    /// Reads, as a second master, whether the watchdog of servo `id` has stopped it.
    fn is_stopped_by_watchdog(&self, id: u8) -> bool {
        let speed = SPEED.parse().expect("a number");
        let clock = RigClock::at_speed(speed);
        let how = (Protocol::Dynamixel, 1_000_000);
        let mut bus = Bus::open(&self.port, how, 0.2, clock).expect("the bus");
        let registers = Registers::of(Protocol::Dynamixel);
        let watchdog = registers.watchdog.expect("a watchdog");
        let fired = bus.read(id, watchdog).expect("an answer") == -1;
        fired && bus.read(id, registers.goal_velocity).expect("an answer") == 0
    }

    /// Ends hand and rig, and checks the recording and the bus log: a recorded reason contains all `words`, no move
    /// used stale data, and goals were sent only as [`check_log`] permits.
    fn check(self, words: &[&str]) {
        self.check_end(words, (0, "torque is off"));
    }

    /// Like [`Self::check`], but the rig ends with the `expected` status and prints `torque`.
    fn check_end(mut self, words: &[&str], (expected, torque): (i32, &str)) {
        self.hand.signal("INT");
        let (status, said) = self.hand.wait();
        assert_eq!(status, Some(1), "{said}");
        let recording = self.rig.setup.recording();
        let reasons = reasons(&recording);
        let named = |reason: &String| words.iter().all(|word| reason.contains(word));
        assert!(reasons.iter().any(named), "{reasons:?}, {said}");
        let ages = ages_of_moves(&recording);
        assert!(!ages.is_empty(), "the hand never moved: {said}");
        // The template's limit of 5 periods of 0.02 s.
        let oldest = ages.into_iter().fold(0.0, f64::max);
        assert!(oldest <= 0.1 + 1e-9, "{oldest} s, {said}");
        self.rig.world.signal("INT");
        let (status, said) = self.rig.world.wait();
        assert_eq!(status, Some(expected), "{said}");
        assert!(said.contains(torque), "{said}");
        // Sent twice, because the servos do not acknowledge it.
        within_reason(&self.bus, || {
            let log = self.log();
            log.iter().rev().take(2).all(|said| said.switches_off(6))
        });
        check_log(&self.log());
        assert!(self.bus.is_running());
    }
}

/// A packet on the bus.
#[derive(Debug)]
struct Said {
    by_master: bool,
    instruction: String,
    bytes: Vec<u8>,
}

impl Said {
    fn read(line: &str) -> Self {
        let cells: Vec<&str> = line.split(',').collect();
        let [_, from, _, instruction, bytes] = cells[..] else {
            panic!("{line:?}")
        };
        let byte = |at: usize| u8::from_str_radix(&bytes[at..at + 2], 16).expect("a byte");
        Self {
            by_master: from == "master",
            instruction: instruction.into(),
            bytes: (0..bytes.len()).step_by(2).map(byte).collect(),
        }
    }

    /// Values written to all servos at `address`, without their ids, or `None` for other packets.
    fn written(&self, address: u8) -> Option<Vec<&[u8]>> {
        match &self.bytes[..] {
            [low, 0, length, 0, values @ ..]
                if self.instruction == "sync_write" && *low == address =>
            {
                let of_servos = values.chunks(usize::from(*length) + 1);
                Some(of_servos.map(|of_servo| &of_servo[1..]).collect())
            }
            _ => None,
        }
    }

    /// Returns `true` if the packet sets a nonzero goal velocity.
    fn moves(&self) -> bool {
        let goals = self.written(104);
        goals.is_some_and(|goals| goals.concat().iter().any(|&byte| byte != 0))
    }

    /// Returns `true` if the packet disables the torque of `servos` servos.
    fn switches_off(&self, servos: usize) -> bool {
        self.written(64) == Some(vec![&[0_u8][..]; servos])
    }

    /// Returns `true` if the packet enables the torque of a servo.
    fn switches_on(&self) -> bool {
        self.by_master && self.instruction == "write" && self.bytes == [64, 0, 1]
    }
}

/// Checks that every goal follows a complete reading of all joints since the previous goal, and that no goal is sent
/// between a failed reading and the next time a servo's torque is enabled.
fn check_log(log: &[Said]) {
    let whole = log.iter().filter(|said| !said.by_master);
    let whole = whole.map(|said| said.bytes.len()).max().expect("answers");
    let (mut is_fresh, mut is_asked, mut has_failed) = (false, false, false);
    for said in log {
        if said.by_master && said.instruction == "fast_sync_read" {
            (is_fresh, is_asked) = (false, true);
        } else if !said.by_master && is_asked && said.bytes.len() == whole {
            (is_fresh, is_asked) = (true, false);
        } else if said.switches_on() {
            has_failed = false;
        } else if said.by_master && is_asked {
            // Another instruction was sent before all servos had responded.
            (has_failed, is_asked) = (true, false);
        }
        if said.moves() {
            assert!(is_fresh && !has_failed, "{said:?}");
            is_fresh = false;
        }
    }
}

#[test]
fn servos_perform_a_stroke() {
    let setup = Setup::new("link-drives-stroke").at(QUARTER);
    let setup = setup.with(&[NO_HURRY, GOES_ON, "task.screw.strokes=1"]);
    let rig = setup.driven(&["--drives=emulated"]).start();
    let mut hand = rig.setup.hand(&[]);
    // On a computer that stalls for 0.1 s of the rig's time, the servos fail, and their stop must be resumed.
    while hand.is_running() {
        if let Some(by) = stopped_by_rig(&hand.said()) {
            let from = format!("--from={by}");
            let mut command = rig.setup.command(0, &["resume", "cap-closing", &from]);
            command.args(["--connect", &rig.setup.endpoint]);
            command.output().expect("the program");
        }
        std::thread::sleep(Duration::from_millis(200));
    }
    let (status, said) = hand.wait();
    assert_eq!(status, Some(0), "{said} {}", rig.world.said());
    let recording = rig.setup.recording();
    let ages = ages_of_moves(&recording);
    assert!(ages.len() > 100, "{said}");
    assert!(ages.iter().all(|age| *age <= STALE), "{said}");
    // Like the first stroke of a single-process run.
    let cap = recording.cap.last().expect("the cap").angle;
    assert!(cap > 0.4, "{cap} rad, {said}");
}

/// Name of the rig, if it requested the latest stop and the hand has not resumed since.
fn stopped_by_rig(said: &str) -> Option<&str> {
    let (_, newest) = said.rsplit_once("stop requested by ")?;
    let (by, since) = newest.split_once('\n')?;
    (by.starts_with("the rig: ") && !since.contains("resuming")).then_some(by)
}

#[test]
fn silent_servo_is_named_and_stops_the_hand_until_it_responds() {
    let mut bench = Bench::start("link-drives-silent");
    bench.inject("silent=3");
    bench
        .hand
        .wait_for("stop requested by the rig: theta3 of finger 0: ");
    bench.rig.world.wait_for("servo 3");
    let refused = bench.rig.setup.order("resume", &[]);
    assert_ne!(refused.status, Some(0), "{refused:?}");
    // A resume while the servo is still silent repeats the message.
    bench.resume_those_of_the_rig();
    let again = "the drives stay stopped until the stop is resumed";
    bench.rig.world.wait_for_times(again, 2);
    assert!(bench.rig.world.is_running());
    // A servo that does not answer may still push.
    bench.check_end(
        &["the rig", "theta3 of finger 0", "servo 3"],
        (2, "torque may still be enabled"),
    );
}

#[test]
fn rebooted_servos_move_again_after_a_resume() {
    let mut bench = Bench::start("link-drives-reboot");
    bench.inject("reboot=3");
    bench.hand.wait_for("stop requested by the rig: ");
    let mut printed = bench.resume_all();
    bench.rig.world.wait_for("the drives are ready again");
    printed.add(&bench.rig.world.said());
    printed.check(blocks(YOUR_RIG, "console"));
    bench.moves_again();
    bench.check(&["the rig", "finger 0", "servo 3"]);
}

#[test]
fn watchdogs_stop_the_servos_if_the_rig_program_is_killed() {
    let mut bench = Bench::start("link-drives-killed");
    bench.rig.world.signal("KILL");
    bench.hand.wait_for("stopped: the joint angles");
    // The watchdog's 0.1 s, and a possible delay of the emulator.
    std::thread::sleep(bench.rig.setup.takes(0.12));
    for id in 1..=6 {
        assert!(bench.is_stopped_by_watchdog(id), "servo {id}");
    }
    bench.rig.start_world();
    bench.rig.world.wait_for("serving the servos");
    bench.resume_all();
    bench.moves_again();
    bench.check(&["the joint angles"]);
}

#[test]
fn frozen_rig_program_waits_for_a_resume_after_the_watchdogs_fire() {
    let mut bench = Bench::start("link-drives-frozen");
    bench.rig.world.signal("STOP");
    bench.hand.wait_for("stopped: the joint angles");
    std::thread::sleep(bench.rig.setup.takes(0.12));
    bench.rig.world.signal("CONT");
    bench
        .rig
        .world
        .wait_for("the drives stay stopped until the stop is resumed");
    bench.resume_all();
    bench.moves_again();
    bench.check(&["the joint angles"]);
}
