//! The buttons of the live page.

use super::viewed::{Viewed, next_row, wait_for};
use crate::program::folder;
use feeler_record::{Phase, Recording};
use tungstenite::Message;

#[test]
fn buttons_stop_and_resume_the_hand() {
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
    // The invalid messages have stopped nothing: this state follows them.
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
    // Wait for a step after the resume.
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
fn oversized_message_closes_only_its_connection() {
    let viewed = Viewed::run(&folder("view-too-long"), &["--speed=0.1"]);
    let mut socket = viewed.socket();
    // The server may close the connection during this send.
    let _ = socket.send(Message::text("x".repeat(100_000)));
    while socket.read().is_ok() {}
    wait_for(&mut viewed.socket(), |state| state["stopped"] == false);
    viewed.interrupt();
}
