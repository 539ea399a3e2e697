//! Playback of recorded images by a camera.

use crate::support;
use feeler::sensor::image::{Camera, CameraError, Frame};
use feeler_record::{
    Image, MessageSink, RecordOptions, RecordedCamera, Recorder, Recording, Tactile, topics,
};
use proptest::prelude::*;
use std::fs::{self, File};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::OnceLock;

/// A stamp that is not a whole number of nanoseconds.
const STAMP: f64 = 0.1 + 0.2;

/// Frames of finger 1's camera at four steps: sequence number and stamp (s).
const SEEN: [(u64, f64); 4] = [(3, 0.0), (3, 0.0), (5, STAMP), (6, 0.31)];

fn frame(sequence: u64, stamp: f64) -> Frame {
    let mut frame = Frame::black(4, 3);
    (frame.sequence, frame.stamp) = (sequence, stamp);
    frame.picture.pixels.fill(10 * sequence as u8);
    frame
}

/// Records the frames of [`SEEN`] with only the first `count` images, for the test called `name`.
fn record(name: &str, count: usize) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("camera-{name}.mcap"));
    let options = RecordOptions {
        pictures: true,
        ..RecordOptions::default()
    };
    let facts = support::facts();
    let mut recorder = Recorder::create_with(&path, &facts, support::EXPERIMENT, &options).unwrap();
    let mut image = Image::of_finger(1);
    let mut written = Vec::new();
    for (sequence, stamp) in SEEN {
        if !written.contains(&sequence) && written.len() < count {
            written.push(sequence);
            image.fill(&frame(sequence, stamp)).unwrap();
            recorder.write(topics::image(1), &image).unwrap();
        }
        let tactile = Tactile {
            sequence,
            stamp,
            forces: Vec::new(),
        };
        recorder.write(topics::tactile(1), &tactile).unwrap();
    }
    recorder.finish(None).unwrap();
    path
}

#[test]
fn every_step_gets_its_recorded_image() {
    let path = record("all", 3);
    let recording = Recording::read(&path).unwrap();
    assert!(recording.complete, "{:?}", recording.problem);
    let mut camera = RecordedCamera::open(&path, &recording, 1).unwrap();
    let mut taken = Frame::black(4, 3);
    for (sequence, stamp) in SEEN {
        camera.capture(&mut taken).unwrap();
        assert_eq!(taken, frame(sequence, stamp));
        assert_eq!(taken.stamp.to_bits(), stamp.to_bits());
    }
    let end = camera.capture(&mut taken);
    assert!(matches!(end, Err(CameraError::Ended { count: 4 })));
    // The other finger has no images.
    let mut camera = RecordedCamera::open(&path, &recording, 0).unwrap();
    let end = camera.capture(&mut taken);
    assert!(matches!(end, Err(CameraError::Ended { count: 0 })));
}

#[test]
fn a_missing_image_is_named() {
    let path = record("missing", 1);
    let recording = Recording::read(&path).unwrap();
    let capture = |recording: &Recording, size: (usize, usize)| {
        let mut camera = RecordedCamera::open(&path, recording, 1).unwrap();
        let mut frame = Frame::black(size.0, size.1);
        (0..4).find_map(|_| camera.capture(&mut frame).err())
    };
    let error = capture(&recording, (4, 3)).unwrap().to_string();
    assert!(
        error.contains("0.3") && error.contains("found no more images"),
        "{error}"
    );
    let mut other = recording.clone();
    other.fingers[1].tactile.remove(0);
    other.fingers[1].tactile.remove(0);
    let error = capture(&other, (4, 3)).unwrap().to_string();
    assert!(error.contains("found the image at 0 ns"), "{error}");
    let error = capture(&recording, (3, 4)).unwrap();
    assert!(matches!(error, CameraError::FrameSize { .. }), "{error}");
}

/// The file differs from the one that the recording was read from.
#[test]
fn a_file_that_has_changed_is_rejected() {
    let path = record("changed", 3);
    let recording = Recording::read(&path).unwrap();
    let length = fs::metadata(&path).unwrap().len();
    let at = recording.fingers[1].pictures[0];
    for (name, bytes) in [
        ("short", vec![0; 100]),
        ("zero", vec![0; length as usize]),
        (
            "cut",
            fs::read(&path).unwrap()[..at.offset as usize + 20].to_vec(),
        ),
    ] {
        let other = path.with_extension(name);
        fs::write(&other, bytes).unwrap();
        let file = File::open(&other).unwrap();
        let mut camera = RecordedCamera::new(file, &recording, 1);
        let error = camera.capture(&mut Frame::black(4, 3)).unwrap_err();
        assert!(matches!(error, CameraError::Failed(_)), "{name}: {error}");
    }
}

/// Bytes of a recording with images.
fn bytes() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| fs::read(record("property", 3)).expect("a recording"))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    /// Checksums of chunks detect the flipped bit; an image that is read is unchanged.
    #[test]
    fn a_flipped_bit_never_gives_a_different_image(place in 0..bytes().len(), bit in 0..8u32) {
        let mut flipped = bytes().to_vec();
        flipped[place] ^= 1 << bit;
        let Ok(recording) = Recording::from_bytes(&flipped) else {
            return Ok(());
        };
        let mut camera = RecordedCamera::new(Cursor::new(&flipped), &recording, 1);
        let mut taken = Frame::black(4, 3);
        for (sequence, stamp) in SEEN {
            if camera.capture(&mut taken).is_err() {
                break;
            }
            prop_assert_eq!(&taken, &frame(sequence, stamp));
        }
    }
}
