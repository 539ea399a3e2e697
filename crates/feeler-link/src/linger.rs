//! Sockets that are closed at once, whatever their peer has not read yet.
//!
//! The link's library gives each of its TCP sockets a linger of ten seconds, and has no setting for it. To close a socket to
//! a program that is frozen then waits for so long, on the thread that serves all others.

use std::io;
use std::thread;
use std::time::Duration;

/// Time between two looks for new sockets.
const INTERVAL: Duration = Duration::from_millis(200);

/// Takes the linger from all sockets of this process, from a thread of its own while `is_open`.
///
/// Where the system does not let a process look at its own descriptors, as some containers do not, it stays.
///
/// # Errors
/// When there is no thread to be had.
pub fn keep_off(is_open: impl Fn() -> bool + Send + 'static) -> io::Result<()> {
    let work = move || {
        while is_open() {
            // It is tried again; and without it, all else works.
            let _ = turn_off();
            thread::sleep(INTERVAL);
        }
    };
    thread::Builder::new().name("linger".into()).spawn(work)?;
    Ok(())
}

#[cfg(target_os = "linux")]
fn turn_off() -> io::Result<()> {
    use rustix::net::sockopt::{set_socket_linger, socket_linger};
    use rustix::process::{PidfdFlags, PidfdGetfdFlags, getpid, pidfd_getfd, pidfd_open};

    let this = pidfd_open(getpid(), PidfdFlags::empty())?;
    for entry in std::fs::read_dir("/proc/self/fd")? {
        let name = entry?.file_name();
        let Some(number) = name.to_str().and_then(|name| name.parse().ok()) else {
            continue;
        };
        // A descriptor of our own for the same socket, which may be closed meanwhile.
        let Ok(descriptor) = pidfd_getfd(&this, number, PidfdGetfdFlags::empty()) else {
            continue;
        };
        if let Ok(Some(_)) = socket_linger(&descriptor) {
            set_socket_linger(&descriptor, None)?;
        }
    }
    Ok(())
}

#[cfg(not(target_os = "linux"))]
fn turn_off() -> io::Result<()> {
    Ok(())
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use rustix::net::sockopt::{set_socket_linger, socket_linger};
    use std::net::{TcpListener, TcpStream};
    use std::time::Duration;

    #[test]
    fn the_linger_of_a_socket_is_turned_off() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let stream = TcpStream::connect(listener.local_addr().expect("its address"));
        let stream = stream.expect("a connection");
        let ten = Some(Duration::from_secs(10));
        set_socket_linger(&stream, ten).expect("a socket");
        assert_eq!(socket_linger(&stream), Ok(ten));
        if let Err(error) = super::turn_off() {
            eprintln!("skipped: this system does not let a process see its descriptors: {error}");
            return;
        }
        assert_eq!(socket_linger(&stream), Ok(None));
    }
}
