//! What the page's buttons do.

use super::viewed::{Viewed, next_row, wait_for};
use crate::program::folder;
use feeler_record::{Phase, Recording};
use tungstenite::Message;

#[test]
fn the_buttons_stop_the_hand_and_let_it_go_on() {
    let folder = folder("view-orders");
    let viewed = Viewed::run(&folder, &["--speed=0.5"]);
    let mut socket = viewed.socket();
    wait_for(&mut socket, |state| state["stopped"] == false);
    let garbage = [
        "",
        "stop",
        "{}",
        r#"{"order":"go"}"#,
        r#"{"order":"stop","by":"me"}"#,
    ];
    for garbage in garbage {
        socket.send(Message::text(garbage)).expect("a message");
    }
    socket
        .send(Message::binary(vec![0; 1000]))
        .expect("a message");
    socket
        .send(Message::text(r#"{"order":"resume"}"#))
        .expect("an order");
    // What makes no sense stopped nothing: this comes after it.
    let resumed = wait_for(&mut socket, |state| state["answer"].is_string());
    assert_eq!(
        (&resumed["stopped"], &resumed["answer"]),
        (&false.into(), &"Resume: the hand has resumed.".into())
    );
    socket
        .send(Message::text(r#"{"order":"stop"}"#))
        .expect("an order");
    let stopped = wait_for(&mut socket, |state| state["stopped"] == true);
    let words = stopped["state"].as_str().expect("words");
    assert!(words.contains("the live page"), "{words}");
    assert_eq!(stopped["answer"], "Stop: the hand is stopped.");
    socket
        .send(Message::text(r#"{"order":"resume"}"#))
        .expect("an order");
    wait_for(&mut socket, |state| state["stopped"] == false);
    // A later step than the one after which it was let go on.
    next_row(&mut socket);
    viewed.interrupt();
    let recording = Recording::read(folder.join("run/recording.mcap")).expect("a recording");
    let mut phases: Vec<_> = recording.task.iter().map(|task| task.phase).collect();
    phases.dedup();
    assert!(
        phases.starts_with(&[Phase::Search, Phase::Stopped, Phase::Search]),
        "{phases:?}"
    );
}

#[test]
fn a_message_that_is_too_long_ends_its_connection_alone() {
    let viewed = Viewed::run(&folder("view-too-long"), &["--speed=0.1"]);
    let mut socket = viewed.socket();
    // The server may close while this is on its way.
    let _ = socket.send(Message::text("x".repeat(100_000)));
    while socket.read().is_ok() {}
    wait_for(&mut viewed.socket(), |state| state["stopped"] == false);
    viewed.interrupt();
}
