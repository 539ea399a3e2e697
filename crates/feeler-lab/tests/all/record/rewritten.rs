//! Recordings rewritten by other tools read as before.

use super::python;
use crate::support;
use crate::whole_runs::run;
use feeler::sensor::image::{Camera, Frame};
use feeler_lab::experiment::Pictures;
use feeler_record::{
    Image, MessageSink, RecordOptions, RecordedCamera, Recorder, Recording, Tactile, topics,
};
use feeler_report::run::make::RECORDING;
use mcap::read::ChunkFlattener;
use mcap::records::{MessageHeader, Metadata, Record};
use mcap::{Attachment, WriteOptions, Writer};
use std::collections::HashMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Empty folder of this name.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Frame `sequence` of finger 1.
fn frame(sequence: u64) -> Frame {
    let mut frame = Frame::black(4, 3);
    (frame.sequence, frame.stamp) = (sequence, sequence as f64 * support::PERIOD);
    frame.picture.pixels.fill(5 * sequence as u8);
    frame
}

/// Number of images recorded by [`with_pictures`].
const PICTURES: u64 = 40;

/// Writes a recording with images and a calibration to `folder`.
fn with_pictures(folder: &Path) -> PathBuf {
    let path = folder.join("pictures.mcap");
    let options = RecordOptions {
        calibrations: [("a.toml".to_string(), "b = 1".to_string())].into(),
        pictures: true,
        ..RecordOptions::default()
    };
    let facts = support::facts();
    let mut recorder = Recorder::create_with(&path, &facts, support::EXPERIMENT, &options).unwrap();
    let mut image = Image::of_finger(1);
    for sequence in 0..PICTURES {
        let frame = frame(sequence);
        image.fill(&frame).unwrap();
        recorder.write(topics::image(1), &image).unwrap();
        let tactile = Tactile {
            sequence,
            stamp: frame.stamp,
            forces: Vec::new(),
        };
        recorder.write(topics::tactile(1), &tactile).unwrap();
    }
    recorder.finish(Some(0.25)).unwrap();
    path
}

/// Asserts that the recording at `path` equals `original` except for image offsets, and plays back its images.
fn is_the_same(path: &Path, original: &Recording) {
    let recording = Recording::read(path).unwrap();
    let name = path.display();
    assert!(recording.complete, "{name}: {:?}", recording.problem);
    let mut alike = recording.clone();
    for (alike, original) in alike.fingers.iter_mut().zip(&original.fingers) {
        assert_eq!(alike.pictures.len(), original.pictures.len(), "{name}");
        alike.pictures.clone_from(&original.pictures);
    }
    assert_eq!(alike, *original, "{name}");
    if recording.fingers[1].pictures.is_empty() {
        return;
    }
    let mut camera = RecordedCamera::open(path, &recording, 1).unwrap();
    let mut taken = Frame::black(4, 3);
    for sequence in 0..PICTURES {
        camera.capture(&mut taken).unwrap();
        assert_eq!(taken, frame(sequence), "{name}");
    }
}

#[test]
fn recordings_rewritten_by_the_mcap_python_package_are_read() {
    let folder = folder("rewritten-python");
    let settings = ["sensing=direct", "task.screw.strokes=1"].map(String::from);
    run(&settings, Pictures::Sensed, &folder);
    for source in [folder.join(RECORDING), with_pictures(&folder)] {
        let out = source.with_extension("");
        fs::create_dir(&out).unwrap();
        let modules = ["mcap", "zstandard", "lz4"];
        let ways = python::run("rewrite_recording.py", &modules, &[&source, &out]);
        let Some(ways) = ways else { return };
        let original = Recording::read(&source).unwrap();
        for way in ways.as_array().unwrap() {
            let way = way.as_str().unwrap();
            let path = out.join(format!("{way}.mcap"));
            if !["filtered", "recovered"].contains(&way) {
                is_the_same(&path, &original);
                continue;
            }
            let rest = Recording::read(&path).unwrap();
            assert!(!rest.complete, "{way}");
            assert_eq!(rest.facts, original.facts, "{way}");
            assert_eq!(rest.experiment, original.experiment, "{way}");
            let problem = rest.problem.as_deref().unwrap();
            match way {
                "filtered" => {
                    assert!(problem.contains("rewrite_recording.py"), "{problem}");
                    assert_eq!(rest.task, original.task);
                    assert!(rest.cap.is_empty());
                }
                _ => {
                    assert_eq!(problem, "the run was not closed");
                    let (whole, rest) = (&original.fingers[1].tactile, &rest.fingers[1].tactile);
                    assert!(whole.starts_with(rest));
                }
            }
        }
    }
}

