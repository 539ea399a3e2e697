//! Long runs: memory use stays constant, and every control step is counted.

use super::faults::{GOES_ON, STALE};
use super::hostile::be_hostile;
use crate::how_many::how_many;
use crate::rig::{Running, Setup, ages_of_moves};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use std::{fs, thread};

/// Ratio of the rig's time to real time.
const SPEED: f64 = 4.0;
/// Control period (s of the rig's time).
const PERIOD: f64 = 0.01;

/// Permitted memory growth of a program after the first quarter of its run (KiB). The allocator's reserve varies by
/// this amount, and by more on a busy computer. A hand that leaked one tactile frame per step would grow by 500 MiB in
/// half an hour.
const GROWTH: u64 = 4096;

/// Recorded bytes per byte of the index that the writer keeps in memory: 0.6 KB for each chunk of 512 KiB, plus a fifth
/// for the allocator.
const RECORDED_FOR_INDEX: u64 = 700;

/// Runs for `FEELER_SOAK_SECONDS` (default 60).
#[test]
fn long_run_keeps_its_memory_and_counts_every_step() {
    let run = soak("link-soak", how_many("FEELER_SOAK_SECONDS", 60), |_, _| {});
    check_steps(&run.said, wall_time(&run.folder));
}

/// Like the test above, but with a hostile peer, and for half a minute by default.
#[test]
fn hostile_traffic_does_not_grow_memory() {
    let seconds = how_many("FEELER_SOAK_SECONDS", 30);
    let run = soak("link-hostile-soak", seconds, be_hostile);
    assert!(run.said.contains("malformed"), "{}", run.said);
}

/// A finished run.
struct Soaked {
    folder: PathBuf,
    said: String,
}

/// Runs a rig for `seconds` while `beside` runs in another thread with the hand's endpoint, until its flag is set.
/// Checks that no program grows and that no move uses stale data.
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
    // Only the hand, the first program, records.
    let allowed = [GROWTH + index, GROWTH, GROWTH, GROWTH];
    for ((early, late), allowed) in early.into_iter().zip(late).zip(allowed) {
        assert!(late <= early + allowed, "{early} KiB, {late} KiB: {said}");
    }
    let ages = ages_of_moves(&rig.setup.recording());
    assert!(!ages.is_empty(), "{said}");
    assert!(ages.iter().all(|age| *age <= STALE), "{said}");
    Soaked { folder, said }
}

/// Duration of the hand's run (s of real time).
fn wall_time(run: &Path) -> f64 {
    let summary = fs::read_to_string(run.join("summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    summary["wall_time"].as_f64().expect("the run's time")
}

/// Checks that executed and missed steps add up to the duration of the run.
fn check_steps(said: &str, wall_time: f64) {
    let steps = number_before(said, " steps, late by");
    let missed = number_before(said, " periods missed");
    let time = (steps + missed) * PERIOD / SPEED;
    // Tolerance for a partial period at either end and a delayed last step.
    assert!(
        (time - wall_time).abs() < 0.05,
        "{time} s, {wall_time} s: {said}"
    );
}

/// The number directly before `words`.
pub fn number_before(said: &str, words: &str) -> f64 {
    let (before, _) = said.split_once(words).expect("the hand's account");
    let number = before.rsplit([' ', '\n']).next().unwrap_or_default();
    number
        .parse()
        .unwrap_or_else(|_| panic!("no number before {words:?} in {said}"))
}
