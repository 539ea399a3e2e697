//! GenICam cameras: Aravis' simulated camera in this process, and its fake camera program on the network.
#![cfg(all(feature = "genicam", target_os = "linux"))]

#[path = "../../feeler-lab/tests/support/skip.rs"]
mod skip;

use feeler::sensor::image::{Camera, CameraError, Frame};
use feeler_sources::genicam::{GenicamCamera, GenicamConfig, GenicamError, list};
use feeler_sources::{CameraSettings, Trigger};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

const SIZE: (usize, usize) = (512, 512);
/// Program of the network camera and the Debian package that contains it.
const PEER: (&str, &str) = ("arv-fake-gv-camera-0.8", "aravis-tools");

/// Opens the camera with the given settings. `None`, after printing the reason, if Aravis is not installed.
fn open(
    id: &str,
    rate: f64,
    set: impl FnOnce(&mut CameraSettings),
) -> Option<Result<GenicamCamera, GenicamError>> {
    let mut settings = CameraSettings::new(SIZE, rate);
    set(&mut settings);
    let id = Some(id.into());
    match GenicamCamera::open(&GenicamConfig { id, settings }) {
        Err(error @ GenicamError::Library { .. }) => {
            skip::skipped(&error.to_string());
            None
        }
        opened => Some(opened),
    }
}

fn frame() -> Frame {
    Frame::black(SIZE.0, SIZE.1)
}

/// Frame number modulo 255, which the simulated camera writes into its top left pixel, scaled by 1 + gain +
/// lg(exposure time / 10 ms).
fn number(frame: &Frame) -> u64 {
    u64::from(frame.picture.pixels[0])
}

#[test]
fn sixty_frames_have_device_stamps_and_the_numbers_in_their_pixels() {
    let set = |settings: &mut CameraSettings| {
        (settings.exposure, settings.gain) = (Some(0.01), Some(0.0));
    };
    let Some(camera) = open("Fake_1", 60.0, set) else {
        return;
    };
    let mut camera = camera.expect("a camera");
    let mut frame = frame();
    let mut first = None;
    let mut before = (None, f64::NEG_INFINITY);
    for _ in 0..60 {
        camera.capture(&mut frame).expect("an image");
        let arrived = camera.opened().elapsed().as_secs_f64();
        let (sequence, stamp) = before;
        assert!(sequence.is_none_or(|sequence| frame.sequence > sequence));
        assert!(frame.stamp > stamp && frame.stamp <= arrived);
        before = (Some(frame.sequence), frame.stamp);
        // The frame number in the pixels matches the sequence number.
        let first = *first.get_or_insert(number(&frame));
        assert_eq!(number(&frame), (first + frame.sequence) % 255);
        // The simulated image is a ramp that wraps.
        let pixel =
            |column: usize, row: usize| u64::from(frame.picture.pixels[row * SIZE.0 + column]);
        assert_eq!(pixel(511, 511), (number(&frame) + 511 + 511) % 255);
    }
}

/// Buffered images are delivered at once, so arrival stamps would be equal. With 8 buffers at 60 Hz, the exposures span
/// more than 0.1 s. The test requires half of that, because a stamp may lag while the smallest latency is unknown. A
/// busy computer may disturb an attempt, so up to a hundred are made.
#[test]
fn stamps_are_exposure_times_not_arrivals() {
    let Some(camera) = open("Fake_1", 60.0, |_| {}) else {
        return;
    };
    let mut camera = camera.expect("a camera");
    let mut frame = frame();
    let mut spread = 0.0_f64;
    for _ in 0..100 {
        sleep(Duration::from_millis(250));
        let waiting = [(); 8].map(|()| {
            camera.capture(&mut frame).expect("an image");
            (frame.stamp, camera.opened().elapsed().as_secs_f64())
        });
        let [(first, came), .., (last, finished)] = waiting;
        // All images were buffered and only had to be copied.
        if finished - came < 0.02 {
            spread = spread.max(last - first);
        }
        if spread > 0.05 {
            return;
        }
    }
    panic!("buffered images were at most {spread} s apart");
}

