//! Runs a schedule of faults, and checks the hand's recording for violations.

use super::schedule::{Event, Program, SPEED, Schedule};
use crate::rig::{Rig, Running, Setup, ages_of_moves, connect};
use feeler_link::transport::{Outlet, Topic};
use feeler_record::{Phase, Recording};
use std::collections::HashSet;
use std::fs;
use std::time::{Duration, Instant};

/// Age above which data are stale in the reference experiment (s), with a margin for rounding.
const STALE: f64 = 0.035 + 1e-9;

/// A rig under test, with the pending actions of its schedule.
struct Player {
    rig: Rig,
    hand: Running,
    /// Pending actions with their times.
    due: Vec<(Instant, Later)>,
    /// Number of requested stops.
    stops: usize,
    /// Numbers of the stops that were resumed.
    resumed: HashSet<usize>,
}

enum Later {
    Start(Program),
    Thaw(Program),
    Resume(usize),
}

/// Runs `schedule` and returns a summary.
///
/// # Errors
/// If the hand violated an invariant or ended unexpectedly.
pub fn play(schedule: &Schedule) -> Result<String, String> {
    let settings = [
        "time_limit=1e5",
        "task.screw.strokes=100000",
        "control.resume=fresh",
    ];
    let mut setup = Setup::new(&format!("campaign-{}", schedule.seed)).with(&settings);
    setup.speed = SPEED;
    let folder = setup.folder.clone();
    let rig = setup.start();
    let hand = rig.moving_hand(&[&schedule.rehearse]);
    let mut player = Player {
        rig,
        hand,
        due: Vec::new(),
        stops: 0,
        resumed: HashSet::new(),
    };
    let came = player.play(schedule);
    drop(player);
    // Keep the files of a failed run for inspection.
    if came.is_ok() {
        let _ = fs::remove_dir_all(folder);
    }
    came
}

impl Player {
    fn play(&mut self, schedule: &Schedule) -> Result<String, String> {
        let began = Instant::now();
        for &(time, event) in &schedule.events {
            self.wait_until(began + Duration::from_secs_f64(time));
            self.happen(event);
        }
        let last = self.due.iter().map(|(due, _)| *due).max();
        self.wait_until(last.unwrap_or(began) + Duration::from_secs(1));
        self.hand.signal("INT");
        let (status, said) = self.hand.wait();
        if status != Some(1) || said.contains("panicked") {
            return Err(format!("the hand ended with {status:?}: {said}"));
        }
        self.check(&self.rig.setup.recording(), &said)
    }

    /// Performs the actions that are due before `end`, then waits until `end`.
    fn wait_until(&mut self, end: Instant) {
        loop {
            self.due.sort_by_key(|(due, _)| std::cmp::Reverse(*due));
            match self.due.last() {
                Some((due, _)) if *due <= end => {
                    let (due, later) = self.due.pop().expect("the last");
                    std::thread::sleep(due.saturating_duration_since(Instant::now()));
                    self.catch_up(later);
                }
                _ => break,
            }
        }
        std::thread::sleep(end.saturating_duration_since(Instant::now()));
    }

    fn later(&mut self, after: f64, later: Later) {
        let due = Instant::now() + Duration::from_secs_f64(after);
        self.due.push((due, later));
    }

    fn program(&mut self, program: Program) -> &mut Running {
        match program {
            Program::World => &mut self.rig.world,
            Program::Sense(finger) => &mut self.rig.senses[finger],
            Program::Hand => &mut self.hand,
        }
    }

    fn happen(&mut self, event: Event) {
        match event {
            Event::Restart(program, after) => {
                self.program(program).kill();
                self.later(after, Later::Start(program));
            }
            Event::Freeze(program, after) => {
                // The program may have been killed meanwhile.
                if self.program(program).is_running() {
                    self.program(program).signal("STOP");
                    self.later(after, Later::Thaw(program));
                }
            }
            Event::Stop(resume) => {
                self.stops += 1;
                let number = self.stops;
                let said = self.rig.setup.order_from("stop", &name(number));
                // A frozen hand does not confirm the stop; the stop is resumed nonetheless.
                let _ = said;
                if let Some(after) = resume {
                    self.later(after, Later::Resume(number));
                }
            }
            Event::Resume => {
                let _ = self.rig.setup.order_from("resume", "a bystander");
            }
            Event::Garbage => {
                let peer = connect(&self.rig.setup.endpoint);
                std::thread::sleep(Duration::from_millis(200));
                let noise: Vec<u8> = (0..200u32).map(|k| (k * k * 31 + 7) as u8).collect();
                for topic in Topic::all(0).into_iter().cycle().take(500) {
                    let _ = peer.send(topic, noise.clone());
                }
            }
        }
    }

    fn catch_up(&mut self, later: Later) {
        match later {
            Later::Start(Program::World) => self.rig.start_world(),
            Later::Start(Program::Sense(finger)) => self.rig.start_sense(finger),
            Later::Start(Program::Hand) => {}
            Later::Thaw(program) => {
                if self.program(program).is_running() {
                    self.program(program).signal("CONT");
                }
            }
            Later::Resume(number) => {
                self.resumed.insert(number);
                let _ = self.rig.setup.order_from("resume", &name(number));
            }
        }
    }

    fn check(&self, recording: &Recording, said: &str) -> Result<String, String> {
        let ages = ages_of_moves(recording);
        let oldest = ages.iter().copied().fold(0.0, f64::max);
        if oldest > STALE {
            return Err(format!("the hand moved on data {oldest} s old: {said}"));
        }
        let task = &recording.task;
        if let Some(pair) = task.windows(2).find(|pair| pair[1].stamp < pair[0].stamp) {
            return Err(format!("time decreased at {} s: {said}", pair[1].stamp));
        }
        for number in (1..=self.stops).filter(|number| !self.resumed.contains(number)) {
            let told = |reason: &str| reason.ends_with(&name(number));
            let Some(at) = task.iter().position(|step| told(&step.reason)) else {
                continue;
            };
            if let Some(step) = task[at..].iter().find(|step| step.phase != Phase::Stopped) {
                let stamp = step.stamp;
                return Err(format!(
                    "the hand moved at {stamp} s despite stop {number}: {said}"
                ));
            }
        }
        let stops = task.iter().filter(|step| !step.reason.is_empty()).count();
        let moves = ages.len();
        Ok(format!(
            "{moves} moving steps, {stops} stops, data at most {oldest:.4} s old"
        ))
    }
}

/// Name of the client that requests stop `number`.
fn name(number: usize) -> String {
    format!("campaigner {number}")
}
