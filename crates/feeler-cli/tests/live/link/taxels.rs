//! A finger whose fingertip is a taxel array works like any other.

use super::faults::{NO_HURRY, check};
use crate::rig::{Rig, Running, Setup};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
use feeler_record::{Phase, Recording};
use glam::DVec3;
use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Duration;
use std::{fs, thread};

/// Rows per second: low enough for a busy computer, high enough that a slow rig's data stay fresh.
const RATE: u64 = 5;
/// The loaded taxel.
const FELT: usize = 5;
/// Force on the loaded taxel (N).
const FORCE: DVec3 = DVec3::new(0.01, 0.02, 0.03);

/// A taxel layout with the element positions of the reference fingertip.
fn layout() -> String {
    let mut text = "version = 1\nname = 'dome'\nunit = 'N'\n\
                    columns = { x = 't{n}_x', y = 't{n}_y', z = 't{n}_z' }\n"
        .to_string();
    let layout = ElementLayout::new(&LayoutConfig::default());
    for (index, element) in layout.elements.iter().enumerate() {
        let (tip, normal) = (layout.tip(index).to_array(), element.normal().to_array());
        writeln!(text, "[[taxel]]\nplace = {tip:?}\nnormal = {normal:?}").expect("a string");
    }
    text
}

/// A taxel driver simulated by the test: writes rows to a sensor program until that ends.
fn drive(rig: &Rig) -> Running {
    fs::write(rig.setup.folder.join("dome.toml"), layout()).expect("a layout");
    let rate = format!("--rate={RATE}");
    let arguments = [
        "sense",
        "-",
        "--taxels=dome.toml",
        &rate,
        "--publish",
        "--finger=0",
        "--output=forces.jsonl",
    ];
    let mut sense = rig.setup.join_with_input("sense0", &arguments);
    let mut input = sense.input();
    thread::spawn(move || {
        let count = LayoutConfig::default().element_count();
        let header = (0..count).map(|n| format!("t{n}_x,t{n}_y,t{n}_z"));
        let mut row = header.collect::<Vec<_>>().join(",");
        // Consecutive rows of a real array are never identical.
        for number in 0_u32.. {
            if writeln!(input, "{row}").is_err() {
                return;
            }
            thread::sleep(Duration::from_millis(1000 / RATE));
            let noise = 1e-9 * f64::from(number);
            let force = |n| if n == FELT { FORCE } else { DVec3::ZERO };
            let cells = (0..count).flat_map(|n| (force(n) + noise).to_array());
            let cells: Vec<_> = cells.map(|cell| cell.to_string()).collect();
            row = cells.join(",");
        }
    });
    sense
}

#[test]
fn hand_moves_with_the_forces_of_a_taxel_array() {
    let mut rig = Setup::new("link-taxels").with(&[NO_HURRY]).start();
    rig.senses[0].signal("KILL");
    rig.senses[0] = drive(&rig);
    let mut hand = rig.moving_hand(&[]);
    let told = rig.setup.order("stop", &[]).done();
    assert!(told.contains("the hand is stopped"), "{told}");
    hand.wait_for("stopped: stop requested");
    check(&mut rig, hand, "stop requested");
    let recording = rig.setup.recording();
    let frames = &recording.fingers[0].tactile;
    let felt = frames.iter().map(|frame| DVec3::from(frame.forces[FELT]));
    let close = felt.filter(|felt| (*felt - FORCE).length() < 1e-6).count();
    assert!(close > 0, "of {} frames, none has the force", frames.len());
    every_frame_is_recorded(&recording);
    // The sensor program also writes all rows to a file, which is still partial if the program was killed.
    let files = ["forces.jsonl", "forces.jsonl.part"];
    let texts = files.map(|name| fs::read_to_string(rig.setup.folder.join(name)));
    let rows: usize = texts
        .iter()
        .flatten()
        .map(|text| text.lines().count())
        .sum();
    assert!(rows >= 41, "{rows} rows");
    let moved = &recording.fingers[0].joints;
    let (first, last) = (
        moved.first().expect("joints"),
        moved.last().expect("joints"),
    );
    assert_ne!(first.position, last.position, "the finger did not move");
}

/// The array is faster than the control loop. Until the stop, each of its frames is recorded once, with its time.
fn every_frame_is_recorded(recording: &Recording) {
    let finger = &recording.fingers[0];
    let stop = recording
        .task
        .iter()
        .find(|task| task.phase == Phase::Stopped);
    let stop = stop.expect("a stop").stamp;
    let at_steps = finger.tactile.iter().map(|f| (f.sequence, f.stamp));
    let mut frames: Vec<_> = at_steps.filter(|(_, stamp)| *stamp < stop).collect();
    // A step without a new frame repeats the previous one.
    frames.dedup_by_key(|(sequence, _)| *sequence);
    let steps = frames.len();
    let between = finger.samples.iter().map(|f| (f.sequence, f.stamp));
    frames.extend(between.filter(|(_, stamp)| *stamp < stop));
    assert!(
        frames.len() > 2 * steps,
        "{} frames in {steps} steps",
        frames.len()
    );
    frames.sort_by_key(|(sequence, _)| *sequence);
    // The time of the run begins to advance at the first steps.
    let begin = finger.tactile.get(2).expect("steps").sequence;
    frames.retain(|(sequence, _)| *sequence >= begin);
    for pair in frames.windows(2) {
        let [(before, from), (number, to)] = pair else {
            unreachable!()
        };
        assert_eq!(*number, before + 1, "{frames:?}");
        // A busy computer may delay messages, so that their age is less certain.
        assert!(to - from > -0.005, "{frames:?}");
    }
}
