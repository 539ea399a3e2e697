//! A live skin as a tactile sensor.

use super::connection::Connection;
use super::{SkinCounters, SkinError};
use feeler::sensor::forces::{NO_FORCE, SensorError, TactileFrame, TactileSensor};
use feeler::sensor::taxel::{TaxelChain, TaxelLayout};
use glam::DVec3;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time without a frame after which a reading without forces is returned.
const SILENCE: Duration = Duration::from_millis(100);
/// Time between two attempts to open a lost port.
const RETRY: Duration = Duration::from_millis(200);

/// A change of a skin's connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SkinNews {
    /// The port has failed, for this reason. It is opened again as soon as possible.
    Disconnected(String),
    /// The port was opened again.
    Reconnected,
    /// The port is open, but frames do not arrive.
    Silent,
}

/// A skin on a serial port. Each frame is a reading, stamped with the estimated arrival of its first byte in seconds since
/// the sensor was opened.
///
/// If no frame arrives for 100 ms, a reading without forces is returned ([`NO_FORCE`] on all taxels), and further ones
/// every 100 ms. A lost port is opened again under the same path, and the zero is kept. While the zero is measured, readings
/// have no forces. Reading never fails, and allocates only when the port is lost or opened.
#[derive(Debug)]
pub struct SkinSensor {
    connection: Connection,
    chain: TaxelChain,
    values: Vec<DVec3>,
    /// Number of the next reading.
    sequence: u64,
    /// Stamp of the latest reading, s.
    stamp: f64,
    /// Time of the latest reading on the host.
    latest: Instant,
    next_attempt: Instant,
    is_silent: bool,
    /// `true` if the latest reading comes from a frame.
    has_frame: bool,
    news: Option<SkinNews>,
    counters: Arc<SkinCounters>,
}

impl SkinSensor {
    /// Opens the port at `path`, on which a skin with this `layout` is expected.
    ///
    /// # Errors
    /// If the layout is invalid or has no protocol, or if the port cannot be opened.
    pub fn open(path: &str, layout: &TaxelLayout) -> Result<Self, SkinError> {
        let chain = TaxelChain::new(layout)?;
        let serial = layout.serial.as_ref();
        let serial = serial.ok_or_else(|| SkinError::NoProtocol {
            layout: layout.name.clone(),
        })?;
        let mut connection = Connection::new(path, serial, chain.element_count());
        connection.open().map_err(|source| SkinError::Port {
            path: path.into(),
            source,
        })?;
        let now = Instant::now();
        Ok(Self {
            values: vec![DVec3::NAN; chain.element_count()],
            connection,
            chain,
            sequence: 0,
            stamp: 0.0,
            latest: now,
            next_attempt: now,
            is_silent: false,
            has_frame: false,
            news: None,
            counters: Arc::default(),
        })
    }

    /// Measures the zero again, from the next frames. The skin must be untouched.
    pub fn zero(&mut self) {
        self.chain.restart();
    }

    /// Returns `true` unless the zero is being measured.
    pub fn has_zero(&self) -> bool {
        self.chain.has_zeros()
    }

    /// Returns `true` if the latest reading comes from a frame, and `false` if no frame arrived in time.
    pub fn has_frame(&self) -> bool {
        self.has_frame
    }

    /// Returns and removes the latest change of the connection.
    pub fn take_news(&mut self) -> Option<SkinNews> {
        self.news.take()
    }

    /// Counters of the connection.
    pub fn counters(&self) -> Arc<SkinCounters> {
        Arc::clone(&self.counters)
    }

    /// Values of the latest frame in the columns x, y and z of each taxel, before the zero is subtracted; NaN if invalid.
    pub fn values(&self) -> &[DVec3] {
        &self.values
    }

    /// Waits at most `time` for bytes, or for the time to open a lost port.
    fn wait(&mut self, time: Duration) {
        if self.connection.is_open() {
            if let Err(error) = self.connection.receive(time) {
                self.connection.close();
                self.news = Some(SkinNews::Disconnected(error.to_string()));
            }
            return;
        }
        let now = Instant::now();
        if now < self.next_attempt {
            std::thread::sleep(time.min(self.next_attempt - now));
            return;
        }
        self.next_attempt = now + RETRY;
        if self.connection.open().is_ok() {
            self.counters.reconnection();
            self.news = Some(SkinNews::Reconnected);
        }
    }

    /// Completes a reading with this stamp (s), which never decreases.
    fn finish(&mut self, reading: &mut TactileFrame, stamp: f64) {
        self.stamp = stamp.max(self.stamp);
        (reading.sequence, reading.stamp) = (self.sequence, self.stamp);
        self.sequence += 1;
        self.latest = Instant::now();
    }

    /// A reading without forces.
    fn miss(&mut self, reading: &mut TactileFrame) {
        reading.forces.fill(NO_FORCE);
        self.has_frame = false;
        self.counters.missing();
        if self.connection.is_open() && !std::mem::replace(&mut self.is_silent, true) {
            self.news.get_or_insert(SkinNews::Silent);
        }
        self.finish(reading, self.connection.now());
    }
}

impl TactileSensor for SkinSensor {
    fn element_count(&self) -> usize {
        self.chain.element_count()
    }

    /// Waits for the next frame, at most 100 ms.
    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        reading.check_elements(self.element_count())?;
        loop {
            if let Some(stamp) = self.connection.decode(&mut self.values) {
                let was_zero = self.chain.has_zeros();
                self.finish(reading, stamp);
                self.chain
                    .sense(self.stamp, &self.values, &mut reading.forces);
                if !was_zero {
                    reading.forces.fill(NO_FORCE);
                }
                (self.is_silent, self.has_frame) = (false, true);
                self.counters.frame(self.stamp);
                let decoder = self.connection.decoder();
                self.counters
                    .damage(decoder.skipped_bytes(), decoder.losses());
                return Ok(());
            }
            let left = SILENCE.saturating_sub(self.latest.elapsed());
            if left.is_zero() {
                self.miss(reading);
                return Ok(());
            }
            self.wait(left);
        }
    }
}
