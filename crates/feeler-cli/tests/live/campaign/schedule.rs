//! Random schedules of faults.

use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Length of a schedule (s of the rig's time).
pub const LENGTH: f64 = 20.0;
/// Ratio of the rig's time to real time.
pub const SPEED: &str = "2";

/// A fault or an order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// Kills a program and restarts it after the given time (s).
    Restart(Program, f64),
    /// Freezes a program for the given time (s).
    Freeze(Program, f64),
    /// Stops the hand, and resumes that stop after the given time (s), or never if `None`.
    Stop(Option<f64>),
    /// Sends a resume order without a matching stop.
    Resume,
    /// Sends garbage on all topics.
    Garbage,
}

/// A program of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Program {
    World,
    Sense(usize),
    /// Only frozen, never killed.
    Hand,
}

/// Timed faults drawn from a seed.
#[derive(Debug, Clone)]
pub struct Schedule {
    pub seed: u64,
    /// Impairment of the hand's network, as a `--rehearse` argument.
    pub rehearse: String,
    /// Events with their times since the hand's first step (s of real time), in order.
    pub events: Vec<(f64, Event)>,
}

impl Schedule {
    pub fn new(seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let wall = LENGTH / SPEED.parse::<f64>().expect("a speed");
        let count = random.random_range(3..9);
        let mut times: Vec<f64> = (0..count).map(|_| wall * random.random::<f64>()).collect();
        times.sort_by(f64::total_cmp);
        let events = times
            .into_iter()
            .map(|time| (time, event(&mut random)))
            .collect();
        let loss = *[0.0, 0.0, 0.02, 0.1].choose(&mut random).expect("one");
        let jitter = *[0.0, 0.0, 0.002, 0.01].choose(&mut random).expect("one");
        let duplicate = *[0.0, 0.1].choose(&mut random).expect("one");
        Self {
            seed,
            rehearse: format!(
                "--rehearse=loss={loss},jitter={jitter},duplicate={duplicate},seed={seed}"
            ),
            events,
        }
    }
}

fn event(random: &mut Pcg64) -> Event {
    let programs = [Program::World, Program::Sense(0), Program::Sense(1)];
    let program = *programs.choose(random).expect("one");
    let a_while = random.random_range(0.05..1.5);
    match random.random_range(0..7) {
        0 | 1 => Event::Restart(program, a_while),
        2 => Event::Freeze(program, a_while),
        3 => Event::Freeze(Program::Hand, a_while.min(0.5)),
        4 => Event::Stop(random.random_bool(0.8).then_some(a_while)),
        5 => Event::Resume,
        _ => Event::Garbage,
    }
}
