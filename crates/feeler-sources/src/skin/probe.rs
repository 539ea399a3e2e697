//! Identifies the skin that is connected to a port.

use feeler::sensor::skin::{SerialConfig, SkinDecoder, SkinProtocol};
use feeler_serial::SerialPort;
use glam::DVec3;
use std::io;
use std::time::{Duration, Instant};

/// Time to listen for frames.
const LISTEN: Duration = Duration::from_millis(600);
/// Time to wait for a response.
const RESPONSE: Duration = Duration::from_millis(60);
/// Minimum number of frames by which a protocol is recognized.
const PROOF: u64 = 3;
/// Range of the number of chips on known and possible boards with magnetometers.
const CHIPS: std::ops::RangeInclusive<usize> = 1..=16;
/// Numbers of taxels of FlexiTac: 12 rows of 32, 16 rows of 32, and 16 rows of 16.
const MATRICES: [usize; 3] = [384, 512, 256];
/// Addresses of PaXini modules.
const ADDRESSES: std::ops::RangeInclusive<u8> = 1..=8;

/// A skin on a port.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundSkin {
    /// Settings of its port.
    pub serial: SerialConfig,
    /// Number of taxels, or `None` if the skin does not report it.
    pub taxels: Option<usize>,
    /// Frames per second, or `None` if the skin only responds to requests.
    pub rate: Option<f64>,
}

/// Finds the skin on the port at `path`, or returns `None` if no frame of a known protocol arrives.
///
/// Listens for skins that send unprompted. If nothing arrives, sends requests for the force on a single taxel to the
/// addresses of PaXini modules. These requests change no settings.
///
/// # Errors
/// If the port cannot be opened or fails.
pub fn probe_port(path: &str) -> io::Result<Option<FoundSkin>> {
    let mut has_bytes = false;
    for protocol in [SkinProtocol::Magnetometers, SkinProtocol::Flexitac] {
        let bytes = listen(path, protocol.baud_rate())?;
        has_bytes |= !bytes.is_empty();
        if let Some(found) = recognize(protocol, &bytes) {
            return Ok(Some(found));
        }
    }
    match has_bytes {
        true => Ok(None),
        false => ask(path),
    }
}

/// Returns the bytes that arrive within [`LISTEN`].
fn listen(path: &str, baud_rate: u32) -> io::Result<Vec<u8>> {
    let mut port = SerialPort::open(path, baud_rate)?;
    let end = Instant::now() + LISTEN;
    let (mut bytes, mut buffer) = (Vec::new(), [0; 4096]);
    loop {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(bytes);
        }
        let count = port.receive(&mut buffer, left)?;
        bytes.extend(&buffer[..count]);
    }
}

/// Recognizes a skin. Its number of taxels is the one for which the most frames are found.
fn recognize(protocol: SkinProtocol, bytes: &[u8]) -> Option<FoundSkin> {
    let serial = SerialConfig::new(protocol);
    let frames = |&taxels: &usize| count_frames(&serial, taxels, bytes);
    let taxels = match protocol {
        SkinProtocol::Magnetometers => CHIPS.max_by_key(frames),
        SkinProtocol::Flexitac => MATRICES.into_iter().max_by_key(frames),
        SkinProtocol::Paxini => None,
    }?;
    let count = frames(&taxels);
    (count >= PROOF).then(|| FoundSkin {
        serial: serial.clone(),
        taxels: Some(taxels),
        rate: Some(count as f64 / LISTEN.as_secs_f64()),
    })
}

fn count_frames(serial: &SerialConfig, taxels: usize, bytes: &[u8]) -> u64 {
    let mut decoder = SkinDecoder::new(serial, taxels);
    let mut values = vec![DVec3::NAN; taxels];
    decoder.feed(bytes);
    while decoder.next_frame(&mut values).is_some() {}
    decoder.frames()
}

/// Requests the force on one taxel from all addresses.
fn ask(path: &str) -> io::Result<Option<FoundSkin>> {
    let protocol = SkinProtocol::Paxini;
    let mut port = SerialPort::open(path, protocol.baud_rate())?;
    for address in ADDRESSES {
        let serial = SerialConfig {
            address,
            ..SerialConfig::new(protocol)
        };
        port.send(&serial.request(1).unwrap_or_default())?;
        let mut decoder = SkinDecoder::new(&serial, 1);
        let end = Instant::now() + RESPONSE;
        let mut buffer = [0; 256];
        while Instant::now() < end {
            let left = end.saturating_duration_since(Instant::now());
            let count = port.receive(&mut buffer, left)?;
            decoder.feed(&buffer[..count]);
            if decoder.next_frame(&mut [DVec3::NAN]).is_some() {
                return Ok(Some(FoundSkin {
                    serial,
                    taxels: None,
                    rate: None,
                }));
            }
        }
    }
    Ok(None)
}
