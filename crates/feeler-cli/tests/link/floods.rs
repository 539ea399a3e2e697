//! A hand that nobody can connect to is stopped all the same.

use super::faults::{NO_HURRY, check};
use super::rig::Setup;
use std::io::Write;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Where the hand of `setup` listens, without the protocol.
fn address(setup: &Setup) -> &str {
    setup.endpoint.split_once('/').expect("an endpoint").1
}

#[test]
fn failed_handshakes_keep_no_stop_out() {
    let setup = Setup::new("link-handshakes").with(&[NO_HURRY]);
    let mut rig = setup.with_certificates("127.0.0.1", "127.0.0.1").start();
    let mut hand = rig.moving_hand(&[]);
    let over = AtomicBool::new(false);
    let address = address(&rig.setup).to_string();
    thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                // After each that fails, Zenoh takes nobody for a tenth of a second.
                if let Ok(mut stream) = TcpStream::connect(&address) {
                    let _ = stream.write_all(b"this is no handshake\r\n\r\n");
                }
                thread::sleep(Duration::from_millis(10));
            }
        });
        thread::sleep(Duration::from_secs(2));
        let told = rig.setup.order("stop", &rig.setup.hand_link);
        over.store(true, Ordering::Relaxed);
        let told = told.done();
        assert!(
            told.contains("stands still: told to stop by the test"),
            "{told}"
        );
    });
    hand.wait_for("stopped: told to stop by the test");
    check(&mut rig, hand, "told to stop by the test");
}

#[test]
fn silent_connections_keep_no_stop_out() {
    let mut rig = Setup::new("link-silent").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    let connect = || TcpStream::connect(address(&rig.setup)).expect("a connection");
    let silent: Vec<TcpStream> = (0..120).map(|_| connect()).collect();
    let told = rig.setup.order("stop", &[]).done();
    assert!(
        told.contains("stands still: told to stop by the test"),
        "{told}"
    );
    drop(silent);
    hand.wait_for("stopped: told to stop by the test");
    check(&mut rig, hand, "told to stop by the test");
}
