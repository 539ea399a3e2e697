//! Opening a link does not change other sockets of the program.
#![cfg(all(feature = "zenoh", target_os = "linux"))]

#[path = "support/ports.rs"]
mod ports;
#[path = "../../feeler-lab/tests/support/skip.rs"]
mod skip;

use feeler_link::transport::{Link, LinkConfig, Network, Outlet, Topic};
use rustix::net::sockopt::{set_socket_linger, socket_linger};
use rustix::process::{PidfdFlags, PidfdGetfdFlags, getpid, pidfd_getfd, pidfd_open};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Number of sockets of this process that linger. `None` if the system forbids inspecting them.
fn lingering() -> Option<usize> {
    let this = pidfd_open(getpid(), PidfdFlags::empty()).ok()?;
    pidfd_getfd(&this, 0, PidfdGetfdFlags::empty()).ok()?;
    let numbers = std::fs::read_dir("/proc/self/fd").ok()?.flatten();
    let numbers = numbers.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    let sockets = numbers.filter(|&number| {
        let descriptor = pidfd_getfd(&this, number, PidfdGetfdFlags::empty());
        descriptor.is_ok_and(|descriptor| matches!(socket_linger(&descriptor), Ok(Some(_))))
    });
    Some(sockets.count())
}

#[test]
fn linger_is_disabled_for_the_sockets_of_links_only() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let stranger = TcpStream::connect(listener.local_addr().expect("its address"));
    let stranger = stranger.expect("a connection");
    set_socket_linger(&stranger, Some(Duration::from_secs(10))).expect("a socket");
    if lingering().is_none() {
        // Containers may withhold this permission.
        skip::not_permitted("this system forbids a process to inspect its descriptors");
        return;
    }

    let endpoint = ports::unused_endpoint();
    let config = |listen: &[String], connect: &[String]| LinkConfig {
        rig: "linger".into(),
        is_hand: !listen.is_empty(),
        listen: listen.to_vec(),
        connect: connect.to_vec(),
        ..LinkConfig::default()
    };
    let one = Link::open(&config(std::slice::from_ref(&endpoint), &[])).expect("a link");
    let other = Link::open(&config(&[], &[endpoint])).expect("a link");
    let arrived = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&arrived);
    let heard = Arc::new(move |_: Topic, _: &[u8]| flag.store(true, Ordering::Relaxed));
    one.listen(Topic::Stop, heard).expect("a subscription");
    let give_up = Instant::now() + Duration::from_secs(60);
    while !arrived.load(Ordering::Relaxed) {
        assert!(Instant::now() < give_up, "the programs do not connect");
        other.send(Topic::Stop, Vec::new()).expect("to send");
        std::thread::sleep(Duration::from_millis(20));
    }

    assert_eq!(lingering(), Some(1), "only the stranger's socket lingers");
    let linger = socket_linger(&stranger);
    assert_eq!(linger, Ok(Some(Duration::from_secs(10))));
}
