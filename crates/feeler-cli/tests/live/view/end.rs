//! Messages to pages when a run ends.

use super::viewed::{Viewed, next_row, wait_for};
use crate::program::{Ended, feeler, folder};
use std::net::TcpStream;
use std::path::Path;
use std::process::Command;
use tungstenite::{Message, WebSocket};

#[test]
fn page_receives_the_end_of_the_run() {
    let folder = folder("view-end");
    let viewed = Viewed::run(&folder, &["--speed=0.05", "--set=time_limit=0.5"]);
    let mut socket = viewed.socket();
    let state = wait_for(&mut socket, |state| state["over"] == true);
    let words = state["state"].as_str().expect("words");
    assert!(words.starts_with("The run was given up: "), "{words}");
    assert!(words.contains("time limit"), "{words}");
    // The server closes the connection properly.
    while socket.read().is_ok() {}
    let ended = viewed.wait();
    assert!(ended.stdout.contains("report.html"), "{ended:?}");
}

#[test]
fn page_receives_an_interrupt() {
    let viewed = Viewed::run(&folder("view-interrupted"), &["--speed=0.5"]);
    let mut socket = viewed.socket();
    next_row(&mut socket);
    assert_eq!(viewed.interrupt().status, Some(1));
    let said = last_state(&mut socket);
    assert!(said.contains("The run was interrupted: "), "{said}");
}

/// A page lags after two unanswered pings and then gets no more rows; after six, it is considered gone. The run ends in
/// between.
#[test]
fn lagging_page_receives_the_end() {
    let folder = folder("view-behind");
    let mut viewed = Viewed::run(&folder, &["--speed=0.1", "--set=time_limit=0.3"]);
    let mut socket = viewed.socket();
    // The run has ended; pages are served for a moment longer.
    viewed.says("simulated in");
    let said = last_state(&mut socket);
    assert!(said.contains(r#""over":true"#), "{said}");
    assert!(said.contains("time limit"), "{said}");
    assert!(viewed.wait().stdout.contains("report.html"));
}

#[test]
fn client_that_reads_nothing_does_not_delay_the_end() {
    let folder = folder("view-reads-nothing");
    let viewed = Viewed::run(&folder, &["--speed=0.1", "--set=time_limit=0.1"]);
    let mut sockets: Vec<_> = (0..8).map(|_| viewed.socket()).collect();
    // All sockets are still connected.
    assert!(viewed.wait().stdout.contains("report.html"));
    let first = sockets.iter_mut().map(|socket| socket.read());
    assert!(first.into_iter().all(|message| message.is_ok()));
}

#[test]
fn page_receives_a_failure() {
    let folder = folder("view-fails");
    let viewed = Viewed::spawn(with_files_up_to(300, &folder));
    let mut socket = viewed.socket();
    next_row(&mut socket);
    let said = last_state(&mut socket);
    assert!(said.contains("The run failed: "), "{said}");
    assert!(said.contains("recording.mcap"), "{said}");
    let Ended { status, stderr, .. } = viewed.wait();
    assert_eq!(status, Some(2), "{stderr}");
    assert!(stderr.contains("recording.mcap"), "{stderr}");
}

/// A run with a file size limit of `blocks` blocks (512 B, or 1 KiB in some shells). A write beyond the limit fails
/// instead of ending the program.
fn with_files_up_to(blocks: usize, folder: &Path) -> Command {
    let arguments = ["run", "cap-closing", "--sensing=direct", "--out=run"];
    let live = [
        "--view",
        "--no-open",
        "--speed=0.2",
        "--flush-interval=0.05",
    ];
    let program = feeler(folder, &[&arguments[..], &live].concat());
    let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &limited, "sh"]);
    command.arg(program.get_program()).args(program.get_args());
    command.current_dir(folder);
    command
}

/// The last text message of a socket.
fn last_state(socket: &mut WebSocket<TcpStream>) -> String {
    let mut said = String::new();
    while let Ok(message) = socket.read() {
        if let Message::Text(text) = message {
            said = text.to_string();
        }
    }
    said
}
