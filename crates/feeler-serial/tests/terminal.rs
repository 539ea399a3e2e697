//! Serial ports on pseudo-terminals.

#![cfg(target_os = "linux")]

use feeler_serial::{PseudoTerminal, SerialPort};
use std::time::Duration;

/// Longer than any delay of a busy computer.
const LONG: Duration = Duration::from_secs(60);

#[test]
fn carries_all_byte_values_in_both_directions() {
    let mut device = PseudoTerminal::open().unwrap();
    let mut port = SerialPort::open(device.path(), 2_000_000).unwrap();
    let all: Vec<u8> = (0..=255).collect();
    let mut received: Vec<u8> = Vec::new();
    let mut bytes = [0; 64];
    device.send(&all);
    while received.len() < all.len() {
        let count = port.receive(&mut bytes, LONG).unwrap();
        received.extend(&bytes[..count]);
    }
    assert_eq!(received, all);
    port.send(&all).unwrap();
    received.clear();
    while received.len() < all.len() {
        let count = device.receive(&mut bytes, LONG);
        received.extend(&bytes[..count]);
    }
    assert_eq!(received, all);
}

#[test]
fn times_out_is_exclusive_and_fails_if_unplugged() {
    let device = PseudoTerminal::open().unwrap();
    let path = device.path().to_string();
    let mut port = SerialPort::open(&path, 115_200).unwrap();
    assert!(SerialPort::open(&path, 115_200).is_err());
    let mut bytes = [0; 8];
    assert_eq!(
        port.receive(&mut bytes, Duration::from_millis(1)).unwrap(),
        0
    );
    drop(device);
    assert!(port.receive(&mut bytes, LONG).is_err());
}
