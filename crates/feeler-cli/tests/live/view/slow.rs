//! A browser that stops reading.

use super::viewed::{Viewed, next_row};
use crate::program::{folder, summary};
use std::thread;
use std::time::Duration;
use tungstenite::Message;

/// Longer than the server waits for any client.
const ASLEEP: Duration = Duration::from_secs(10);

#[test]
fn viewers_do_not_change_the_run() {
    let folder = folder("view-digest");
    let viewed = Viewed::beside_alone(&folder, "--speed=0.1");
    let (mut reads, _sleeps) = (viewed.socket(), viewed.socket());
    while reads.read().is_ok() {}
    viewed.wait();
    let digest = |name: &str| summary(&folder.join(name))["digest"].clone();
    assert!(digest("run").is_string());
    assert_eq!(digest("run"), digest("alone"));
}

#[test]
fn client_that_stops_reading_misses_rows_and_is_disconnected() {
    let viewed = Viewed::run(&folder("view-asleep"), &["--speed=0.2"]);
    let mut socket = viewed.socket();
    next_row(&mut socket);
    thread::sleep(ASLEEP);
    let mut rows = 0;
    while let Ok(message) = socket.read() {
        rows += usize::from(matches!(message, Message::Binary(_)));
    }
    // The rows of two seconds and some in transit, not all three hundred.
    assert!(rows <= 100, "{rows}");
    // The run continues, and other clients can connect.
    next_row(&mut viewed.socket());
    viewed.interrupt();
}
