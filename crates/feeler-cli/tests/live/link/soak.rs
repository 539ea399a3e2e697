//! Programs that run for long neither grow nor lose count of their steps.

use super::faults::{GOES_ON, STALE};
use super::hostile::be_hostile;
use crate::how_many::how_many;
use crate::rig::{Running, Setup, ages_of_moves};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// How many times as fast as real time, and the control period, s of the rig's time.
const SPEED: f64 = 4.0;
const PERIOD: f64 = 0.01;

/// What a program may grow by after its first quarter, KiB: what its allocator keeps in reserve differs from time to time by
/// that, and more on a busy computer. A hand that kept but one frame of forces a step would grow by 500 MiB in half an hour.
const GROWTH: u64 = 4096;

/// Bytes of a recording for each byte that its writer keeps for the index at its end: 0.6 KB of a chunk of 512 KiB, and a
/// fifth more for the allocator.
const RECORDED_FOR_INDEX: u64 = 700;

/// `FEELER_SOAK_SECONDS` of it; a minute unless told.
#[test]
fn for_a_long_time_memory_stays_and_every_step_is_accounted_for() {
    let run = soak("link-soak", how_many("FEELER_SOAK_SECONDS", 60), |_, _| {});
    check_steps(&run.said, wall_time(&run.folder));
}

/// The same for as long as somebody does all the harm that he can, and for half a minute unless told.
#[test]
fn hostile_traffic_for_a_long_time_takes_no_memory() {
    let seconds = how_many("FEELER_SOAK_SECONDS", 30);
    let run = soak("link-hostile-soak", seconds, be_hostile);
    assert!(run.said.contains("malformed"), "{}", run.said);
}

/// A run that is over.
struct Soaked {
    folder: PathBuf,
    said: String,
}

/// A run of so many `seconds`, `beside` which something else goes on at the hand's endpoint until it is told that all
/// is over: no program grows, and nothing moves on stale data.
fn soak(name: &str, seconds: usize, beside: fn(&str, &AtomicBool)) -> Soaked {
    let endless = ["task.screw.strokes=100000", "time_limit=1e5", GOES_ON];
    let rig = Setup::new(name).with(&endless).at("4").start();
    let mut hand = rig.moving_hand(&[]);
    let folder = rig.setup.folder.join("run");
    let recording = folder.join("recording.mcap");
    let sizes = || {
        let programs = [&hand, &rig.world, &rig.senses[0], &rig.senses[1]];
        let recorded = fs::metadata(&recording).expect("the recording").len();
        (programs.map(Running::resident), recorded)
    };
    let over = AtomicBool::new(false);
    let ((early, recorded_early), (late, recorded)) = thread::scope(|scope| {
        scope.spawn(|| beside(&rig.setup.endpoint, &over));
        let quarter = Duration::from_secs(seconds as u64) / 4;
        thread::sleep(quarter);
        let early = sizes();
        thread::sleep(3 * quarter);
        let late = sizes();
        over.store(true, Ordering::Relaxed);
        (early, late)
    });
    let index = (recorded - recorded_early) / RECORDED_FOR_INDEX / 1024;
    hand.signal("INT");
    let (_, said) = hand.wait();
    eprintln!("resident, KiB: {early:?}, {late:?}, {index} of them for the index\n{said}");
    // Only the hand, which is the first, records.
    let allowed = [GROWTH + index, GROWTH, GROWTH, GROWTH];
    for ((early, late), allowed) in early.into_iter().zip(late).zip(allowed) {
        assert!(late <= early + allowed, "{early} KiB, {late} KiB: {said}");
    }
    let ages = ages_of_moves(&rig.setup.recording());
    assert!(!ages.is_empty(), "{said}");
    assert!(ages.iter().all(|age| *age <= STALE), "{said}");
    Soaked { folder, said }
}

/// Time that the hand was at work, s by the computer's clock.
fn wall_time(run: &Path) -> f64 {
    let summary = fs::read_to_string(run.join("summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    summary["wall_time"].as_f64().expect("the run's time")
}

/// Steps that were met and those that were missed are as many as there was time for.
fn check_steps(said: &str, wall_time: f64) {
    let steps = number_before(said, " steps, late by");
    let missed = number_before(said, " periods missed");
    let time = (steps + missed) * PERIOD / SPEED;
    // A period at either end, and the last step itself, which may have been held up.
    assert!(
        (time - wall_time).abs() < 0.05,
        "{time} s, {wall_time} s: {said}"
    );
}

/// The number that ends where `words` begin.
pub fn number_before(said: &str, words: &str) -> f64 {
    let (before, _) = said.split_once(words).expect("the hand's account");
    let number = before.rsplit([' ', '\n']).next().unwrap_or_default();
    number
        .parse()
        .unwrap_or_else(|_| panic!("no number before {words:?} in {said}"))
}
