//! Failures stop the hand with a reason; it moves again after a resume.

use crate::rig::{Rig, Running, SLOW, Setup, ages_of_moves, reasons};
use std::time::Duration;

/// Age above which data are stale in the reference experiment (s), with a margin for rounding.
pub const STALE: f64 = 0.035 + 1e-9;

/// Resumes automatically after stale data, which a busy computer may cause.
pub const GOES_ON: &str = "control.resume=fresh";

/// Time limit that no test reaches.
pub const NO_HURRY: &str = "time_limit=600";

/// Final output of the programs.
pub struct LastWords {
    pub hand: String,
    pub world: String,
}

/// Ends the hand and checks its recording: a stop reason contains `words`, and no move used stale data. Returns the
/// final output of hand and world.
pub fn check(rig: &mut Rig, mut hand: Running, words: &str) -> LastWords {
    hand.signal("INT");
    let (status, said) = hand.wait();
    assert_eq!(status, Some(1), "{said}");
    let recording = rig.setup.recording();
    let reasons = reasons(&recording);
    let named = reasons.iter().any(|reason| reason.contains(words));
    assert!(named, "{reasons:?}, {said}");
    let ages = ages_of_moves(&recording);
    assert!(!ages.is_empty(), "the hand never moved: {said}");
    let oldest = ages.into_iter().fold(0.0, f64::max);
    assert!(oldest <= STALE, "{oldest} s, {said}");
    LastWords {
        hand: said,
        world: worlds_end(rig),
    }
}

fn worlds_end(rig: &mut Rig) -> String {
    rig.world.signal("INT");
    let (status, said) = rig.world.wait();
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("0 stale commands refused"), "{said}");
    said
}

#[test]
fn killed_sensor_program_stops_the_hand_until_it_is_resumed() {
    let mut rig = Setup::new("link-killed").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    rig.senses[1].signal("KILL");
    hand.wait_for("stopped: the forces of finger 1");
    let refused = rig.setup.order("resume", &[]);
    assert_eq!(refused.status, Some(1), "{refused:?}");
    assert!(refused.stdout.contains("remains stopped"), "{refused:?}");
    rig.start_sense(1);
    rig.resume(&hand);
    hand.wait_for("resuming");
    check(&mut rig, hand, "the forces of finger 1");
}

#[test]
fn frozen_sensor_program_stops_the_hand_until_data_are_fresh() {
    let setup = Setup::new("link-frozen").with(&[NO_HURRY, GOES_ON]);
    let mut rig = setup.start();
    let mut hand = rig.moving_hand(&[]);
    rig.senses[0].signal("STOP");
    hand.wait_for("stopped: the forces of finger 0");
    rig.senses[0].signal("CONT");
    hand.wait_for("resuming");
    check(&mut rig, hand, "the forces of finger 0");
}

#[test]
fn frozen_world_stops_the_hand() {
    let mut rig = Setup::new("link-still").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    rig.world.signal("STOP");
    hand.wait_for("stopped: the joint angles");
    rig.world.signal("CONT");
    check(&mut rig, hand, "the joint angles");
}

#[test]
fn impaired_network_stops_the_hand_and_causes_no_motion_on_stale_data() {
    let mut rig = Setup::new("link-bad").with(&[NO_HURRY]).start();
    // The jitter is a large part of the 3.5 s after which data are stale at this speed.
    let mut hand = rig.moving_hand(&["--rehearse=loss=0.2,jitter=0.9,duplicate=0.1"]);
    hand.wait_for("stopped:");
    check(&mut rig, hand, "s old (limit");
}

#[test]
fn watchdog_stops_the_rig_if_the_hand_is_killed() {
    let mut rig = Setup::new("link-watchdog").with(&[NO_HURRY]).start();
    rig.moving_hand(&[]).signal("KILL");
    // Longer than the 0.045 s after which the watchdog stops the drives.
    std::thread::sleep(rig.setup.takes(0.06) + Duration::from_millis(500));
    let said = worlds_end(&mut rig);
    assert!(said.contains("1 stops by the watchdog"), "{said}");
}

#[test]
fn programs_of_different_experiments_are_refused_and_named() {
    let rig = Setup::new("link-other").start();
    let mut hand = rig.setup.hand(&["--seed=9"]);
    hand.wait_for("refused: world runs experiment");
    assert!(hand.said().contains(", this program "), "{}", hand.said());
    hand.signal("INT");
    let (status, said) = hand.wait();
    assert_eq!(status, Some(1), "{said}");
}

#[test]
fn rig_with_another_speed_is_refused() {
    let rig = Setup::new("link-speed").start();
    let mut setup = rig.setup.clone();
    setup.speed = "max";
    let mut hand = setup.hand(&[]);
    let words = format!("refused: world runs at {SLOW} times real time, this hand at the pace");
    hand.wait_for(&words);
}
