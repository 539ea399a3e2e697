//! A recording round-trips, and a damaged one reports its readable part.

use crate::support;
use feeler_record::wire::Vector3;
use feeler_record::{Image, MessageSink, Phase, RecordError, Recorder, Recording, Tactile, topics};
use proptest::prelude::*;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;

/// Creates an empty directory for a test.
fn directory(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("the test's directory");
    path
}

/// Bytes of a short run's recording.
fn short_run() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let path = directory("short-run").join("recording.mcap");
        support::write_run(&path, 1).expect("a recording");
        std::fs::read(path).expect("its bytes")
    })
}

#[test]
fn a_recording_reads_back_as_written() {
    let path = directory("round-trip").join("recording.mcap");
    let digest = support::write_run(&path, 4).unwrap();
    let recording = Recording::read(&path).unwrap();
    assert_eq!(recording.problem, None);
    assert!(recording.complete);
    assert_eq!(recording.digest, digest);
    assert_eq!(recording.facts, support::facts());
    assert_eq!(recording.experiment, support::EXPERIMENT);
    assert_eq!(recording.wall_time, Some(0.25));
    assert_eq!(recording.fingers.len(), 2);
    let steps = recording.task.len();
    assert_eq!(steps, 4 * 300 + 20);
    for finger in &recording.fingers {
        assert_eq!(finger.tactile.len(), steps);
        assert_eq!(finger.flags.len(), steps);
        assert_eq!(finger.joints.len(), steps);
        assert_eq!(finger.command.len(), steps);
        assert_eq!(finger.fingertip.len(), steps);
    }
    assert_eq!(recording.torque_sensor.len(), steps);
    assert_eq!(recording.cap.len(), steps);
    assert_eq!(recording.task[100].phase, Phase::Move);
    assert_eq!(recording.task[100].reason, "Move");
    assert_eq!(
        recording.fingers[1].flags[150].shear_rate.len(),
        support::ELEMENTS
    );
    let velocity = recording.fingers[1].joints[95].velocity;
    assert_eq!(velocity.as_slice(), [0.0, 0.1, -0.1]);
}

#[test]
fn the_digest_depends_on_content_and_not_on_wall_time() {
    let directory = directory("digest");
    let run = |name: &str, experiment: &str, wall_time, force| {
        let path = directory.join(name);
        let mut recorder = Recorder::create(path, &support::facts(), experiment).unwrap();
        let z = force;
        let forces = vec![Vector3 {
            z,
            ..Vector3::default()
        }];
        let frame = Tactile {
            forces,
            ..Tactile::default()
        };
        recorder.write(topics::tactile(0), &frame).unwrap();
        recorder.finish(wall_time).unwrap()
    };
    let reference = run("a", "x = 1", Some(1.0), 0.5);
    assert_eq!(reference.as_str().len(), 64);
    assert_eq!(reference, run("b", "x = 1", Some(2.0), 0.5));
    assert_eq!(reference, run("c", "x = 1", None, 0.5));
    assert_ne!(reference, run("d", "x = 2", Some(1.0), 0.5));
    assert_ne!(reference, run("e", "x = 1", Some(1.0), 0.6));
}

#[test]
fn invalid_data_are_rejected_with_the_expected_values() {
    let directory = directory("refused");
    let mut facts = support::facts();
    facts.approach[1] = [2.0, 0.0, 0.0];
    let error = Recorder::create(directory.join("a"), &facts, "")
        .err()
        .unwrap();
    assert!(
        error
            .to_string()
            .contains("approach: expected unit vectors"),
        "{error}"
    );
    facts = support::facts();
    facts.slip_threshold = f64::NAN;
    assert!(matches!(
        Recorder::create(directory.join("b"), &facts, ""),
        Err(RecordError::Facts {
            field: "slip_threshold",
            ..
        })
    ));
    facts = support::facts();
    facts.control_period = 1e-9;
    let error = Recorder::create(directory.join("b"), &facts, "")
        .err()
        .unwrap();
    assert!(
        error
            .to_string()
            .contains("control_period: expected 0.0001 to 1 s"),
        "{error}"
    );
    let missing = directory.join("missing").join("c");
    let error = Recorder::create(missing, &support::facts(), "")
        .err()
        .unwrap();
    assert!(error.to_string().contains("missing"), "{error}");
    let path = directory.join("d");
    let mut recorder = Recorder::create(path, &support::facts(), "").unwrap();
    let error = recorder
        .write(topics::tactile(2), &Tactile::default())
        .unwrap_err();
    assert!(error.to_string().contains("finger 2"), "{error}");
    let stamp = f64::NAN;
    let error = recorder.write(
        topics::tactile(0),
        &Tactile {
            stamp,
            ..Tactile::default()
        },
    );
    assert!(matches!(error, Err(RecordError::Stamp { .. })));
    let error = recorder.write(topics::image(0), &Image::of_finger(0));
    let error = error.unwrap_err().to_string();
    assert!(error.contains("/finger/0/image"), "{error}");
}

