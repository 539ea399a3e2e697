//! Samples and errors of a network force sensor, tested with its emulator.

use feeler_sources::{ForceError, ForceSample, NetFt, NetFtAddress, NetFtEmulator};
use std::io::{Read, Write};
use std::net::{TcpListener, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{sleep, spawn};
use std::time::Duration;

fn connect(address: &str) -> NetFt {
    let address: NetFtAddress = address.parse().expect("an address");
    NetFt::connect(&address).expect("a socket")
}

/// Waits for the next sample or error.
fn next(sensor: &NetFt) -> Result<ForceSample, ForceError> {
    loop {
        if let Some(sample) = sensor.next_sample()? {
            return Ok(sample);
        }
        sleep(Duration::from_millis(1));
    }
}

#[test]
fn samples_are_in_si_units_and_in_order() {
    let mut count = 0.0;
    let emulator = NetFtEmulator::start(1000.0, move || {
        count += 1.0;
        Some([0.5, -0.25, -1e-3 * count, 0.01, 0.0, -0.02])
    });
    let emulator = emulator.unwrap();
    let sensor = connect(&emulator.address());
    let mut before = 0.0;
    let mut at = None;
    for _ in 0..100 {
        let sample = next(&sensor).unwrap();
        let [x, y, z, torques @ ..] = sample.wrench;
        assert_eq!(([x, y], torques), ([0.5, -0.25], [0.01, 0.0, -0.02]));
        assert!(
            z < before && at.is_none_or(|at| sample.at >= at),
            "{sample:?}"
        );
        (before, at) = (z, Some(sample.at));
    }
}

#[test]
fn the_scale_of_counts_is_read_from_the_web_page() {
    let emulator = NetFtEmulator::start(500.0, || Some([2.0; 6])).unwrap();
    let sensor = connect(&emulator.bare_address());
    assert_eq!(next(&sensor).unwrap().wrench, [2.0; 6]);
}

/// Connects to a sensor whose web page responds with `answer`, and returns the error.
fn refused_by(answer: &'static [u8]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let page = spawn(move || {
        let (mut client, _) = listener.accept().unwrap();
        let mut request = [0; 256];
        let length = client.read(&mut request).unwrap();
        assert!(request[..length].starts_with(b"GET /netftapi2.xml HTTP/1.0\r\n"));
        // The client may have closed the connection already.
        let _ = client.write_all(answer);
    });
    let address = format!("netft://127.0.0.1?web={port}");
    let error = NetFt::connect(&address.parse().unwrap()).unwrap_err();
    page.join().unwrap();
    error.to_string()
}

#[test]
fn invalid_web_pages_are_rejected() {
    static LONG: [u8; 300_000] = [b'x'; 300_000];
    for (answer, words) in [
        (&b""[..], "expected status 200"),
        (b"\xff\xfe\0", "expected status 200"),
        (b"HTTP/1.0 404 Not Found\r\n\r\n", "404 Not Found"),
        (b"HTTP/1.0 200 OK\r\n\r\n<html>", "not XML"),
        (b"HTTP/1.0 200 OK\r\n\r\n<netft></netft>", "cfgcpf"),
        (&LONG, "over 262144 bytes"),
    ] {
        let error = refused_by(answer);
        assert!(error.contains(words), "{error}");
    }
    // A closed port.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let address = format!("netft://127.0.0.1?web={port}");
    let error = NetFt::connect(&address.parse().unwrap())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("netftapi2.xml") && error.contains("cpf=COUNTS"),
        "{error}"
    );
}

#[test]
fn an_absent_sensor_is_reported_until_it_responds() {
    // A port without a sensor.
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = socket.local_addr().unwrap();
    let sensor = connect(&format!("netft://{port}?cpf=1000000&cpt=1000000"));
    let error = next(&sensor).unwrap_err();
    assert!(matches!(error, ForceError::Silent { .. }), "{error}");
    // The client repeats its request. The response consists of invalid datagrams and one valid record.
    let mut bytes = [0; 8];
    let (_, client) = socket.recv_from(&mut bytes).unwrap();
    assert_eq!(bytes, [0x12, 0x34, 0, 2, 0, 0, 0, 0]);
    for datagram in [&[0; 35][..], &[0; 64], &[], &[0; 36]] {
        socket.send_to(datagram, client).unwrap();
    }
    let heard = loop {
        match next(&sensor) {
            Ok(sample) => break sample,
            Err(error) => assert!(matches!(error, ForceError::Silent { .. }), "{error}"),
        }
    };
    assert_eq!(heard.wrench, [0.0; 6]);
}

#[test]
fn a_fault_is_reported_until_it_clears() {
    let faulty = Arc::new(AtomicBool::new(true));
    let shared = Arc::clone(&faulty);
    let wrench = move || (!shared.load(Ordering::Relaxed)).then_some([1.0; 6]);
    let emulator = NetFtEmulator::start(500.0, wrench).unwrap();
    let sensor = connect(&emulator.address());
    let error = next(&sensor).unwrap_err().to_string();
    assert!(
        error.contains("0x80000000") && error.contains("saturated"),
        "{error}"
    );
    faulty.store(false, Ordering::Relaxed);
    while next(&sensor).is_err() {}
    assert_eq!(next(&sensor).unwrap().wrench, [1.0; 6]);
}
