//! A distributed rig in the browser.

use super::viewed::{Viewed, next_row, wait_for};
use crate::rig::{QUARTER, Setup};
use feeler_record::ObjectPose;
use feeler_record::wire::Vector3;
use glam::DQuat;
use serde_json::Value;
use tungstenite::Message;

/// A time limit that no test reaches, and automatic resumption after stale data.
const SETTINGS: [&str; 2] = ["time_limit=600", "control.resume=fresh"];

fn says(state: &Value, words: &str) -> bool {
    state["state"]
        .as_str()
        .is_some_and(|said| said.contains(words))
}

/// The page of the rig that `setup` starts.
fn viewed(setup: &Setup) -> Viewed {
    let mut arguments = vec!["view", setup.experiment, "--connect", &setup.endpoint];
    arguments.extend(setup.settings.iter().map(String::as_str));
    Viewed::start(&setup.folder, &arguments)
}

#[test]
fn page_shows_the_recorded_pose_of_a_carried_object() {
    /// Number of values of a pose, at the end of a row.
    const POSE: usize = 7;
    let setup = Setup::new("view-rig-lift").of("lift");
    let rig = setup.with(&SETTINGS).at(QUARTER).start();
    let viewed = viewed(&rig.setup);
    let mut socket = viewed.socket();
    let mut hand = rig.moving_hand(&[]);
    let known = |pose: &[f32]| pose.iter().all(|number| number.is_finite());
    let shown = loop {
        let (_, row) = next_row(&mut socket);
        let pose = row[row.len() - POSE..].to_vec();
        if known(&pose) {
            break pose;
        }
    };
    hand.signal("INT");
    hand.wait();
    let recording = rig.setup.recording();
    let is_shown = |object: &ObjectPose| {
        let Vector3 { x, y, z } = object.position;
        let orientation = DQuat::from(object.orientation).to_array();
        let numbers = [x, y, z].into_iter().chain(orientation);
        numbers
            .map(|number| number as f32)
            .eq(shown.iter().copied())
    };
    assert!(recording.object.iter().any(is_shown), "{shown:?}");
    viewed.interrupt();
}

#[test]
fn page_shows_and_controls_a_rig() {
    let rig = Setup::new("view-rig").with(&SETTINGS).at(QUARTER).start();
    let viewed = viewed(&rig.setup);
    let mut socket = viewed.socket();
    wait_for(&mut socket, |state| {
        says(state, "No messages received from a hand")
    });
    let _hand = rig.moving_hand(&[]);
    wait_for(&mut socket, |state| says(state, "of stroke 1 of 4"));
    let (first, second) = (next_row(&mut socket), next_row(&mut socket));
    assert!(first.0 < second.0);
    assert_eq!(first.1.len(), second.1.len());
    socket
        .send(Message::text(r#"{"order":"stop"}"#))
        .expect("an order");
    let stopped = wait_for(&mut socket, |state| {
        state["stopped"] == true && says(state, "feeler view")
    });
    assert!(says(&stopped, "the hand is stopped"), "{stopped}");
    socket
        .send(Message::text(r#"{"order":"resume"}"#))
        .expect("an order");
    wait_for(&mut socket, |state| state["stopped"] == false);
    let ended = viewed.interrupt();
    assert_eq!(ended.status, Some(0), "{ended:?}");
}