#[test]
fn an_interrupted_run_is_readable_up_to_its_last_chunk() {
    let path = directory("interrupted").join("recording.mcap");
    let mut recorder = Recorder::create(&path, &support::facts(), support::EXPERIMENT).unwrap();
    support::write_strokes(&mut recorder, 4).unwrap();
    // As after a kill: the file has not been closed.
    let bytes = std::fs::read(&path).unwrap();
    let killed = Recording::from_bytes(&bytes).unwrap();
    drop(recorder);
    let dropped = Recording::read(&path).unwrap();
    assert!(!killed.complete && !dropped.complete);
    assert!(dropped.problem.unwrap().contains("not closed"));
    assert_eq!(dropped.task.len(), 4 * 300 + 20);
    // 12.2 s were written in chunks of about 1 s: at most 8 are queued, one is being written and one being filled.
    assert!(killed.readable_until > 2.0, "{}", killed.readable_until);
    assert_eq!(killed.task[..], dropped.task[..killed.task.len()]);
}

/// The device can be opened but rejects every write.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let error = Recorder::create("/dev/full", &support::facts(), "")
        .err()
        .unwrap();
    assert!(error.to_string().contains("/dev/full"), "{error}");
}

#[test]
fn files_that_are_not_recordings_are_rejected_with_a_reason() {
    for bytes in [&b""[..], b"hello", &[0x89; 100_000]] {
        let reason = Recording::from_bytes(bytes).unwrap_err();
        assert!(reason.contains("MCAP magic"), "{reason}");
    }
    let reason = Recording::from_bytes(&short_run()[..60]).unwrap_err();
    assert!(reason.contains("ends"), "{reason}");
    let path = directory("nothing").join("recording.mcap");
    let error = Recording::read(path).unwrap_err();
    assert!(matches!(error, RecordError::File { .. }), "{error}");
}

/// A record whose length exceeds memory.
#[test]
fn excessive_record_lengths_are_rejected() {
    for opcode in [0x01u8, 0x06, 0x09, 0x0c, 0x0f] {
        let start = 8 + 9 + 4;
        let mut bytes = short_run()[..start].to_vec();
        bytes.truncate(8);
        bytes.push(opcode);
        bytes.extend_from_slice(&(u64::MAX - 3).to_le_bytes());
        bytes.extend_from_slice(&[0xff; 64]);
        assert!(Recording::from_bytes(&bytes).is_err());
    }
}

/// An attachment truncated anywhere before its checksum.
#[test]
fn a_truncated_attachment_header_is_rejected() {
    // Two times, the lengths of two empty texts and of empty data, and the checksum.
    const WHOLE: usize = 16 + 4 + 4 + 8 + 4;
    let start = short_run()[..8].to_vec();
    for length in 0..WHOLE {
        let mut bytes = start.clone();
        bytes.push(0x09);
        bytes.extend_from_slice(&(length as u64).to_le_bytes());
        bytes.extend(std::iter::repeat_n(0, length));
        let reason = Recording::from_bytes(&bytes).unwrap_err();
        assert!(reason.contains("too short"), "{length} bytes: {reason}");
    }
}

