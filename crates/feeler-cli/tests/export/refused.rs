//! What is refused, and what is left of an export that failed.

use crate::program::{folder, run};
use crate::short_run;
use std::fs;
use std::path::Path;

/// The names of what is in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
    let mut names: Vec<_> = entries.map(|e| name(e).into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn tables_replace_nothing_unless_told_to() {
    let folder = folder("export-refused-tables");
    short_run(&folder, "one", "1");
    let export = |arguments: &[&str]| run(&folder, &[&["export", "parquet"], arguments].concat());
    let said = export(&["one", "-o", "one.parquet"]).done();
    assert_eq!(said, "one.parquet\n");
    let first = fs::read(folder.join("one.parquet")).unwrap();
    let exists = ["--output one.parquet", "exists already", "--force"];
    export(&["one", "-o", "one.parquet"]).refused(&exists);
    // The recording itself is a run, too, and called as its folder is.
    export(&["one/recording.mcap", "-o", "one.parquet", "--force"]).done();
    assert!(fs::read(folder.join("one.parquet")).unwrap() == first);
    let onto_input = ["one", "-o", "one/recording.mcap", "--force"];
    export(&onto_input).refused(&["--output one/recording.mcap", "expected a folder"]);
    fs::copy(folder.join("one/recording.mcap"), folder.join("in.parquet")).unwrap();
    let onto_input = ["in.parquet", "-o", "in.parquet", "--force"];
    export(&onto_input).refused(&["it is an input"]);
    export(&["one", "one", "-o", "o"]).refused(&["two runs are called one"]);
    export(&["one", "in.parquet", "-o", "x.parquet"]).refused(&["2 are given", "a folder"]);
    export(&["nothing", "-o", "x.parquet"]).refused(&["nothing", "there is no recording"]);
    assert_eq!(names(&folder), ["in.parquet", "one", "one.parquet"]);
}

#[test]
fn a_table_that_fails_leaves_none() {
    let folder = folder("export-failed-tables");
    short_run(&folder, "one", "1");
    fs::create_dir(folder.join("bad")).unwrap();
    fs::write(folder.join("bad/recording.mcap"), "no recording").unwrap();
    let export = ["export", "parquet", "one", "bad", "-o", "tables"];
    run(&folder, &export).refused(&["bad/recording.mcap", "nothing readable"]);
    assert!(names(&folder.join("tables")).is_empty());
}

#[test]
fn a_table_of_a_recording_that_was_cut_off_says_so() {
    let folder = folder("export-cut-tables");
    short_run(&folder, "one", "1");
    let bytes = fs::read(folder.join("one/recording.mcap")).unwrap();
    fs::write(folder.join("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    let export = ["export", "parquet", "cut.mcap", "-o", "cut.parquet"];
    run(&folder, &export).refused(&["cut.mcap: the recording is incomplete", "exported up to"]);
    assert_eq!(names(&folder), ["cut.mcap", "cut.parquet", "one"]);
}
