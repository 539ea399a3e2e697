//! Invalid requests are refused with an explanation.

use crate::program::{folder, run};
use std::net::TcpListener;

#[test]
fn occupied_port_is_reported_before_the_run_starts() {
    let folder = folder("view-port");
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("its address").port().to_string();
    let arguments = [
        "run",
        "cap-closing",
        "--view",
        "--no-open",
        "--out=run",
        "--port",
    ];
    let refused = run(&folder, &[&arguments[..], &[&port]].concat());
    refused.refused(&[&port, "use a free port"]);
    assert!(!folder.join("run").exists());
}

#[test]
fn path_that_is_neither_recording_nor_experiment_is_refused() {
    let folder = folder("view-nothing");
    run(&folder, &["view", ".", "--no-open"]).refused(&["recording.mcap"]);
    run(&folder, &["view", "none.mcap", "--no-open"]).refused(&["none.mcap"]);
    run(&folder, &["view", "no-such-rig", "--no-open"]).refused(&["no-such-rig"]);
    let arguments = ["run", "cap-closing", "--no-open", "--out=run"];
    run(&folder, &arguments).refused(&["--no-open requires --view"]);
}