/// At 500 Hz the 16-bit counter, which starts near its end, wraps in the first second.
#[test]
fn sequence_numbers_continue_when_the_device_counter_wraps() {
    let set = |settings: &mut CameraSettings| {
        (settings.exposure, settings.gain) = (Some(0.01), Some(0.0));
    };
    let Some(camera) = open("Fake_1", 500.0, set) else {
        return;
    };
    let mut camera = camera.expect("a camera");
    let mut frame = frame();
    camera.capture(&mut frame).expect("an image");
    let first = number(&frame);
    while frame.sequence < 300 {
        camera.capture(&mut frame).expect("an image");
        // 65535 is a multiple of 255.
        assert_eq!(
            number(&frame),
            (first + frame.sequence) % 255,
            "{}",
            frame.sequence
        );
    }
}

#[test]
fn gain_and_exposure_affect_the_image() {
    for (exposure, gain, scale) in [(0.01, 0.0, 1.0), (0.01, 2.0, 3.0), (0.1, 0.0, 2.0)] {
        let set = |settings: &mut CameraSettings| {
            (settings.exposure, settings.gain) = (Some(exposure), Some(gain));
        };
        let Some(camera) = open("Fake_1", 60.0, set) else {
            return;
        };
        let mut frame = frame();
        camera
            .expect("a camera")
            .capture(&mut frame)
            .expect("an image");
        // The image is a ramp of 255 steps, brightened and saturated at 255. The number of remaining gray levels
        // differs by one depending on whether one of them is exactly 255.
        let distinct: std::collections::BTreeSet<u8> =
            frame.picture.pixels.iter().copied().collect();
        let steps = (255.0 / scale) as usize + 1;
        assert!(
            distinct.len().abs_diff(steps) <= 1,
            "{} of {steps}",
            distinct.len()
        );
    }
}

#[test]
fn images_are_triggered_by_software() {
    let software = |settings: &mut CameraSettings| settings.trigger = Trigger::Software;
    let Some(camera) = open("Fake_1", 100.0, software) else {
        return;
    };
    let mut camera = camera.expect("a camera");
    let mut frame = frame();
    for sequence in 0..5 {
        camera.capture(&mut frame).expect("an image");
        // One image per trigger, and none in between.
        assert_eq!(frame.sequence, sequence);
    }
}

#[test]
fn unsupported_settings_are_refused() {
    let refused = |set: fn(&mut CameraSettings), words: &[&str]| {
        let Some(opened) = open("Fake_1", 60.0, set) else {
            return;
        };
        let error = opened.err().expect("an error").to_string();
        for word in words {
            assert!(error.contains(word), "no {word:?} in {error}");
        }
    };
    refused(|s| s.size = (4096, 512), &["4096x512 px", "2048x2048"]);
    refused(
        |s| s.offset = Some((1600, 0)),
        &["from column 1600, row 0", "2048x2048"],
    );
    refused(|s| s.exposure = Some(60.0), &["60 s", "0.00001 to 10 s"]);
    refused(|s| s.gain = Some(-3.0), &["gain of -3", "0 to 10"]);
    refused(
        |s| s.trigger = Trigger::Line("Line7".into()),
        &["trigger Line7", "Line0, Software"],
    );
    let Some(opened) = open("no-such-camera", 60.0, |_| {}) else {
        return;
    };
    let error = opened.err().expect("an error").to_string();
    assert!(
        error.contains("genicam:no-such-camera: no such camera"),
        "{error}"
    );
    assert!(error.contains("feeler cameras"), "{error}");
}

#[test]
fn cameras_are_listed_with_their_capabilities() {
    let listed = match list(true) {
        Ok(listed) => listed,
        Err(error) => return skip::skipped(&error.to_string()),
    };
    let fake = listed.iter().find(|camera| camera.device.id == "Fake_1");
    let fake = fake.expect("the simulated camera");
    assert_eq!(
        (&*fake.device.vendor, &*fake.device.model),
        ("Aravis", "Fake")
    );
    let abilities = fake.abilities.as_ref().expect("abilities");
    assert_eq!(abilities.sensor_size, [2048, 2048]);
    assert_eq!(abilities.exposure, Some([1e-5, 10.0]));
    assert!(abilities.pixel_formats.iter().any(|name| name == "Mono8"));
    // The simulated camera is listed only on request.
    assert!(
        list(false)
            .unwrap()
            .iter()
            .all(|camera| camera.device.id != "Fake_1")
    );
}

