//! Emulated skin on a pseudo-terminal, served by a thread in real time.

use super::simulated::SimulatedSkin;
use super::{SkinError, SkinEvent};
use feeler::sensor::skin::SerialConfig;
use feeler::sensor::taxel::TaxelLayout;
use feeler_serial::PseudoTerminal;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// An emulated skin that any program can open. Stops when dropped.
#[derive(Debug)]
pub struct SkinEmulator {
    path: String,
    /// Dropped to end the thread.
    events: Option<Sender<SkinEvent>>,
    thread: Option<JoinHandle<()>>,
}

impl SkinEmulator {
    /// Starts a skin with this `layout` that sends `rate` frames per second, or responds to requests.
    ///
    /// If `link` is given, it becomes a symbolic link to the port, like the stable names of USB ports: it is removed
    /// while the skin is unplugged, and points to the new port afterwards.
    ///
    /// # Errors
    /// If the layout has no protocol, or if no pseudo-terminal or link can be created.
    pub fn start(layout: &TaxelLayout, rate: f64, link: Option<&Path>) -> Result<Self, SkinError> {
        let serial = layout.serial.clone();
        let serial = serial.ok_or_else(|| SkinError::NoProtocol {
            layout: layout.name.clone(),
        })?;
        let link = link.map(Path::to_path_buf);
        let failed = |source| SkinError::Emulator {
            link: link.clone().unwrap_or_default(),
            source,
        };
        let port = plug_in(link.as_deref()).map_err(failed)?;
        let path = match &link {
            Some(link) => link.display().to_string(),
            None => port.path().to_string(),
        };
        let (sender, events) = channel();
        let server = Server {
            skin: SimulatedSkin::new(layout, serial.protocol),
            serial,
            taxels: layout.taxels.len(),
            period: Duration::from_secs_f64(1.0 / rate),
            link: link.clone(),
            port: Some(port),
            lost: 0.0,
            flipped: 0.0,
            quiet: None,
            unplugged: None,
            random: Pcg64::seed_from_u64(1),
        };
        let thread = std::thread::Builder::new()
            .name("emulated skin".into())
            .spawn(move || server.serve(&events))
            .map_err(failed)?;
        Ok(Self {
            path,
            events: Some(sender),
            thread: Some(thread),
        })
    }

    /// Path of the port, or of the link to it.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Applies `event` from now on.
    pub fn inject(&self, event: SkinEvent) {
        if let Some(events) = &self.events {
            // The thread ends only if the emulator is dropped.
            let _ = events.send(event);
        }
    }
}

impl Drop for SkinEmulator {
    fn drop(&mut self) {
        drop(self.events.take());
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has already been printed.
            let _ = thread.join();
        }
    }
}

/// Opens a port, and points `link` to it.
fn plug_in(link: Option<&Path>) -> io::Result<PseudoTerminal> {
    let port = PseudoTerminal::open()?;
    if let Some(link) = link {
        if link.is_symlink() {
            std::fs::remove_file(link)?;
        }
        std::os::unix::fs::symlink(port.path(), link)?;
    }
    Ok(port)
}

struct Server {
    skin: SimulatedSkin,
    serial: SerialConfig,
    taxels: usize,
    period: Duration,
    link: Option<PathBuf>,
    /// `None` while the skin is unplugged.
    port: Option<PseudoTerminal>,
    /// Fraction of bytes that are dropped.
    lost: f64,
    /// Fraction of bytes in which a bit is changed.
    flipped: f64,
    /// Time until which nothing is sent.
    quiet: Option<Instant>,
    /// Time at which the skin is plugged in again.
    unplugged: Option<Instant>,
    random: Pcg64,
}

impl Server {
    fn serve(mut self, events: &Receiver<SkinEvent>) {
        let mut values = Vec::new();
        let mut received = Vec::new();
        let mut due = Instant::now();
        loop {
            match events.try_recv() {
                Ok(event) => self.apply(event),
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => break,
            }
            due = (due + self.period).min(Instant::now() + self.period);
            self.receive(due, &mut received);
            self.plug_in();
            if let Some(taxels) = self.taxels_to_send(&received) {
                self.skin.read(&mut self.random, &mut values);
                values.truncate(taxels);
                self.send(&values);
            }
            received.clear();
        }
        self.remove_link();
    }

    /// Removes the link. Must be called before the port is closed: the system gives the port's number to the next
    /// pseudo-terminal that any program opens, and the link would point to that one.
    fn remove_link(&self) {
        if let Some(link) = &self.link {
            // The link may have been removed.
            let _ = std::fs::remove_file(link);
        }
    }

    /// Number of taxels in the next frame, or `None` if no frame was requested.
    fn taxels_to_send(&self, received: &[u8]) -> Option<usize> {
        match self.serial.request(self.taxels) {
            Some(_) => self.serial.requested_taxels(received),
            None => Some(self.taxels),
        }
    }

    /// Opens the port again when the unplugged time is over.
    fn plug_in(&mut self) {
        let is_over = self.unplugged.is_some_and(|end| Instant::now() >= end);
        if is_over && let Ok(port) = plug_in(self.link.as_deref()) {
            (self.port, self.unplugged) = (Some(port), None);
        }
    }

    /// Collects bytes from the other program until `due`, or until they form a request.
    fn receive(&mut self, due: Instant, received: &mut Vec<u8>) {
        loop {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() || self.serial.requested_taxels(received).is_some() {
                return;
            }
            let mut bytes = [0; 256];
            let count = match &mut self.port {
                Some(port) => port.receive(&mut bytes, left),
                None => {
                    std::thread::sleep(left);
                    0
                }
            };
            received.extend(&bytes[..count]);
        }
    }

    fn send(&mut self, values: &[DVec3]) {
        if self.quiet.is_some_and(|end| Instant::now() < end) {
            return;
        }
        let mut bytes = Vec::new();
        self.serial.encode(values, &mut bytes);
        let (lost, flipped, random) = (self.lost, self.flipped, &mut self.random);
        bytes.retain(|_| !random.random_bool(lost));
        for byte in &mut bytes {
            if random.random_bool(flipped) {
                *byte ^= 1 << random.random_range(0..8);
            }
        }
        if let Some(port) = &mut self.port {
            port.send(&bytes);
        }
    }

    fn apply(&mut self, event: SkinEvent) {
        let after = |seconds| Some(Instant::now() + Duration::from_secs_f64(seconds));
        match event {
            SkinEvent::Press(counts) => self.skin.press = counts,
            SkinEvent::Field(field) => self.skin.field = DVec3::from_array(field),
            SkinEvent::LoseBytes(share) => self.lost = share,
            SkinEvent::FlipBytes(share) => self.flipped = share,
            SkinEvent::Silent(seconds) => self.quiet = after(seconds),
            SkinEvent::Unplug(seconds) => {
                self.remove_link();
                self.port = None;
                self.unplugged = after(seconds);
            }
        }
    }
}