/// A chunk without checksum, followed by bytes within the claimed length of its only record.
#[test]
fn a_record_longer_than_its_chunk_is_rejected() {
    let mut chunk = vec![0; 32]; // two times, size, checksum, length of the compression's name
    chunk.extend_from_slice(&9u64.to_le_bytes());
    chunk.push(0x80);
    chunk.extend_from_slice(&4u64.to_le_bytes());
    chunk.extend_from_slice(&[0; 4]);
    let mut bytes = short_run()[..8].to_vec();
    bytes.push(0x06);
    bytes.extend_from_slice(&(chunk.len() as u64).to_le_bytes());
    bytes.extend(chunk);
    let reason = Recording::from_bytes(&bytes).unwrap_err();
    assert!(reason.contains("ends within a record"), "{reason}");
}

/// Byte ranges of the data of a file's chunks.
fn chunks(file: &[u8]) -> Vec<Range<usize>> {
    let (mut chunks, mut at) = (Vec::new(), 8);
    loop {
        let length = u64::from_le_bytes(file[at + 1..at + 9].try_into().unwrap()) as usize;
        let (opcode, body) = (file[at], at + 9..at + 9 + length);
        at = body.end;
        match opcode {
            0x06 => chunks.push(body.start + 40..body.end),
            0x0f => return chunks,
            _ => {}
        }
    }
}

/// The first chunk contains only channels.
#[test]
fn chunks_after_a_damaged_one_are_read() {
    let path = directory("damaged").join("recording.mcap");
    support::write_run(&path, 2).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let whole = Recording::from_bytes(&bytes).unwrap();
    let chunks = chunks(&bytes);
    assert!(chunks.len() > 4, "{}", chunks.len());
    for (number, chunk) in chunks.iter().enumerate() {
        let mut damaged = bytes.clone();
        damaged[(chunk.start + chunk.end) / 2] ^= 0x20;
        let rest = Recording::from_bytes(&damaged).unwrap();
        let problem = rest.problem.as_ref().unwrap();
        assert!(problem.contains("checksum"), "{problem}");
        assert!(!rest.complete);
        let before = rest.leading_complete_steps();
        let missing = whole.task.len() - rest.task.len();
        assert_eq!(missing > 0, number > 0, "chunk {number}");
        assert_eq!(rest.task[..before], whole.task[..before]);
        assert_eq!(rest.task[before..], whole.task[before + missing..]);
        for (rest, whole) in rest.fingers.iter().zip(&whole.fingers) {
            assert_eq!(rest.tactile[before..], whole.tactile[before + missing..]);
            assert_eq!(rest.fingertip[..before], whole.fingertip[..before]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn a_truncated_recording_is_incomplete_and_contains_the_beginning(share in 0.0..1.0f64) {
        let whole = Recording::from_bytes(short_run()).unwrap();
        let length = (share * short_run().len() as f64) as usize;
        match Recording::from_bytes(&short_run()[..length]) {
            // No data follow the end of the data section.
            Ok(cut) if cut.complete => prop_assert_eq!(cut.digest, whole.digest),
            Ok(cut) => {
                prop_assert!(cut.problem.is_some());
                prop_assert!(cut.readable_until <= whole.readable_until);
                prop_assert_eq!(&cut.task[..], &whole.task[..cut.task.len()]);
            }
            Err(reason) => prop_assert!(!reason.is_empty()),
        }
    }

    #[test]
    fn a_flipped_bit_is_detected_or_harmless(place in 0.0..1.0f64, bit in 0..8u32) {
        let mut bytes = short_run().to_vec();
        let place = (place * bytes.len() as f64) as usize;
        bytes[place] ^= 1 << bit;
        if let Ok(recording) = Recording::from_bytes(&bytes) && recording.complete {
            // The digest excludes wall time and the container's bookkeeping.
            prop_assert_eq!(recording.digest, Recording::from_bytes(short_run()).unwrap().digest);
        }
    }

    #[test]
    fn random_bytes_after_a_valid_start_do_not_panic(
        share in 0.0..1.0f64,
        noise in prop::collection::vec(any::<u8>(), 0..400),
    ) {
        let start = (share * 3000.0) as usize;
        let mut bytes = short_run()[..start.min(short_run().len())].to_vec();
        bytes.extend(noise);
        if let Ok(recording) = Recording::from_bytes(&bytes) {
            prop_assert!(!recording.complete);
        }
    }
}
