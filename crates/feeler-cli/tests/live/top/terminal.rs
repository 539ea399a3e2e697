//! The view in a terminal of its own.

use crate::in_terminal::InTerminal;
use crate::program::{experiment, folder, run, whole_run};
use feeler_watch::View;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

const ENTER: &str = "\u{1b}[?1049h";
const LEAVE: &str = "\u{1b}[?1049l";

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
    experiment(&folder, "seat_angle = 0.59", "seat_angle = 1e6");
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let endless = "--set=task.screw.strokes=1000 --set=time_limit=90000 --sensing direct";
    let command = format!("{feeler} run my.toml {endless} --top --speed 5 --out run");
    let Some(mut terminal) = InTerminal::start(&folder, &command) else {
        return;
    };
    terminal.wait_for("simulated");
    terminal.press("s");
    terminal.wait_for("stop requested");
    terminal.press("r");
    terminal.wait_for("resolved:");
    terminal.press("\u{3}");
    let (drawn, status) = terminal.end();
    assert_eq!(status, Some(1), "{drawn}");
    assert!(drawn.contains("STOPPED"), "{drawn}");
    let (_, said) = drawn.split_once(LEAVE).expect("the terminal given back");
    assert!(said.contains("interrupted"), "{said}");
    // What was recorded is whole, and says who stopped the hand.
    run(&folder, &["report", "run"]).done();
    let recording = fs::read(folder.join("run/recording.mcap")).expect("a recording");
    let words = b"stop requested by the keyboard";
    assert!(recording.windows(words.len()).any(|part| part == words));
}

/// A run in `folder` that never ends, and its number among the system's programs.
fn endless(folder: &Path) -> Option<(InTerminal, String)> {
    experiment(folder, "seat_angle = 0.59", "seat_angle = 1e6");
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let endless = "--set=task.screw.strokes=1000 --set=time_limit=90000 --sensing direct";
    // Replaces the shell, so that the number is its own.
    let command = format!("{feeler} run my.toml {endless} --top --speed 5 --out run");
    let command = format!("sh -c 'echo $$ > number; exec {command}'");
    let mut terminal = InTerminal::start(folder, &command)?;
    terminal.wait_for("simulated");
    let number = fs::read_to_string(folder.join("number")).expect("its number");
    Some((terminal, number.trim().to_string()))
}

/// The system's signals and the key end it alike.
#[test]
fn who_is_told_to_end_gives_the_terminal_back_and_keeps_the_record() {
    for how in ["TERM", "INT", "q"] {
        let folder = folder(&format!("top-ended-by-{how}"));
        let Some((mut terminal, number)) = endless(&folder) else {
            return;
        };
        if how == "q" {
            terminal.press(how);
        } else {
            let signal = format!("-{how}");
            let sent = Command::new("kill").args([&signal, &number]).status();
            assert!(sent.expect("kill").success());
        }
        let (drawn, status) = terminal.end();
        assert_eq!(status, Some(1), "{how}: {drawn}");
        let (_, said) = drawn.split_once(LEAVE).expect("the terminal given back");
        assert!(said.contains("interrupted"), "{how}: {said}");
        run(&folder, &["report", "run"]).done();
    }
}

/// Taking the terminal from there would halt the program, and then it hears no signal.
#[test]
fn in_the_background_the_run_is_refused() {
    let folder = folder("top-background");
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let command = format!("{feeler} run cap-closing --sensing direct --top --out run");
    // With its jobs on, a shell puts each in a group of its own.
    let command = format!("sh -c 'set -m; {command} & wait $!; echo it ended with $?'");
    let Some(terminal) = InTerminal::start(&folder, &command) else {
        return;
    };
    let (drawn, _) = terminal.end();
    assert!(drawn.contains("in the background"), "{drawn}");
    assert!(drawn.contains("it ended with 2"), "{drawn}");
    assert!(!folder.join("run").exists());
}

/// Whoever closes the window ends the run as with Ctrl-C.
#[test]
fn a_terminal_that_goes_away_ends_the_run() {
    let folder = folder("top-gone");
    let Some((mut terminal, number)) = endless(&folder) else {
        return;
    };
    terminal.child.kill().expect("a terminal");
    terminal.child.wait().expect("its state");
    let program = Path::new("/proc").join(number).join("exe");
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
        "{} --exact top::terminal::panics_in_view --ignored --nocapture",
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
