//! Port, request and decoder of a skin.

use feeler::sensor::skin::{Arrivals, SerialConfig, SkinDecoder};
use feeler_serial::SerialPort;
use glam::DVec3;
use std::io;
use std::time::{Duration, Instant};

/// Number of bytes per read.
const READ: usize = 4096;
/// Minimum time between two requests.
const PERIOD: Duration = Duration::from_millis(5);
/// Maximum time from a request to the end of the response, in addition to the transmission.
const PATIENCE: Duration = Duration::from_millis(30);

/// A skin's byte stream. Does not allocate after construction, except when it opens the port.
#[derive(Debug)]
pub struct Connection {
    path: String,
    config: SerialConfig,
    port: Option<SerialPort>,
    decoder: SkinDecoder,
    arrivals: Arrivals,
    request: Option<Vec<u8>>,
    /// Time of the unanswered request.
    asked: Option<Instant>,
    /// Time of the next request.
    next_request: Instant,
    /// Time of stamp 0.
    origin: Instant,
    buffer: Vec<u8>,
}

impl Connection {
    /// Creates the connection to a skin of `taxels` taxels on the port at `path`, which is not opened yet.
    pub fn new(path: &str, config: &SerialConfig, taxels: usize) -> Self {
        let now = Instant::now();
        Self {
            path: path.into(),
            config: config.clone(),
            port: None,
            decoder: SkinDecoder::new(config, taxels),
            arrivals: Arrivals::new(config.byte_time()),
            request: config.request(taxels),
            asked: None,
            next_request: now,
            origin: now,
            buffer: vec![0; READ],
        }
    }

    pub fn decoder(&self) -> &SkinDecoder {
        &self.decoder
    }

    pub fn is_open(&self) -> bool {
        self.port.is_some()
    }

    /// Current time since stamp 0, s.
    pub fn now(&self) -> f64 {
        self.origin.elapsed().as_secs_f64()
    }

    /// Opens the port.
    ///
    /// # Errors
    /// If the port cannot be opened.
    pub fn open(&mut self) -> io::Result<()> {
        self.port = Some(SerialPort::open(&self.path, self.config.baud_rate)?);
        self.decoder.restart();
        self.asked = None;
        Ok(())
    }

    pub fn close(&mut self) {
        self.port = None;
    }

    /// Decodes the next received frame into `values` and returns its stamp (s), or `None` if more bytes are required.
    pub fn decode(&mut self, values: &mut [DVec3]) -> Option<f64> {
        let frame = self.decoder.next_frame(values)?;
        self.asked = None;
        Some(self.arrivals.of(frame.first_byte))
    }

    /// Waits at most `timeout` for bytes, and sends a request if one is due.
    ///
    /// # Errors
    /// If the port has failed or is not open.
    pub fn receive(&mut self, timeout: Duration) -> io::Result<()> {
        let timeout = self.ask(timeout)?;
        let port = self.port.as_mut().ok_or(io::ErrorKind::NotConnected)?;
        let count = port.receive(&mut self.buffer, timeout)?;
        self.arrivals
            .read(count, self.origin.elapsed().as_secs_f64());
        self.decoder.feed(&self.buffer[..count]);
        Ok(())
    }

    /// Sends a request if one is due, and returns the time to wait for bytes.
    fn ask(&mut self, timeout: Duration) -> io::Result<Duration> {
        let (Some(request), Some(port)) = (&self.request, &mut self.port) else {
            return Ok(timeout);
        };
        let now = Instant::now();
        if let Some(asked) = self.asked {
            let bytes = request.len() + self.config.frame_bytes(self.decoder.taxels());
            let transmission = self.config.byte_time() * bytes as f64;
            let patience = PATIENCE + Duration::from_secs_f64(transmission);
            let left = patience.saturating_sub(now - asked);
            if !left.is_zero() {
                return Ok(timeout.min(left));
            }
            // The rest of a torn response must not become part of the next one.
            self.decoder.restart();
            port.discard_input()?;
        }
        if now < self.next_request {
            return Ok(timeout.min(self.next_request - now));
        }
        port.send(request)?;
        self.asked = Some(now);
        self.next_request = now + PERIOD;
        Ok(timeout.min(PATIENCE))
    }
}
