//! An endless stream that is interrupted leaves a good output.

use super::table::{WITHOUT_FORCES, rows};
use crate::program::{Ended, feeler, folder};
use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{JoinHandle, spawn, yield_now};

/// Starts sensing frames that do not end.
fn start(folder: &Path, arguments: &[&str]) -> (Child, JoinHandle<()>) {
    // The frames are of no fingertip.
    let source = ["sense", "-", "--raw=640x480", "--experiment=cap-closing"];
    let all = [&source, arguments].concat();
    let mut command = feeler(folder, &all);
    command.stdin(Stdio::piped());
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program");
    let mut stdin = child.stdin.take().expect("its input");
    let frame: Vec<u8> = (0..640 * 480).map(|i| (i % 251) as u8).collect();
    let writer = spawn(move || while stdin.write_all(&frame).is_ok() {});
    (child, writer)
}

fn wait_for(path: &Path, bytes: u64, child: &mut Child) {
    while fs::metadata(path).map_or(true, |m| m.len() < bytes) {
        let ended = child.try_wait().expect("its state");
        assert!(ended.is_none(), "it ended by itself: {ended:?}");
        yield_now();
    }
}

/// Sends what Ctrl-C sends, and waits for the end.
pub fn interrupt(child: Child) -> Ended {
    let id = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status();
    assert!(sent.expect("the kill command").success());
    Ended::of(child.wait_with_output().expect("its end"))
}

#[test]
fn the_output_is_closed_properly() {
    let folder = folder("sense-interrupted");
    for name in ["out.csv", "out.mcap"] {
        let (mut child, writer) = start(&folder, &["-o", name]);
        wait_for(&folder.join(format!("{name}.part")), 100_000, &mut child);
        let ended = interrupt(child);
        writer.join().unwrap();
        assert_eq!(ended.status, Some(1), "{ended:?}");
        assert!(ended.stderr.contains("frames sensed"), "{ended:?}");
    }
    let table = fs::read_to_string(folder.join("out.csv")).unwrap();
    assert_eq!(rows(&table, WITHOUT_FORCES).len() % 41, 0);
    let file = fs::read(folder.join("out.mcap")).unwrap();
    assert!(mcap::MessageStream::new(&file).unwrap().all(|m| m.is_ok()));
    assert!(file.ends_with(mcap::MAGIC));
}

#[test]
fn a_silent_stream_is_interrupted_too() {
    let folder = folder("sense-silent");
    let mut command = feeler(&folder, &["sense", "-", "--raw=640x480", "-o", "out.csv"]);
    command.stdin(Stdio::piped());
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program");
    // Waiting for the end would close its input.
    let stdin = child.stdin.take();
    wait_for(&folder.join("out.csv.part"), 0, &mut child);
    let ended = interrupt(child);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    drop(stdin);
    // There was nothing to write.
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
fn a_reader_that_has_had_enough_ends_it() {
    let folder = folder("sense-head");
    let (mut child, writer) = start(&folder, &[]);
    let mut stdout = child.stdout.take().expect("its output");
    let mut some = [0; 1000];
    stdout.read_exact(&mut some).expect("some rows");
    drop(stdout);
    let ended = Ended::of(child.wait_with_output().expect("its end"));
    writer.join().unwrap();
    assert_eq!(ended.status, Some(0), "{ended:?}");
}

/// Nothing is closed: the file is as the system has it.
#[test]
fn a_program_that_is_killed_leaves_whole_rows() {
    let folder = folder("sense-killed");
    for name in ["out.csv", "out.jsonl"] {
        let part = folder.join(format!("{name}.part"));
        let (mut child, writer) = start(&folder, &["-o", name]);
        // More than is handed on at a time.
        wait_for(&part, 300_000, &mut child);
        child.kill().expect("the kill");
        let ended = child.wait().expect("its end");
        assert!(!ended.success());
        writer.join().unwrap();
        let rows = fs::read_to_string(&part).unwrap();
        assert!(
            rows.ends_with('\n'),
            "{name} ends with {:?}",
            rows.lines().last()
        );
        if name == "out.csv" {
            let columns = |row: &str| row.split(',').count();
            assert!(rows.lines().all(|row| columns(row) == 6));
        } else {
            let is_json = |row: &str| serde_json::from_str::<serde_json::Value>(row).is_ok();
            assert!(rows.lines().all(is_json));
        }
    }
}
