//! Interrupting an endless stream leaves valid output.

use super::table::{WITHOUT_FORCES, rows};
use crate::program::{Ended, feeler, folder};
use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{JoinHandle, spawn, yield_now};

/// Starts sensing an endless stream of frames.
fn start(folder: &Path, arguments: &[&str]) -> (Child, JoinHandle<()>) {
    // The frames do not show a fingertip, so the experiment must be named.
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
        assert!(ended.is_none(), "the program ended by itself: {ended:?}");
        yield_now();
    }
}

/// Sends the signal of Ctrl-C, and waits for the end of the program.
pub fn interrupt(child: Child) -> Ended {
    let id = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status();
    assert!(sent.expect("the kill command").success());
    Ended::of(child.wait_with_output().expect("its end"))
}

#[test]
fn interrupted_output_is_closed_properly() {
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
fn silent_stream_can_be_interrupted() {
    let folder = folder("sense-silent");
    let mut command = feeler(&folder, &["sense", "-", "--raw=640x480", "-o", "out.csv"]);
    command.stdin(Stdio::piped());
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program");
    // Waiting for the end would close standard input.
    let stdin = child.stdin.take();
    wait_for(&folder.join("out.csv.part"), 0, &mut child);
    let ended = interrupt(child);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    drop(stdin);
    // No data were received, so no file is left.
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
fn closed_output_ends_the_program() {
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

/// A killed program does not close its files; they contain the data that were written before.
#[test]
fn killed_program_leaves_complete_rows() {
    let folder = folder("sense-killed");
    for name in ["out.csv", "out.jsonl"] {
        let part = folder.join(format!("{name}.part"));
        let (mut child, writer) = start(&folder, &["-o", name]);
        // More than a single write.
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
