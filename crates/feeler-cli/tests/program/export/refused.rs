//! Refused exports, and the files that failed exports leave.

use super::made_up::{MadeUp, recording_file};
use super::short_run;
use crate::program::{Ended, feeler, folder, run};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::yield_now;

/// Sorted names of the entries of a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
    let mut names: Vec<_> = entries.map(|e| name(e).into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn tables_replace_files_only_with_force() {
    let folder = folder("export-refused-tables");
    short_run(&folder, "one", "1");
    let export = |arguments: &[&str]| run(&folder, &[&["export", "parquet"], arguments].concat());
    let said = export(&["one", "-o", "one.parquet"]).done();
    assert_eq!(said, "one.parquet\n");
    let first = fs::read(folder.join("one.parquet")).unwrap();
    let exists = ["--output one.parquet", "exists already", "--force"];
    export(&["one", "-o", "one.parquet"]).refused(&exists);
    // The recording itself is accepted, too, and is named after its folder.
    export(&["one/recording.mcap", "-o", "one.parquet", "--force"]).done();
    assert!(fs::read(folder.join("one.parquet")).unwrap() == first);
    let onto_input = ["one", "-o", "one/recording.mcap", "--force"];
    export(&onto_input).refused(&["--output one/recording.mcap", "expected a folder"]);
    fs::copy(folder.join("one/recording.mcap"), folder.join("in.parquet")).unwrap();
    let onto_input = ["in.parquet", "-o", "in.parquet", "--force"];
    export(&onto_input).refused(&["the file is an input"]);
    export(&["one", "one", "-o", "o"]).refused(&["two runs are named one"]);
    export(&["one", "in.parquet", "-o", "x.parquet"]).refused(&["expected a folder for 2 runs"]);
    export(&["nothing", "-o", "x.parquet"]).refused(&["nothing", "found no recording"]);
    assert_eq!(names(&folder), ["in.parquet", "one", "one.parquet"]);
}

#[test]
fn failed_table_export_leaves_no_files() {
    let folder = folder("export-failed-tables");
    short_run(&folder, "one", "1");
    fs::create_dir(folder.join("bad")).unwrap();
    fs::write(folder.join("bad/recording.mcap"), "no recording").unwrap();
    let export = ["export", "parquet", "one", "bad", "-o", "tables"];
    run(&folder, &export).refused(&["bad/recording.mcap", "nothing readable"]);
    assert!(names(&folder.join("tables")).is_empty());
}

#[test]
fn incomplete_recording_is_exported_with_an_error() {
    let folder = folder("export-cut-tables");
    short_run(&folder, "one", "1");
    let bytes = fs::read(folder.join("one/recording.mcap")).unwrap();
    fs::write(folder.join("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    let export = ["export", "parquet", "cut.mcap", "-o", "cut.parquet"];
    run(&folder, &export).refused(&["cut.mcap: the recording is incomplete", "exported up to"]);
    assert_eq!(names(&folder), ["cut.mcap", "cut.parquet", "one"]);
}

#[test]
fn export_replaces_only_data_sets() {
    let folder = folder("export-refused-set");
    short_run(&folder, "one", "1");
    let export = |arguments: &[&str]| run(&folder, &[&["export", "lerobot"], arguments].concat());
    // An empty folder is accepted like a new one.
    fs::create_dir(folder.join("set")).unwrap();
    export(&["one", "-o", "set"]).done();
    export(&["one", "-o", "set"]).refused(&["--output set", "exists already", "--force"]);
    fs::write(folder.join("set/of-before"), "").unwrap();
    export(&["one", "-o", "set/", "--force"]).done();
    assert_eq!(names(&folder.join("set")), ["data", "meta"]);
    fs::write(folder.join("file"), "mine").unwrap();
    fs::create_dir(folder.join("mine")).unwrap();
    fs::write(folder.join("mine/file"), "mine").unwrap();
    for mine in ["file", "mine", "mine/"] {
        export(&["one", "-o", mine, "--force"]).refused(&["is not a data set"]);
    }
    for nameless in [".", "set/.."] {
        export(&["one", "-o", nameless, "--force"]).refused(&["the name of a folder"]);
    }
    let above = ["one", "-o", "../export-refused-set", "--force"];
    export(&above).refused(&["contains the input one/recording.mcap"]);
    // A recording inside of the data set is not deleted.
    fs::copy(
        folder.join("one/recording.mcap"),
        folder.join("set/in.mcap"),
    )
    .unwrap();
    let from_inside = ["set/in.mcap", "-o", "set", "--force"];
    export(&from_inside).refused(&["contains the input set/in.mcap"]);
    assert_eq!(names(&folder), ["file", "mine", "one", "set"]);
}

#[test]
fn failed_data_set_export_leaves_no_files() {
    let folder = folder("export-failed-set");
    short_run(&folder, "one", "1");
    run(
        &folder,
        &["run", "friction-scan", "--sensing=direct", "--out=two"],
    )
    .done();
    let export = ["export", "lerobot", "one", "two", "-o", "set"];
    let features = ["two: features: expected ", " as in the first run, got "];
    run(&folder, &export).refused(&features);
    assert_eq!(names(&folder), ["one", "two"]);
    fs::create_dir_all(folder.join("set.part/data")).unwrap();
    let export = ["export", "lerobot", "one", "-o", "set"];
    run(&folder, &export).refused(&["set.part", "a killed export"]);
    run(&folder, &[&export[..], &["--force"]].concat()).done();
    assert_eq!(names(&folder), ["one", "set", "two"]);
}

#[cfg(unix)]
#[test]
fn interrupted_data_set_export_leaves_no_files() {
    let folder = folder("export-interrupted-set");
    // Enough images for minutes.
    let made_up = MadeUp {
        steps: 4000,
        pictures: Some((320, 240)),
        ..MadeUp::default()
    };
    recording_file(&made_up, &folder.join("long.mcap"));
    let mut export = feeler(&folder, &["export", "lerobot", "long.mcap", "-o", "set"]);
    let export = export.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut export = export.spawn().expect("the program");
    while !folder.join("set.part/videos").exists() {
        let ended = export.try_wait().expect("its state");
        assert!(ended.is_none(), "the export ended by itself: {ended:?}");
        yield_now();
    }
    let kill = Command::new("kill")
        .args(["-INT", &export.id().to_string()])
        .status();
    assert!(kill.expect("the kill command").success());
    let ended = Ended::of(export.wait_with_output().unwrap());
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert_eq!(ended.stdout, "interrupted: nothing was exported\n");
    assert_eq!(names(&folder), ["long.mcap"]);
}
