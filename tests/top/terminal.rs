//! The view in a terminal of its own, which `script` of util-linux makes.

use crate::program::{experiment, folder, run, whole_run};
use feeler::top::View;
use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

const ENTER: &str = "\u{1b}[?1049h";
const LEAVE: &str = "\u{1b}[?1049l";

/// A program in a terminal, and what it has drawn so far.
struct InTerminal {
    child: Child,
    drawn: String,
}

impl InTerminal {
    /// Starts `command` in `folder`; nothing where there is no `script`.
    fn start(folder: &Path, command: &str) -> Option<Self> {
        let command = format!("stty rows 24 cols 80; exec {command}");
        let child = Command::new("script")
            .args(["-qec", &command, "/dev/null"])
            .current_dir(folder)
            .env("TERM", "xterm-256color")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn();
        let Ok(child) = child else {
            eprintln!("skipped: there is no program `script`, which makes a terminal (util-linux)");
            return None;
        };
        let drawn = String::new();
        Some(Self { child, drawn })
    }

    /// Reads on until `word` is drawn.
    fn wait_for(&mut self, word: &str) {
        let from = self.drawn.len();
        while !self.drawn[from..].contains(word) {
            let mut bytes = [0; 1024];
            let output = self.child.stdout.as_mut().expect("output");
            let read = output.read(&mut bytes).expect("what it draws");
            assert!(read > 0, "it ended without {word:?}: {:?}", self.drawn);
            let text = String::from_utf8_lossy(&bytes[..read]);
            self.drawn.push_str(&text);
        }
    }

    fn press(&mut self, key: &str) {
        let input = self.child.stdin.as_mut().expect("input");
        input.write_all(key.as_bytes()).expect("a key");
        input.flush().expect("a key");
    }

    /// All that it drew, and its exit status.
    fn end(mut self) -> (String, Option<i32>) {
        let output = self.child.stdout.as_mut().expect("output");
        let mut rest = Vec::new();
        // A terminal whose program has ended may give an error instead of an end.
        let _ = output.read_to_end(&mut rest);
        self.drawn.push_str(&String::from_utf8_lossy(&rest));
        let status = self.child.wait().expect("its state");
        (self.drawn, status.code())
    }
}

fn digest(run: &Path) -> serde_json::Value {
    let text = fs::read_to_string(run.join("summary.json")).expect("a summary");
    let mut summary: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    summary["digest"].take()
}

#[test]
fn a_watched_run_is_the_run_that_nobody_watches() {
    let folder = folder("top-same");
    let unwatched = digest(&whole_run(&folder));
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let arguments = "run cap-closing --sensing direct --top --speed max --out watched";
    let started = InTerminal::start(&folder, &format!("{feeler} {arguments}"));
    let Some(mut terminal) = started else { return };
    // It stays to be looked at when the run is over; the report is made by then.
    terminal.wait_for("leaves");
    assert!(folder.join("watched/report.html").exists());
    terminal.press("q");
    let (drawn, status) = terminal.end();
    assert_eq!(status, Some(0), "{drawn}");
    let (screen, said) = drawn.split_once(LEAVE).expect("the terminal given back");
    assert!(screen.contains(ENTER) && screen.contains("DONE"), "{drawn}");
    assert!(said.contains("s simulated in"), "{said}");
    assert_eq!(digest(&folder.join("watched")), unwatched);
}

#[test]
fn keys_stop_the_hand_and_let_it_go_on_and_leave() {
    let folder = folder("top-keys");
    // Strokes go on for ever: the cap never meets its seat.
    experiment(&folder, "seat_angle = 0.48", "seat_angle = 1e6");
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let endless = "--set=task.strokes=1000 --set=time_limit=90000 --sensing direct";
    let command = format!("{feeler} run my.toml {endless} --top --speed 5 --out run");
    let Some(mut terminal) = InTerminal::start(&folder, &command) else {
        return;
    };
    terminal.wait_for("simulated");
    terminal.press("s");
    terminal.wait_for("told");
    terminal.press("r");
    terminal.wait_for("over:");
    terminal.press("\u{3}");
    let (drawn, status) = terminal.end();
    assert_eq!(status, Some(1), "{drawn}");
    assert!(drawn.contains("STOPPED"), "{drawn}");
    let (_, said) = drawn.split_once(LEAVE).expect("the terminal given back");
    assert!(said.contains("interrupted"), "{said}");
    // What was recorded is whole, and says who stopped the hand.
    run(&folder, &["report", "run"]).done();
    let recording = fs::read(folder.join("run/recording.mcap")).expect("a recording");
    let words = b"told to stop by the keyboard";
    assert!(recording.windows(words.len()).any(|part| part == words));
}

/// Whoever closes the window ends the run as with Ctrl-C.
#[test]
fn a_terminal_that_goes_away_ends_the_run() {
    let folder = folder("top-gone");
    experiment(&folder, "seat_angle = 0.48", "seat_angle = 1e6");
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let endless = "--set=task.strokes=1000 --set=time_limit=90000 --sensing direct";
    // Replaces the shell, so that the number is its own.
    let command = format!("{feeler} run my.toml {endless} --top --speed 5 --out run");
    let command = format!("sh -c 'echo $$ > number; exec {command}'");
    let Some(mut terminal) = InTerminal::start(&folder, &command) else {
        return;
    };
    terminal.wait_for("simulated");
    let number = fs::read_to_string(folder.join("number")).expect("its number");
    terminal.child.kill().expect("a terminal");
    terminal.child.wait().expect("its state");
    let program = Path::new("/proc").join(number.trim()).join("exe");
    while fs::read_link(&program).is_ok() {
        std::thread::yield_now();
    }
    run(&folder, &["report", "run"]).done();
}

/// This program's own test below, in a terminal.
#[test]
fn a_panic_is_told_on_the_terminal_as_it_was() {
    let test = std::env::current_exe().expect("this program");
    let test = format!(
        "{} --exact terminal::panics_in_view --ignored --nocapture",
        test.display()
    );
    let Some(terminal) = InTerminal::start(Path::new("."), &test) else {
        return;
    };
    let (drawn, _) = terminal.end();
    let (screen, said) = drawn.split_once(LEAVE).expect("the terminal given back");
    assert!(screen.contains(ENTER), "{drawn}");
    assert!(said.contains("as if by mistake"), "{drawn}");
}

#[test]
#[ignore = "for the test above, which runs it in a terminal"]
fn panics_in_view() {
    let view = View::open(&Arc::new(AtomicBool::new(false)));
    let _view = view.expect("a terminal");
    panic!("as if by mistake");
}