/// Copies the recording at `source` with the MCAP project's Rust library, all messages before metadata and attachments.
fn copy(source: &Path, target: &Path, options: WriteOptions) {
    let bytes = fs::read(source).unwrap();
    let file = File::create(target).unwrap();
    let mut writer = Writer::with_options(file, options.profile("ros2").library("a test")).unwrap();
    let (mut schemas, mut channels, mut beside) = (HashMap::new(), HashMap::new(), Vec::new());
    for record in ChunkFlattener::new(&bytes).unwrap() {
        match record.unwrap() {
            Record::Schema { header, data } => {
                let id = writer.add_schema(&header.name, &header.encoding, &data);
                schemas.insert(header.id, id.unwrap());
            }
            Record::Channel(channel) => {
                let schema = schemas[&channel.schema_id];
                let encoding = &channel.message_encoding;
                let id = writer.add_channel(schema, &channel.topic, encoding, &channel.metadata);
                channels.insert(channel.id, id.unwrap());
            }
            Record::Message { header, data } => {
                let channel_id = channels[&header.channel_id];
                let header = MessageHeader {
                    channel_id,
                    ..header
                };
                writer.write_to_known_channel(&header, &data).unwrap();
            }
            record @ (Record::Metadata(_) | Record::Attachment { .. }) => {
                beside.push(record.into_owned())
            }
            _ => {}
        }
    }
    // The run facts last.
    for record in beside.into_iter().rev() {
        write_beside(&mut writer, record);
    }
    writer.finish().unwrap();
}

fn write_beside(writer: &mut Writer<File>, record: Record<'_>) {
    match record {
        Record::Metadata(metadata) => writer.write_metadata(&metadata).unwrap(),
        Record::Attachment { header, data, .. } => {
            let attachment = Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            };
            writer.attach(&attachment).unwrap();
        }
        _ => {}
    }
}

#[test]
fn recordings_rewritten_by_the_mcap_rust_library_are_read() {
    let folder = folder("rewritten-rust");
    let run = folder.join("run.mcap");
    support::write_run(&run, 1).unwrap();
    for source in [run, with_pictures(&folder)] {
        let original = Recording::read(&source).unwrap();
        for (name, options) in [
            (
                "small",
                WriteOptions::new()
                    .compression(None)
                    .chunk_size(Some(3_000)),
            ),
            (
                "one",
                WriteOptions::new().compression(None).chunk_size(None),
            ),
            ("unchunked", WriteOptions::new().use_chunks(false)),
        ] {
            let target = source.with_extension(format!("{name}.mcap"));
            copy(&source, &target, options);
            is_the_same(&target, &original);
        }
    }
}

/// Writes a file with these metadata, of zero or two runs.
fn other(path: &Path, metadata: &[Metadata]) {
    let options = WriteOptions::new()
        .compression(None)
        .library("some recorder");
    let mut writer = Writer::with_options(File::create(path).unwrap(), options).unwrap();
    let schema = writer
        .add_schema("sensor_msgs/msg/JointState", "ros2msg", b"")
        .unwrap();
    let topics = ["/joint_states", "/ft_sensor/wrench"];
    for (time, topic) in topics.into_iter().enumerate() {
        let channel = writer
            .add_channel(schema, topic, "cdr", &Default::default())
            .unwrap();
        let header = MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: time as u64,
            publish_time: 0,
        };
        writer
            .write_to_known_channel(&header, &[0, 1, 0, 0])
            .unwrap();
    }
    for metadata in metadata {
        writer.write_metadata(metadata).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn files_with_no_run_or_two_are_rejected_with_their_content() {
    let folder = folder("rewritten-other");
    let bag = folder.join("bag.mcap");
    other(&bag, &[]);
    let error = Recording::read(&bag).unwrap_err().to_string();
    for words in [
        "expected a run of feeler",
        "some recorder",
        "/joint_states (sensor_msgs/msg/JointState, 1 messages)",
        "/ft_sensor/wrench",
    ] {
        assert!(error.contains(words), "{error}");
    }
    let runs = ["1", "2"].map(|seed| Metadata {
        name: "feeler.run".into(),
        metadata: [("seed".to_string(), seed.to_string())].into(),
    });
    other(&bag, &runs);
    let error = Recording::read(&bag).unwrap_err().to_string();
    assert!(error.contains("got 2 merged by"), "{error}");
}
