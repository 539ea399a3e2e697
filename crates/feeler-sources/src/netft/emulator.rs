//! Emulates a force/torque sensor.

use super::rdt::{Command, Record, Request};
use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// A force/torque sensor on this computer that streams RDT records to the client that sent the latest request. It also
/// serves the part of the sensor's web page that contains the scale of the counts.
#[derive(Debug)]
pub struct NetFtEmulator {
    address: SocketAddr,
    web: SocketAddr,
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl NetFtEmulator {
    /// Counts per newton and per newton metre.
    pub const COUNTS: f64 = 1e6;

    /// Starts streaming at `rate` Hz. `wrench` returns the current forces (N) and torques (N m), or `None` to report
    /// a fault.
    ///
    /// # Errors
    /// If a socket or thread cannot be created.
    pub fn start(
        rate: f64,
        mut wrench: impl FnMut() -> Option<[f64; 6]> + Send + 'static,
    ) -> io::Result<Self> {
        let socket = UdpSocket::bind("127.0.0.1:0")?;
        let address = socket.local_addr()?;
        let listener = TcpListener::bind("127.0.0.1:0")?;
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let period = Duration::from_secs_f64(1.0 / rate);
        let thread = thread::Builder::new()
            .name("emulated force sensor".into())
            .spawn(move || {
                let mut asked = None;
                let mut record = Record::default();
                let mut due = Instant::now();
                while !stopped.load(Ordering::Relaxed) {
                    due += period;
                    listen(&socket, due, &mut asked);
                    let (status, counts) = match wrench() {
                        Some(wrench) => (0, wrench.map(|value| (value * Self::COUNTS) as i32)),
                        None => (1 << 31, [0; 6]),
                    };
                    record.ft_sequence = record.ft_sequence.wrapping_add(1);
                    if let Some(client) = asked {
                        record.rdt_sequence = record.rdt_sequence.wrapping_add(1);
                        (record.status, record.counts) = (status, counts);
                        // A send error means that the client is gone.
                        let _ = socket.send_to(&record.to_bytes(), client);
                    }
                }
            })?;
        let mut emulator = Self {
            address,
            web: listener.local_addr()?,
            stop: Arc::clone(&stop),
            threads: vec![thread],
        };
        let web = thread::Builder::new()
            .name("emulated web page".into())
            .spawn(move || {
                for client in listener.incoming().map_while(Result::ok) {
                    if stop.load(Ordering::Relaxed) {
                        break;
                    }
                    // A client that is gone does not need a response.
                    let _ = answer(client);
                }
            })?;
        emulator.threads.push(web);
        Ok(emulator)
    }

    /// Address with counts, in the syntax of [`NetFtAddress`](super::NetFtAddress).
    pub fn address(&self) -> String {
        let counts = Self::COUNTS;
        format!("netft://{}?cpf={counts}&cpt={counts}", self.address)
    }

    /// Returns the address without the counts per newton; a client reads them from the emulated web page.
    pub fn bare_address(&self) -> String {
        format!("netft://{}?web={}", self.address, self.web.port())
    }
}

/// Responds to any request with the page.
fn answer(mut client: TcpStream) -> io::Result<()> {
    let wait = Some(Duration::from_secs(1));
    client.set_read_timeout(wait)?;
    client.set_write_timeout(wait)?;
    let mut request = [0; 1024];
    let mut length = 0;
    while length < request.len() && !request[..length].ends_with(b"\r\n\r\n") {
        match client.read(&mut request[length..])? {
            0 => break,
            count => length += count,
        }
    }
    let counts = NetFtEmulator::COUNTS;
    write!(
        client,
        "HTTP/1.0 200 OK\r\nContent-Type: text/xml\r\n\r\n<?xml version=\"1.0\"?>\n<netft><cfgcpf>{counts}</cfgcpf>\
         <cfgcpt>{counts}</cfgcpt><scfgfu>N</scfgfu><scfgtu>Nm</scfgtu></netft>\n"
    )
}

/// Processes requests until `due`.
fn listen(socket: &UdpSocket, due: Instant, asked: &mut Option<SocketAddr>) {
    loop {
        let left = due.saturating_duration_since(Instant::now());
        if left.is_zero() || socket.set_read_timeout(Some(left)).is_err() {
            return;
        }
        let mut bytes = [0; 64];
        let Ok((length, client)) = socket.recv_from(&mut bytes) else {
            continue;
        };
        if let Ok(request) = Request::from_bytes(&bytes[..length]) {
            match request.command {
                Command::Stream => *asked = Some(client),
                Command::Stop => *asked = None,
                Command::Bias => {}
            }
        }
    }
}

impl Drop for NetFtEmulator {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        // Wakes up the web page's thread.
        let _ = TcpStream::connect(self.web);
        for thread in self.threads.drain(..) {
            // The threads end within a period; a thread that panicked has already ended.
            let _ = thread.join();
        }
    }
}
