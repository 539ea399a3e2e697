//! The view in a pseudo-terminal.

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
fn run_with_top_equals_the_run_without() {
    let folder = folder("top-same");
    let unwatched = digest(&whole_run(&folder));
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let arguments = "run cap-closing --sensing direct --top --speed max --out watched";
    let started = InTerminal::start(&folder, &format!("{feeler} {arguments}"));
    let Some(mut terminal) = started else { return };
    // The view stays open after the run until it is quit; the report exists by then.
    terminal.wait_for("written");
    assert!(folder.join("watched/report.html").exists());
    terminal.press("q");
    let (drawn, status) = terminal.end();
    assert_eq!(status, Some(0), "{drawn}");
    let (screen, said) = drawn.split_once(LEAVE).expect("the terminal is restored");
    assert!(screen.contains(ENTER) && screen.contains("DONE"), "{drawn}");
    assert!(said.contains("s simulated in"), "{said}");
    assert_eq!(digest(&folder.join("watched")), unwatched);
}

#[test]
fn keys_stop_and_resume_the_hand_and_quit() {
    let folder = folder("top-keys");
    // Strokes continue forever: the cap never reaches its seat.
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
    let (_, said) = drawn.split_once(LEAVE).expect("the terminal is restored");
    assert!(said.contains("interrupted"), "{said}");
    // The recording is complete and names the source of the stop.
    run(&folder, &["report", "run"]).done();
    let recording = fs::read(folder.join("run/recording.mcap")).expect("a recording");
    let words = b"stop requested by the keyboard";
    assert!(recording.windows(words.len()).any(|part| part == words));
}

/// Starts an endless run in `folder`, and returns its terminal and its process id.
fn endless(folder: &Path) -> Option<(InTerminal, String)> {
    experiment(folder, "seat_angle = 0.59", "seat_angle = 1e6");
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let endless = "--set=task.screw.strokes=1000 --set=time_limit=90000 --sensing direct";
    // `exec` replaces the shell, so that the process id is that of the program.
    let command = format!("{feeler} run my.toml {endless} --top --speed 5 --out run");
    let command = format!("sh -c 'echo $$ > number; exec {command}'");
    let mut terminal = InTerminal::start(folder, &command)?;
    terminal.wait_for("simulated");
    let number = fs::read_to_string(folder.join("number")).expect("its number");
    Some((terminal, number.trim().to_string()))
}

/// Signals and the key `q` end the program alike.
#[test]
fn ended_program_restores_the_terminal_and_keeps_the_recording() {
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
        let (_, said) = drawn.split_once(LEAVE).expect("the terminal is restored");
        assert!(said.contains("interrupted"), "{how}: {said}");
        run(&folder, &["report", "run"]).done();
    }
}

/// A background process that accesses the terminal would be suspended, and would then receive no signals.
#[test]
fn run_in_the_background_is_refused() {
    let folder = folder("top-background");
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let command = format!("{feeler} run cap-closing --sensing direct --top --out run");
    // With job control, a shell runs each job in a separate process group.
    let command = format!("sh -c 'set -m; {command} & wait $!; echo it ended with $?'");
    let Some(terminal) = InTerminal::start(&folder, &command) else {
        return;
    };
    let (drawn, _) = terminal.end();
    assert!(drawn.contains("in the background"), "{drawn}");
    assert!(drawn.contains("it ended with 2"), "{drawn}");
    assert!(!folder.join("run").exists());
}

/// Closing the terminal window ends the run like Ctrl-C.
#[test]
fn closed_terminal_ends_the_run() {
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

/// Runs [`panics_in_view`] of this test binary in a terminal.
#[test]
fn panic_message_is_printed_after_the_terminal_is_restored() {
    let test = std::env::current_exe().expect("this program");
    let test = format!(
        "{} --exact top::terminal::panics_in_view --ignored --nocapture",
        test.display()
    );
    let Some(terminal) = InTerminal::start(Path::new("."), &test) else {
        return;
    };
    let (drawn, _) = terminal.end();
    let (screen, said) = drawn.split_once(LEAVE).expect("the terminal is restored");
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
