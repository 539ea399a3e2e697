//! Ports for programs under test.

use std::net::TcpListener;
use std::sync::atomic::{AtomicU16, Ordering};

/// Returns a local endpoint with an unused port, different for each call. The port is below the range from which
/// systems assign ports, so it stays free until the program under test listens on it.
pub fn unused_endpoint() -> String {
    static NEXT: AtomicU16 = AtomicU16::new(0);
    let first = 10_000 + (std::process::id() % 1000) as u16 * 20;
    let free = |port: &u16| TcpListener::bind(("127.0.0.1", *port)).is_ok();
    let port = (0..1000)
        .map(|_| first + NEXT.fetch_add(1, Ordering::Relaxed))
        .find(free);
    format!("tcp/127.0.0.1:{}", port.expect("a port"))
}
