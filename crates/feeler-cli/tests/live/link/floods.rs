//! Stops reach the hand even while its endpoint is flooded.

use super::faults::{GOES_ON, NO_HURRY, check};
use crate::rig::{Rig, Setup, connect};
use feeler_link::inboxes::read;
use feeler_link::messages::message::{CommandMessage, PROTOCOL, ResumeMessage};
use feeler_link::stop_server::call_stop;
use feeler_link::transport::{Network, Outlet, Topic, draw_instance, send};
use std::io::Write;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// Address of the hand's endpoint, without the protocol.
fn address(setup: &Setup) -> &str {
    setup.endpoint.split_once('/').expect("an endpoint").1
}

#[test]
fn stop_arrives_during_failed_handshakes() {
    let setup = Setup::new("link-handshakes").with(&[NO_HURRY]);
    let mut rig = setup.with_certificates("127.0.0.1", "127.0.0.1").start();
    let mut hand = rig.moving_hand(&[]);
    let over = AtomicBool::new(false);
    let address = address(&rig.setup).to_string();
    thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                // After each failed handshake, Zenoh accepts no connection for 0.1 s.
                if let Ok(mut stream) = TcpStream::connect(&address) {
                    let _ = stream.write_all(b"not a handshake\r\n\r\n");
                }
                thread::sleep(Duration::from_millis(10));
            }
        });
        thread::sleep(Duration::from_secs(2));
        let told = rig.setup.order("stop", &rig.setup.hand_link);
        over.store(true, Ordering::Relaxed);
        let told = told.done();
        assert!(
            told.contains("is stopped: stop requested by the test"),
            "{told}"
        );
    });
    hand.wait_for("stopped: stop requested by the test");
    check(&mut rig, hand, "stop requested by the test");
}

#[test]
fn stop_arrives_despite_silent_connections() {
    let mut rig = Setup::new("link-silent").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    let connect = || TcpStream::connect(address(&rig.setup)).expect("a connection");
    let silent: Vec<TcpStream> = (0..120).map(|_| connect()).collect();
    let told = rig.setup.order("stop", &[]).done();
    assert!(
        told.contains("is stopped: stop requested by the test"),
        "{told}"
    );
    drop(silent);
    hand.wait_for("stopped: stop requested by the test");
    check(&mut rig, hand, "stop requested by the test");
}

/// Sends garbage on all topics as fast as possible, until `over`.
fn flood_with_messages(endpoint: &str, over: &AtomicBool) {
    let peer = connect(endpoint);
    let noise: Vec<u8> = (0..200u32).map(|k| (k * k * 31 + 7) as u8).collect();
    while !over.load(Ordering::Relaxed) {
        for topic in Topic::all(0) {
            let _ = peer.send(topic, noise.clone());
        }
    }
}

/// Opens 120 silent connections every second and closes the previous ones, until `over`.
fn flood_with_connections(address: &str, over: &AtomicBool) {
    while !over.load(Ordering::Relaxed) {
        let silent: Vec<_> = (0..120).map(|_| TcpStream::connect(address)).collect();
        thread::sleep(Duration::from_secs(1));
        drop(silent);
    }
}

/// Requests a stop and returns the times (s) until it is answered and until the hand commands zero velocity.
fn stop_once(rig: &Rig, still: &Mutex<Option<Instant>>) -> (f64, f64) {
    let endpoints = [rig.setup.endpoint.clone()];
    *still.lock().expect("the notes") = None;
    let start = Instant::now();
    let answer = call_stop(
        &endpoints,
        None,
        "cap-closing",
        (draw_instance(), "the bench"),
    );
    let answered = start.elapsed();
    let number = answer.expect("an answer").order;
    let stood_still = loop {
        if let Some(at) = *still.lock().expect("the notes") {
            break at.duration_since(start);
        }
        thread::sleep(Duration::from_millis(1));
    };
    let resume = ResumeMessage {
        protocol: PROTOCOL,
        from: "the bench".into(),
        number,
    };
    let peer = connect(&endpoints[0]);
    // Repeat until the hand moves: under a flood, connecting takes time and messages are dropped.
    while still.lock().expect("the notes").is_some() {
        send(&*peer, Topic::Resume, &resume).expect("a link");
        thread::sleep(Duration::from_millis(100));
    }
    (answered.as_secs_f64(), stood_still.as_secs_f64())
}

/// Measures the latency of a stop. The results are in docs/benchmarks.md.
///
/// `cargo test --release ... --test live how_long -- --ignored --nocapture`
#[test]
#[ignore = "a measurement"]
fn how_long_a_stop_takes() {
    type Flood = fn(&Rig, &AtomicBool);
    let floods: [(&str, Flood); 3] = [
        ("no flood", |_, _| {}),
        ("messages", |rig, over| {
            flood_with_messages(&rig.setup.endpoint, over)
        }),
        ("silent connections", |rig, over| {
            flood_with_connections(address(&rig.setup), over);
        }),
    ];
    for (name, flood) in floods {
        let settings = [NO_HURRY, GOES_ON, "task.screw.strokes=100000"];
        let setup = Setup::new("link-bench-stop").with(&settings);
        let rig = setup.at("1").start();
        let mut hand = rig.moving_hand(&[]);
        let still = Arc::new(Mutex::new(None));
        let note = still.clone();
        let watcher = connect(&rig.setup.endpoint);
        let noted = move |_: Topic, bytes: &[u8]| {
            let Ok(command) = read::<CommandMessage>(bytes) else {
                return;
            };
            let moves = command
                .joint_velocity
                .iter()
                .any(|v| *v != Default::default());
            let mut still = note.lock().expect("the notes");
            *still = still.filter(|_| !moves).or((!moves).then(Instant::now));
        };
        watcher
            .listen(Topic::Command, Arc::new(noted))
            .expect("commands");
        let over = AtomicBool::new(false);
        let mut times = thread::scope(|scope| {
            scope.spawn(|| flood(&rig, &over));
            thread::sleep(Duration::from_secs(1));
            let times: Vec<_> = (0..20).map(|_| stop_once(&rig, &still)).collect();
            over.store(true, Ordering::Relaxed);
            times
        });
        times.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (median, most) = (times[times.len() / 2], times[times.len() - 1]);
        let slowest = times.iter().map(|time| time.0).fold(0.0, f64::max);
        eprintln!(
            "{name}: answered within {slowest:.3} s; zero velocity commanded after {:.4} s (median), {:.4} s (maximum)",
            median.1, most.1
        );
        hand.signal("INT");
        hand.wait();
    }
}
