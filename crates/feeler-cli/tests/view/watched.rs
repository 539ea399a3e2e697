//! A rig of several programs in the browser.

use crate::rig::{QUARTER, Setup};
use crate::viewed::{Viewed, next_row, wait_for};
use serde_json::Value;
use tungstenite::Message;

/// Longer than any test takes; and data that become fresh again stop nobody for good.
const SETTINGS: [&str; 2] = ["time_limit=600", "control.resume=fresh"];

fn says(state: &Value, words: &str) -> bool {
    state["state"]
        .as_str()
        .is_some_and(|said| said.contains(words))
}

#[test]
fn a_rig_is_seen_and_ordered_from_its_page() {
    let rig = Setup::new("view-rig").with(&SETTINGS).at(QUARTER).start();
    let endpoint = &rig.setup.endpoint;
    let mut arguments = vec!["view", "cap-closing", "--connect", endpoint];
    arguments.extend(rig.setup.settings.iter().map(String::as_str));
    let viewed = Viewed::start(&rig.setup.folder, &arguments);
    let mut socket = viewed.socket();
    wait_for(&mut socket, |state| says(state, "No hand was heard"));
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
