//! What each fuzz target does with its bytes: reads them and, if they are sound, uses what was read.
//!
//! Shared by the targets and by `tests/fuzz_corpus.rs`, so that every test run goes through the
//! corpora. A target says whether its bytes were sound.

use feeler::config::Experiment;
use feeler::hand::hand::{Hand, HandState};
use feeler::record::{RecordedCamera, RecordedHand, RecordedSensor, Recording};
use feeler::sensor::calibration::Calibration;
use feeler::sensor::camera::{Camera, CameraError};
use feeler::sensor::frame::Frame;
use feeler::sensor::loads::read_loads;
use feeler::sensor::located_layout::LocatedLayout;
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::reading::{SensorError, TactileFrame, TactileSensor};
use feeler::sources::picture::decode_picture;
use glam::DVec2;
use std::io::Cursor;
use std::str::from_utf8;

/// Most pixels of a layout whose sub-regions are laid out: larger ones only take time.
const MAX_PIXELS: usize = 1 << 16;

/// A sound layout reads back as it was written, and its kernel is made or refused.
pub fn layout(bytes: &[u8]) -> bool {
    let Some(layout) = text(bytes).and_then(|text| LocatedLayout::from_toml(text).ok()) else {
        return false;
    };
    let written = layout
        .to_toml()
        .expect("a layout that was read can be written");
    let again = LocatedLayout::from_toml(&written).expect("what was written can be read");
    assert_eq!(layout, again);
    if layout.width * layout.height <= MAX_PIXELS && layout.elements.len() <= 64 {
        let _ = layout.kernel();
    }
    true
}

/// A sound calibration reads back as it was written and gives finite forces for finite moments.
pub fn calibration(bytes: &[u8]) -> bool {
    let Some(calibration) = text(bytes).and_then(|text| Calibration::from_toml(text).ok()) else {
        return false;
    };
    let written = calibration
        .to_toml()
        .expect("a calibration that was read can be written");
    let again = Calibration::from_toml(&written).expect("what was written can be read");
    assert_eq!(calibration, again);
    for element in &calibration.elements {
        for factor in [0.0, 0.5, 1.0, 1.5, 10.0] {
            for offset in [-1e-3, 0.0, 1e-3] {
                let moments = ElementMoments {
                    integrated_gray: element.unloaded_gray * factor,
                    centroid: element.unloaded_centroid + DVec2::new(offset, -offset),
                };
                let force = element.force(&moments);
                assert!(force.is_finite(), "{moments:?}: {force}");
                let _ = element.validity(&moments);
            }
        }
    }
    true
}

/// Sound loads are finite, on as many elements as there are.
pub fn loads(bytes: &[u8]) -> bool {
    const ELEMENTS: usize = 3;
    let Ok(pictures) = read_loads(bytes, ELEMENTS) else {
        return false;
    };
    for picture in &pictures {
        assert_eq!(picture.forces.len(), ELEMENTS);
        assert!(
            picture
                .forces
                .iter()
                .flatten()
                .all(|force| force.is_finite())
        );
    }
    true
}

/// A sound picture has as many pixels as it says.
pub fn picture(bytes: &[u8]) -> bool {
    let Ok(picture) = decode_picture(bytes) else {
        return false;
    };
    assert_eq!(picture.pixels.len(), picture.width * picture.height);
    true
}

/// A sound experiment keeps its values when its text is read again.
pub fn experiment(bytes: &[u8]) -> bool {
    let read = |text: &str| Experiment::parse(text, "fuzz", &[], None).ok();
    let Some(experiment) = text(bytes).and_then(read) else {
        return false;
    };
    let again = read(&experiment.toml).expect("the text of an experiment can be read");
    assert_eq!(experiment.config, again.config);
    true
}

/// A recording is complete exactly when nothing is wrong with it, and plays back to its end.
pub fn recording(bytes: &[u8]) -> bool {
    let Ok(recording) = Recording::from_bytes(bytes) else {
        return false;
    };
    assert_eq!(recording.complete, recording.problem.is_none());
    assert_eq!(recording.fingers.len(), recording.facts.fingers);
    assert!(recording.readable_until.is_finite());
    play_back(&recording);
    look_again(&recording, bytes);
    true
}

/// Cameras give as many pictures as were seen, or say which is not there.
fn look_again(recording: &Recording, bytes: &[u8]) {
    for (finger, recorded) in recording.fingers.iter().enumerate() {
        let mut camera = RecordedCamera::new(Cursor::new(bytes), recording, finger);
        let mut frame = Frame::black(4, 3);
        let mut seen = 0;
        let end = loop {
            match camera.capture(&mut frame) {
                Ok(()) => seen += 1,
                Err(end) => break end,
            }
        };
        if let CameraError::Ended { count } = end {
            assert_eq!((count, seen), (seen, recorded.tactile.len() as u64));
        }
    }
}

/// Sensors and hand give as many readings as were recorded, or say what does not fit.
fn play_back(recording: &Recording) {
    for (finger, recorded) in recording.fingers.iter().enumerate() {
        let mut sensor = RecordedSensor::new(recording, finger);
        let mut reading = TactileFrame::unloaded(sensor.element_count());
        let mut read = 0;
        let end = loop {
            match sensor.read(&mut reading) {
                Ok(()) => read += 1,
                Err(end) => break end,
            }
        };
        match end {
            SensorError::Ended { count } => {
                assert_eq!((count, read), (read, recorded.tactile.len() as u64));
            }
            // Frames of different lengths.
            SensorError::ElementCount { expected, actual } => assert_ne!(expected, actual),
            other => panic!("a recording has neither camera nor picture: {other}"),
        }
    }
    let mut hand = RecordedHand::new(recording);
    let mut state = HandState::zero(hand.finger_count());
    let shortest = recording.fingers.iter().map(|f| f.joints.len()).min();
    for _ in 0..shortest.unwrap_or(0) {
        hand.read(&mut state).expect("a state of every finger");
    }
    let end = hand.read(&mut state);
    assert!(recording.fingers.is_empty() || end.is_err(), "{state:?}");
}

fn text(bytes: &[u8]) -> Option<&str> {
    from_utf8(bytes).ok()
}
