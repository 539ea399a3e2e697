//! Disables the linger option of the link's sockets, so that they close at once even if the peer has unread data.
//!
//! Zenoh sets a linger of ten seconds on each of its TCP sockets and has no setting for it. Closing a socket to a
//! frozen program would block for ten seconds, on the thread that serves all other sockets.

use serde::Deserialize;
use std::io;
use std::net::SocketAddr;

/// Zenoh's description of a link, with the locators of both ends, such as `tcp/127.0.0.1:7447`.
#[derive(Deserialize)]
struct LinkDescription {
    src: String,
    dst: String,
}

/// Addresses of both ends of a TCP connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Connection {
    local: SocketAddr,
    peer: SocketAddr,
}

impl Connection {
    /// Parses Zenoh's JSON description of a link. Returns `None` if the link does not use TCP.
    pub fn of_link(json: &[u8]) -> Option<Self> {
        let link: LinkDescription = serde_json::from_slice(json).ok()?;
        Some(Self {
            local: address(&link.src)?,
            peer: address(&link.dst)?,
        })
    }
}

/// Returns the address of a TCP or TLS locator.
fn address(locator: &str) -> Option<SocketAddr> {
    let (protocol, rest) = locator.split_once('/')?;
    let address = rest.split(['?', '#']).next()?;
    let is_tcp = ["tcp", "tls"].contains(&protocol);
    is_tcp.then(|| address.parse().ok())?
}

/// Clears the linger option of this process's socket for `connection`. Other sockets are unchanged.
///
/// # Errors
/// If the system forbids a process to inspect its own descriptors, as in some containers.
#[cfg(target_os = "linux")]
pub fn clear(connection: Connection) -> io::Result<()> {
    use rustix::net::sockopt::{set_socket_linger, socket_linger};
    use rustix::process::{PidfdFlags, PidfdGetfdFlags, getpid, pidfd_getfd, pidfd_open};

    let this = pidfd_open(getpid(), PidfdFlags::empty())?;
    for entry in std::fs::read_dir("/proc/self/fd")? {
        let name = entry?.file_name();
        let Some(number) = name.to_str().and_then(|name| name.parse().ok()) else {
            continue;
        };
        // Duplicates the descriptor, because the original may be closed meanwhile.
        let Ok(descriptor) = pidfd_getfd(&this, number, PidfdGetfdFlags::empty()) else {
            continue;
        };
        if is_of(&descriptor, connection)
            && let Ok(Some(_)) = socket_linger(&descriptor)
        {
            set_socket_linger(&descriptor, None)?;
        }
    }
    Ok(())
}

/// Returns `true` if `descriptor` is the socket of `connection`.
#[cfg(target_os = "linux")]
fn is_of(descriptor: &std::os::fd::OwnedFd, connection: Connection) -> bool {
    use rustix::net::{getpeername, getsockname};

    let same = |found: SocketAddr, expected: SocketAddr| {
        let canonical = |address: SocketAddr| (address.ip().to_canonical(), address.port());
        canonical(found) == canonical(expected)
    };
    let local = getsockname(descriptor).and_then(SocketAddr::try_from);
    let peer = getpeername(descriptor).ok().flatten();
    let peer = peer.and_then(|peer| SocketAddr::try_from(peer).ok());
    local.is_ok_and(|local| same(local, connection.local))
        && peer.is_some_and(|peer| same(peer, connection.peer))
}

/// Does nothing, because a process can find the socket only on Linux.
#[cfg(not(target_os = "linux"))]
pub fn clear(_: Connection) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_over_tcp_have_connections() {
        let link = |src: &str, dst: &str| {
            let json = serde_json::json!({"src": src, "dst": dst, "mtu": 65535, "group": null});
            Connection::of_link(json.to_string().as_bytes())
        };
        let found = link("tcp/127.0.0.1:7447", "tcp/127.0.0.1:40000?rel=1#iface=lo");
        assert_eq!(
            found,
            Some(Connection {
                local: ([127, 0, 0, 1], 7447).into(),
                peer: ([127, 0, 0, 1], 40000).into(),
            })
        );
        assert!(link("tls/[::1]:7447", "tls/[::1]:40000").is_some());
        assert_eq!(link("udp/127.0.0.1:7447", "udp/127.0.0.1:40000"), None);
        assert_eq!(link("tcp/host:7447", "tcp/host:40000"), None);
        assert_eq!(Connection::of_link(b"{}"), None);
        assert_eq!(Connection::of_link(b"\xff"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn only_the_socket_of_the_connection_is_changed() {
        use rustix::net::sockopt::{set_socket_linger, socket_linger};
        use std::io::Write;
        use std::net::{TcpListener, TcpStream};
        use std::time::Duration;

        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let to = listener.local_addr().expect("its address");
        let ten = Some(Duration::from_secs(10));
        let connect = || {
            let stream = TcpStream::connect(to).expect("a connection");
            set_socket_linger(&stream, ten).expect("a socket");
            stream
        };
        let (ours, other) = (connect(), connect());
        let connection = Connection {
            local: ours.local_addr().expect("its address"),
            peer: to,
        };
        if let Err(error) = clear(connection) {
            // The test harness captures `eprintln!`. A missing permission in a container is not a failure.
            let skipped = "SKIPPED: this system forbids a process to inspect its descriptors";
            let _ = writeln!(std::io::stderr(), "{skipped}: {error}");
            return;
        }
        assert_eq!(socket_linger(&ours), Ok(None));
        assert_eq!(socket_linger(&other), Ok(ten));
    }
}
