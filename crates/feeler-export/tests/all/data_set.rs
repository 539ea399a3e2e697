//! LeRobot data sets: accepted runs and written files.

use crate::support::{MadeUp, PERIOD, force, path, recording, recording_file};
use feeler_export::ExportError;
use feeler_export::lerobot::{DataSet, FileSizes, Run, Watch};
use feeler_record::{Felt, Recording};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

fn folder(name: &str) -> PathBuf {
    let folder = path(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir(&folder).unwrap();
    folder
}

/// Adds a recording without images.
fn add(set: &mut DataSet, name: &str, recording: &Recording) -> Result<usize, ExportError> {
    add_file(set, name, recording, Path::new(""))
}

fn add_file(
    set: &mut DataSet,
    name: &str,
    recording: &Recording,
    path: &Path,
) -> Result<usize, ExportError> {
    let run = Run {
        name,
        task: "turn it",
        recording,
        path,
    };
    let watch = Watch {
        interrupted: &AtomicBool::new(false),
        picture_done: &|| {},
    };
    set.add(&run, watch)
}

fn json_of(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn each_run_is_an_episode() {
    let folder = folder("episodes");
    let mut set = DataSet::new(&folder);
    let runs = [(20, 0), (8, 3)].map(|(steps, felt_from)| {
        recording(&MadeUp {
            steps,
            felt_from,
            ..MadeUp::default()
        })
    });
    // Steps before the first readings of all fingers are left out.
    assert_eq!(add(&mut set, "first", &runs[0]).unwrap(), 20);
    assert_eq!(add(&mut set, "second", &runs[1]).unwrap(), 5);
    assert!(
        !folder.join("meta").exists(),
        "meta was written before finish"
    );
    set.finish().unwrap();
    let info = json_of(&folder.join("meta/info.json"));
    assert_eq!(info["codebase_version"], "v3.0");
    assert_eq!(
        (&info["fps"], &info["total_frames"]),
        (&json!(100), &json!(25))
    );
    assert_eq!(info["splits"], json!({ "train": "0:2" }));
    let force_feature = &info["features"]["observation.tactile.finger_0.force"];
    assert_eq!(force_feature["shape"], json!([3, 3]));
    assert_eq!(force_feature["units"], "N");
    let stats = json_of(&folder.join("meta/stats.json"));
    let of_force = &stats["observation.tactile.finger_0.force"];
    assert_eq!(of_force["count"], json!([25]));
    let largest = [force(19, 0, 2).x, force(3, 0, 0).y, force(0, 0, 0).z];
    for (axis, expected) in largest.into_iter().enumerate() {
        let extreme = if axis == 1 { 0.0 } else { expected };
        assert_eq!(
            of_force["max"][axis],
            json!(f64::from(extreme as f32)),
            "{axis}"
        );
    }
    // Each episode is one row group.
    let data = File::open(folder.join("data/chunk-000/file-000.parquet")).unwrap();
    let data = SerializedFileReader::new(data).unwrap();
    let rows: Vec<_> = data
        .metadata()
        .row_groups()
        .iter()
        .map(|group| group.num_rows())
        .collect();
    assert_eq!(rows, [20, 5]);
}

#[test]
fn rumble_and_tone_are_a_feature_if_recorded() {
    let mut felt = recording(&MadeUp::default());
    felt.felt = vec![
        Felt::SILENT,
        Felt {
            stamp: 5.5 * PERIOD,
            data_stamp: 5.0 * PERIOD,
            rumble_strong: 0.5,
            rumble_weak: 0.25,
            tone_frequency: 440.0,
            tone_gain: 0.125,
        },
        Felt {
            stamp: 10.5 * PERIOD,
            ..Felt::SILENT
        },
    ];
    let folder = folder("felt");
    let mut set = DataSet::new(&folder);
    assert_eq!(add(&mut set, "felt", &felt).unwrap(), 20);
    let unfelt = add(&mut set, "unfelt", &recording(&MadeUp::default())).unwrap_err();
    assert!(unfelt.to_string().contains("operator.felt"), "{unfelt}");
    set.finish().unwrap();
    let info = json_of(&folder.join("meta/info.json"));
    let feature = &info["features"]["operator.felt"];
    assert_eq!(feature["shape"], json!([4]));
    assert_eq!(feature["names"][3], "tone_gain");
    let stats = json_of(&folder.join("meta/stats.json"));
    let stats = &stats["operator.felt"];
    assert_eq!(stats["max"], json!([0.5, 0.25, 440.0, 0.125]));
    // Five of 20 frames: those at the steps 6 to 10.
    assert_eq!(stats["mean"], json!([0.125, 0.0625, 110.0, 0.03125]));
}

#[test]
fn unsuitable_runs_are_rejected_with_a_reason() {
    let folder = folder("refused");
    let mut set = DataSet::new(&folder);
    add(&mut set, "first", &recording(&MadeUp::default())).unwrap();
    let mut refused = |recording: Recording, words: &[&str]| {
        let error = add(&mut set, "other", &recording).unwrap_err().to_string();
        let always = ["other: ", ": expected ", ", got "];
        for word in always.iter().chain(words) {
            assert!(error.contains(word), "no {word:?} in {error:?}");
        }
    };
    let made_up = |change: fn(&mut MadeUp)| {
        let mut made_up = MadeUp::default();
        change(&mut made_up);
        recording(&made_up)
    };
    refused(
        made_up(|m| m.period = 0.02),
        &["rate", "100 control steps", "50 control"],
    );
    refused(
        made_up(|m| m.period = 0.003),
        &["a whole number of control steps", "333.33"],
    );
    refused(made_up(|m| m.fingers = 2), &["features", "finger_1"]);
    refused(
        made_up(|m| m.elements = 4),
        &["finger_0.force", "shape [3,3]", "shape [4,3]"],
    );
    refused(
        made_up(|m| m.elements = 0),
        &["finger_0.force", "0 at 0.01 s"],
    );
    refused(
        made_up(|m| m.steps = 0),
        &["a reading of every finger", "0 steps"],
    );
    refused(
        made_up(|m| m.felt_from = 20),
        &["a reading of every finger", "20 steps"],
    );
    let mut gap = recording(&MadeUp::default());
    gap.task.drain(7..9);
    refused(
        gap,
        &["one every 0.01 s", "one at 0.07 s, the next at 0.1 s"],
    );
    let mut unknown = recording(&MadeUp::default());
    unknown.fingers[0].tactile[4].forces[1].y = f64::NAN;
    refused(unknown, &["finger_0.force", "known numbers", "at 0.05 s"]);
    let mut torn = recording(&MadeUp::default());
    torn.fingers[0].tactile[4].forces.pop();
    refused(torn, &["9 numbers", "6 at 0.05 s"]);
    let mut cut = recording(&MadeUp::default());
    cut.problem = Some("the run was not closed".into());
    refused(cut, &["a complete recording", "the run was not closed"]);
}

#[test]
fn images_of_at_least_16_pixels_are_written() {
    for size in [(16, 16), (17, 31), (33, 65)] {
        let (columns, rows) = size;
        let folder = folder(&format!("pictures-{columns}x{rows}"));
        let made_up = MadeUp {
            steps: 3,
            pictures: Some(size),
            ..MadeUp::default()
        };
        let file = path(&format!("{columns}x{rows}.mcap"));
        recording_file(&made_up, &file);
        let recording = Recording::read(&file).unwrap();
        let mut set = DataSet::new(&folder);
        assert_eq!(add_file(&mut set, "seen", &recording, &file).unwrap(), 3);
        set.finish().unwrap();
        let info = json_of(&folder.join("meta/info.json"));
        let pictures = &info["features"]["observation.images.finger_0"];
        assert_eq!(pictures["shape"], json!([rows, columns, 3]));
        let video = folder.join("videos/observation.images.finger_0/chunk-000/file-000.mp4");
        assert!(fs::metadata(video).unwrap().len() > 500);
    }
}

#[test]
fn a_full_file_is_followed_by_another() {
    let folder = folder("full-files");
    let made_up = MadeUp {
        steps: 3,
        pictures: Some((16, 16)),
        ..MadeUp::default()
    };
    let file = path("full-files.mcap");
    recording_file(&made_up, &file);
    let recording = Recording::read(&file).unwrap();
    // With a limit of zero, a file is full after one episode.
    let sizes = FileSizes { data: 0, videos: 0 };
    let mut set = DataSet::new(&folder).with_file_sizes(sizes);
    for name in ["first", "second", "third"] {
        add_file(&mut set, name, &recording, &file).unwrap();
    }
    set.finish().unwrap();
    let parquet =
        |name: &str| SerializedFileReader::new(File::open(folder.join(name)).unwrap()).unwrap();
    let episodes = parquet("meta/episodes/chunk-000/file-000.parquet");
    for (index, row) in episodes.get_row_iter(None).unwrap().enumerate() {
        let row = row.unwrap().into_columns();
        let cell = |name: String| {
            row.iter()
                .find(|(own, _)| *own == name)
                .map(|(_, cell)| cell)
        };
        for of in ["data", "videos/observation.images.finger_0"] {
            assert_eq!(
                cell(format!("{of}/file_index")),
                Some(&Field::Long(index as i64))
            );
        }
        // Each episode starts a new file.
        let from = "videos/observation.images.finger_0/from_timestamp";
        assert_eq!(cell(from.into()), Some(&Field::Double(0.0)));
        let data = parquet(&format!("data/chunk-000/file-{index:03}.parquet"));
        assert_eq!(data.metadata().file_metadata().num_rows(), 3);
        let video = format!("videos/observation.images.finger_0/chunk-000/file-{index:03}.mp4");
        assert!(fs::metadata(folder.join(video)).unwrap().len() > 500);
    }
    assert_eq!(episodes.metadata().file_metadata().num_rows(), 3);
    let info = json_of(&folder.join("meta/info.json"));
    assert_eq!(info["data_files_size_in_mb"], json!(0));
}

#[test]
fn unsuitable_images_are_rejected_with_a_reason() {
    let folder = folder("refused-pictures");
    let seen = |name: &str, size| {
        let made_up = MadeUp {
            steps: 3,
            pictures: size,
            ..MadeUp::default()
        };
        let file = path(name);
        recording_file(&made_up, &file);
        (Recording::read(&file).unwrap(), file)
    };
    let mut set = DataSet::new(&folder);
    let (first, file) = seen("first.mcap", Some((32, 16)));
    add_file(&mut set, "first", &first, &file).unwrap();
    let mut refused = |(recording, file): (Recording, PathBuf), words: &[&str]| {
        let error = add_file(&mut set, "other", &recording, &file).unwrap_err();
        let error = error.to_string();
        for word in words {
            assert!(error.contains(word), "no {word:?} in {error:?}");
        }
    };
    let larger = seen("larger.mcap", Some((32, 17)));
    refused(
        larger,
        &["images.finger_0", "shape [16,32,3]", "shape [17,32,3]"],
    );
    refused(seen("blind.mcap", None), &["features", "images.finger_0"]);
    // The images are in another file.
    let (elsewhere, _) = seen("elsewhere.mcap", Some((32, 16)));
    refused((elsewhere.clone(), path("nothing.mcap")), &["nothing.mcap"]);
    let (mut lost, file) = seen("lost.mcap", Some((32, 16)));
    lost.fingers[0].pictures.remove(1);
    refused(
        (lost, file),
        &["other: no image: expected the recorded image at 0.02 s"],
    );
    fs::write(path("torn.mcap"), [0; 100]).unwrap();
    refused((elsewhere, path("torn.mcap")), &["other: no image"]);
    // Below the encoder's minimum width of 16 px.
    let (tiny, file) = seen("tiny.mcap", Some((9, 1)));
    let error = add_file(&mut DataSet::new(&folder), "tiny", &tiny, &file).unwrap_err();
    let words = "tiny: observation.images.finger_0: invalid width 9 (expected >= 16";
    assert!(error.to_string().starts_with(words), "{error}");
}
