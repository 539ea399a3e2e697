//! Programs that run for long neither grow nor lose count of their steps.

use super::faults::STALE;
use super::rig::{Running, Setup, ages_of_moves};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

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
    let seconds = std::env::var("FEELER_SOAK_SECONDS").ok();
    let seconds: f64 = seconds.map_or(60.0, |s| s.parse().expect("FEELER_SOAK_SECONDS in s"));
    let endless = [
        "task.screw.strokes=100000",
        "time_limit=1e5",
        "control.resume=fresh",
    ];
    let mut setup = Setup::new("link-soak").with(&endless);
    setup.speed = "4";
    let rig = setup.start();
    let mut hand = rig.moving_hand(&[]);
    let start = Instant::now();
    std::thread::sleep(Duration::from_secs_f64(seconds / 4.0));
    let programs = || [&hand, &rig.world, &rig.senses[0], &rig.senses[1]].map(Running::resident);
    let recording = rig.setup.folder.join("run/recording.mcap");
    let recorded = || fs::metadata(&recording).expect("the recording").len();
    let (early, recorded_early) = (programs(), recorded());
    while start.elapsed().as_secs_f64() < seconds {
        std::thread::sleep(Duration::from_millis(100));
    }
    let late = programs();
    let index = (recorded() - recorded_early) / RECORDED_FOR_INDEX / 1024;
    hand.signal("INT");
    let (_, said) = hand.wait();
    eprintln!("resident, KiB: {early:?}, {late:?}, {index} of them for the index\n{said}");
    // Only the hand, which is the first, records.
    let allowed = [GROWTH + index, GROWTH, GROWTH, GROWTH];
    for ((early, late), allowed) in early.into_iter().zip(late).zip(allowed) {
        assert!(late <= early + allowed, "{early} KiB, {late} KiB: {said}");
    }
    check_steps(&said, wall_time(&rig.setup.folder.join("run")));
    let ages = ages_of_moves(&rig.setup.recording());
    assert!(ages.iter().all(|age| *age <= STALE), "{said}");
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