/// A camera on the network of this computer: another process that implements GigE Vision.
struct Peer(Child);

impl Peer {
    /// Starts the camera; `lost` is the packet loss in thousandths. `None`, after printing the reason, if the program
    /// is not installed.
    fn start(lost: &str) -> Option<Self> {
        let (program, package) = PEER;
        let started = Command::new(program)
            .args(["-i", "127.0.0.1", "-s", "FEELER", "-r", lost])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        match started {
            Ok(child) => Some(Self(child)),
            Err(error) => {
                skip::skipped(&format!("{program}: {error} (package {package})"));
                None
            }
        }
    }

    fn kill(&mut self) {
        // The process may have ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Opens the network camera, waiting until its process responds.
fn open_peer(set: impl Fn(&mut CameraSettings)) -> Option<GenicamCamera> {
    for _ in 0..100 {
        match open("127.0.0.1", 60.0, &set)? {
            Ok(camera) => return Some(camera),
            Err(GenicamError::NotFound { .. } | GenicamError::Device { .. }) => {
                sleep(Duration::from_millis(100));
            }
            Err(error) => panic!("{error}"),
        }
    }
    panic!("no camera at 127.0.0.1");
}

/// A single test, because GigE Vision uses a fixed port and tests run in parallel.
#[test]
fn a_network_camera_is_configured_loses_packets_and_disappears() {
    let Some(mut peer) = Peer::start("0") else {
        return;
    };
    let set = |settings: &mut CameraSettings| {
        (settings.exposure, settings.gain) = (Some(0.01), Some(0.0));
        settings.size = (256, 128);
        settings.offset = Some((16, 32));
    };
    let Some(mut camera) = open_peer(set) else {
        return;
    };
    let mut small = Frame::black(256, 128);
    let mut pictures = 0;
    let mut first = None;
    while pictures < 20 {
        match camera.capture(&mut small) {
            Ok(()) => {
                let first = *first.get_or_insert((number(&small), small.sequence));
                let steps = small.sequence - first.1;
                assert_eq!(number(&small), (first.0 + steps) % 255);
                assert!(small.stamp <= camera.opened().elapsed().as_secs_f64());
                pictures += 1;
            }
            // A busy computer also loses packets.
            Err(error) => assert!(error.is_recoverable(), "{error}"),
        }
    }
    // The camera accepts only one controlling application.
    if let Some(second) = open("127.0.0.1", 60.0, set) {
        let error = second.err().expect("an error").to_string();
        assert!(error.contains("another program uses it"), "{error}");
    }
    drop(camera);
    // The camera keeps its settings.
    let listed = list(false).expect("cameras");
    let listed = listed
        .iter()
        .find(|camera| camera.device.serial == "FEELER");
    let abilities = listed.expect("the camera").abilities.as_ref();
    assert_eq!(abilities.expect("abilities").region, [16, 32, 256, 128]);

    // Killing the process has the effect of a pulled cable.
    let Some(mut camera) = open_peer(set) else {
        return;
    };
    while camera.capture(&mut small).is_err() {}
    peer.kill();
    let error = loop {
        if let Err(error) = camera.capture(&mut small)
            && !error.is_recoverable()
        {
            break error;
        }
    };
    assert!(matches!(error, CameraError::Failed(_)), "{error}");
    assert!(error.to_string().contains("does not respond"), "{error}");
    drop(camera);

    // Images with lost packets are reported as unreadable; the others are delivered.
    let Some(_peer) = Peer::start("10") else {
        return;
    };
    let Some(mut camera) = open_peer(|_| {}) else {
        return;
    };
    let mut frame = frame();
    let (mut good, mut bad) = (0, 0);
    while good < 3 || bad < 3 {
        match camera.capture(&mut frame) {
            Ok(()) => good += 1,
            Err(CameraError::Unreadable { name, reason }) => {
                assert!(name.contains("127.0.0.1, frame"), "{name}: {reason}");
                bad += 1;
            }
            Err(error) => panic!("{error}"),
        }
    }
}
