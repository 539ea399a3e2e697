//! Any program of a rig may end and restart at any time: the hand stops, and moves again after a resume.

use super::faults::{NO_HURRY, check};
use crate::how_many::how_many;
use crate::ports::unused_endpoint;
use crate::program::{folder, run};
use crate::rig::{Rig, Running, Setup};
use feeler::sensor::image::Picture;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::SimRigServer;
use feeler_link::programs::{Rig as _, SensorOutput};
use image::GrayImage;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::io::Write;
use std::time::Duration;
use std::{fs, thread};

/// Number of restarts of each program, set by `FEELER_RESTARTS` (default 3).
fn times() -> usize {
    how_many("FEELER_RESTARTS", 3)
}

/// Waits for the hand's `nth` stop with `words`, and resumes it.
fn resume_after(rig: &Rig, hand: &mut Running, words: &str, nth: usize) {
    hand.wait_for_times(words, nth);
    rig.resume(hand);
    hand.wait_for_times("resuming", nth);
}

#[test]
fn world_can_be_restarted_repeatedly() {
    let mut rig = Setup::new("link-worlds").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    for nth in 1..=times() {
        rig.world.signal(if nth % 2 == 0 { "INT" } else { "KILL" });
        hand.wait_for_times("stopped: the joint angles", nth);
        rig.start_world();
        resume_after(&rig, &mut hand, "stopped: the joint angles", nth);
    }
    let stamps: Vec<f64> = {
        check(&mut rig, hand, "the joint angles");
        let recording = rig.setup.recording();
        recording.task.iter().map(|task| task.stamp).collect()
    };
    // The run's time never decreases, even across restarts of the world.
    assert!(stamps.windows(2).all(|pair| pair[1] >= pair[0]));
}

#[test]
fn sensor_program_can_be_restarted_repeatedly() {
    let mut rig = Setup::new("link-senses").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    for nth in 1..=times() {
        rig.senses[0].signal(if nth % 2 == 0 { "TERM" } else { "KILL" });
        hand.wait_for_times("stopped: the forces of finger 0", nth);
        rig.start_sense(0);
        resume_after(&rig, &mut hand, "stopped: the forces of finger 0", nth);
    }
    check(&mut rig, hand, "the forces of finger 0");
}

#[test]
fn hand_can_be_restarted_while_its_rig_runs() {
    let mut rig = Setup::new("link-hands").with(&[NO_HURRY]).start();
    for nth in 1..=times() {
        let mut hand = rig.moving_hand(&[]);
        hand.signal("KILL");
        hand.wait();
        let run = rig.setup.folder.join("run");
        fs::rename(&run, run.with_extension(nth.to_string())).expect("the run's folder");
    }
    let mut hand = rig.moving_hand(&[]);
    let told = rig.setup.order("stop", &[]).done();
    assert!(told.contains("the hand is stopped"), "{told}");
    hand.wait_for("stopped: stop requested");
    check(&mut rig, hand, "stop requested");
}

/// An image of an unloaded fingertip of the reference rig.
fn unloaded(finger: usize) -> Picture {
    let experiment = Experiment::load("cap-closing", &["sensing=image".into()]).expect("a rig");
    let mut played = SimRigServer::new(&experiment).expect("a rig");
    match played.expose(finger) {
        Ok(Some(SensorOutput::Picture(frame))) => frame.picture.clone(),
        other => panic!("expected an image, got {other:?}"),
    }
}

/// Frame rate of the test's camera (Hz): low enough for a busy computer, high enough that a slow rig's data stay fresh.
const CAMERA_RATE: u64 = 5;

/// A camera simulated by the test: writes images of an unloaded fingertip to a sensor program until that ends.
pub fn film(rig: &Rig, finger: usize) -> Running {
    let (picture, number) = (unloaded(finger), finger.to_string());
    let size = format!("--raw={}x{}", picture.width, picture.height);
    let rate = format!("--rate={CAMERA_RATE}");
    let raw = ["sense", "-", &size, &rate, "--publish", "--finger", &number];
    let arguments = [&raw[..], &["--experiment", rig.setup.experiment]].concat();
    let mut sense = rig
        .setup
        .join_with_input(&format!("sense{finger}"), &arguments);
    let mut input = sense.input();
    thread::spawn(move || {
        let mut random = Pcg64::seed_from_u64(finger as u64);
        loop {
            // Consecutive images of a real camera are never identical.
            let noisy = picture
                .pixels
                .iter()
                .map(|gray| gray ^ u8::from(random.random::<bool>()));
            if input.write_all(&noisy.collect::<Vec<u8>>()).is_err() {
                return;
            }
            thread::sleep(Duration::from_millis(1000 / CAMERA_RATE));
        }
    });
    sense
}

#[test]
fn sensor_programs_with_separate_clocks_can_be_restarted() {
    let mut setup = Setup::new("link-cameras").with(&[NO_HURRY]);
    setup.settings[0] = "--sensing=image".into();
    let mut rig = setup.start();
    rig.senses = vec![film(&rig, 0), film(&rig, 1)];
    let mut hand = rig.moving_hand(&[]);
    for nth in 1..=times() {
        rig.senses[0].signal("KILL");
        hand.wait_for_times("stopped: the forces of finger 0", nth);
        rig.senses[0] = film(&rig, 0);
        resume_after(&rig, &mut hand, "stopped: the forces of finger 0", nth);
    }
    check(&mut rig, hand, "the forces of finger 0");
}

#[test]
fn image_of_another_size_is_skipped_and_reported() {
    let folder = folder("link-other-size");
    let Picture {
        width,
        height,
        pixels,
    } = unloaded(0);
    let picture = GrayImage::from_raw(width as u32, height as u32, pixels).expect("its pixels");
    let pictures = [picture.clone(), GrayImage::new(320, 240), picture];
    let names: Vec<_> = (0..pictures.len()).map(|n| format!("{n}.png")).collect();
    for (picture, name) in pictures.iter().zip(&names) {
        picture.save(folder.join(name)).expect("a file");
    }
    let mut arguments = vec!["sense", "--publish", "--finger=0", "--sensing=image"];
    // No program listens at this endpoint, so published messages are lost.
    let nowhere = format!("--connect={}", unused_endpoint());
    arguments.push(&nowhere);
    arguments.extend(names.iter().map(String::as_str));
    let ended = run(&folder, &arguments);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let said = format!("{}{}", ended.stdout, ended.stderr);
    assert!(said.contains("1.png") && said.contains("320x240"), "{said}");
}
