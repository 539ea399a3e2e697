//! Data sets of LeRobot: what runs fit together, and what LeRobot would read.

mod support;

use feeler_export::ExportError;
use feeler_export::lerobot::{DataSet, Run};
use feeler_record::Recording;
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::{Value, json};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use support::{MadeUp, force, path, recording};

fn folder(name: &str) -> PathBuf {
    let folder = path(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir(&folder).unwrap();
    folder
}

fn add(set: &mut DataSet, name: &str, recording: &Recording) -> Result<usize, ExportError> {
    set.add(&Run {
        name,
        task: "turn it",
        recording,
    })
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
    // What comes before every finger was felt is no frame.
    assert_eq!(add(&mut set, "first", &runs[0]).unwrap(), 20);
    assert_eq!(add(&mut set, "second", &runs[1]).unwrap(), 5);
    assert!(!folder.join("meta").exists(), "it is not finished");
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
    // An episode is a group of rows.
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
fn runs_that_do_not_fit_are_refused_in_words() {
    let folder = folder("refused");
    let mut set = DataSet::new(&folder);
    add(&mut set, "first", &recording(&MadeUp::default())).unwrap();
    let mut refused = |recording: Recording, words: &[&str]| {
        let error = add(&mut set, "other", &recording).unwrap_err().to_string();
        let always = ["other: ", " expected, ", " found"];
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
    refused(made_up(|m| m.steps = 0), &["every finger felt", "0 steps"]);
    refused(
        made_up(|m| m.felt_from = 20),
        &["every finger felt", "20 steps"],
    );
    let mut gap = recording(&MadeUp::default());
    gap.task.drain(7..9);
    refused(
        gap,
        &["one every 0.01 s", "one at 0.07 s, the next at 0.1 s"],
    );
    let mut unknown = recording(&MadeUp::default());
    unknown.fingers[0].tactile[4].forces[1].y = f64::NAN;
    refused(
        unknown,
        &["finger_0.force", "numbers that are known", "at 0.05 s"],
    );
    let mut torn = recording(&MadeUp::default());
    torn.fingers[0].tactile[4].forces.pop();
    refused(torn, &["9 numbers", "6 at 0.05 s"]);
    let mut cut = recording(&MadeUp::default());
    cut.problem = Some("the run was not closed".into());
    refused(cut, &["a whole one", "the run was not closed"]);
}
