//! `feeler top`: its display of a rig, and its keys.

use super::faults::{GOES_ON, NO_HURRY};
use super::soak::number_before;
use crate::in_terminal::InTerminal;
use crate::ports::unused_endpoint;
use crate::program::{folder, run};
use crate::rig::{HANGS, QUARTER, Rig, Setup, within_reason};
use crate::skip::not_permitted;
use std::process::Command;
use std::time::{Duration, Instant};
use std::{fs, thread};

/// Labels of a stroke's phases. The current phase is shown in capitals.
const PHASES: [&str; 4] = [" SEARCH ", " MOVE ", " RELEASE ", " RETURN "];

/// Wide enough for the state of a program in words.
const WIDE: (u16, u16) = (120, 40);

/// Output of `feeler top --once` for `rig`, with `more` arguments.
fn picture(rig: &Rig, more: &[&str]) -> String {
    let Setup {
        endpoint,
        folder,
        settings,
        ..
    } = &rig.setup;
    let mut arguments = vec!["top", "cap-closing", "--once", "--connect", endpoint];
    arguments.extend(settings.iter().map(String::as_str));
    arguments.extend(more);
    run(folder, &arguments).done()
}

/// Starts `feeler top` for `rig` in a terminal. Returns `None` if that is not possible here.
fn viewer(rig: &Rig) -> Option<InTerminal> {
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let (endpoint, settings) = (&rig.setup.endpoint, rig.setup.settings.join(" "));
    let command = format!("{feeler} top cap-closing --connect {endpoint} {settings}");
    InTerminal::start_in(&rig.setup.folder, WIDE, &command)
}

/// The number before `unit` in the line of `picture` that contains `name`.
fn shown_before(picture: &str, name: &str, unit: &str) -> Option<f64> {
    let line = picture.lines().find(|line| line.contains(name))?;
    let (_, rest) = line.split_once(name)?;
    let (before, _) = rest.split_once(unit)?;
    before.split_whitespace().last()?.parse().ok()
}

#[test]
fn top_shows_programs_flags_and_phase() {
    let rig = Setup::new("link-top")
        .with(&[NO_HURRY, GOES_ON])
        .at(QUARTER)
        .start();
    let mut hand = rig.setup.hand(&[]);
    hand.wait_for("waiting for");
    let at_work = |shown: &str| {
        let programs = ["sense 0", "sense 1", "hand ", "world "];
        let mut rates = programs
            .map(|name| shown_before(shown, name, " Hz"))
            .into_iter();
        shown.matches("● alive").count() == 4
            && shown.contains("stroke 1 of 4")
            && PHASES.iter().filter(|phase| shown.contains(*phase)).count() == 1
            && rates.all(|rate| rate.is_some_and(|rate| rate > 1.0))
    };
    // It takes a moment until all programs run and their rates are known. A stopped hand has no current phase.
    let start = Instant::now();
    let mut shown = picture(&rig, &[]);
    while !at_work(&shown) {
        assert!(start.elapsed() < HANGS, "{shown}");
        shown = picture(&rig, &[]);
    }
    let flags = shown.lines().find(|line| line.contains("╭ finger 0"));
    let flags = flags.expect("the fingers").to_lowercase();
    assert_eq!(flags.matches(" touch  slip  over ").count(), 2, "{shown}");
    assert!(
        shown.contains("N·m") && shown.contains(" missed here"),
        "{shown}"
    );
    // On an impaired network, missed messages are counted.
    let bad = picture(&rig, &["--rehearse=loss=0.3"]);
    let missed = shown_before(&bad, "╰ last", " missed here");
    assert!(missed.is_some_and(|missed| missed > 0.0), "{bad}");
}

#[test]
fn keys_stop_and_resume_the_hand_and_a_silent_hand_is_shown() {
    let rig = Setup::new("link-top-keys").with(&[NO_HURRY]).start();
    let mut hand = rig.setup.hand(&[]);
    let Some(mut terminal) = viewer(&rig) else {
        return;
    };
    terminal.wait_for("SEARCH");
    terminal.press("s");
    terminal.wait_for("STOPPED");
    hand.wait_for("stopped: stop requested by the keyboard of feeler top");
    // A busy computer may also have stopped the hand because of stale data.
    within_reason(&hand, || {
        terminal.press("r");
        thread::sleep(Duration::from_secs(1));
        hand.said().contains("resuming")
    });
    hand.signal("KILL");
    terminal.wait_for("silent for");
    terminal.press("q");
    let (drawn, status) = terminal.end();
    assert_eq!(status, Some(0), "{drawn}");
}

#[test]
fn frozen_viewer_does_not_delay_the_hand() {
    if !sees_its_descriptors() {
        not_permitted("this system does not let a process access its own file descriptors");
        return;
    }
    let setup = Setup::new("link-top-frozen").with(&[NO_HURRY, GOES_ON]);
    let rig = setup.at(QUARTER).start();
    let mut hand = rig.setup.hand(&[]);
    let Some(mut terminal) = viewer(&rig) else {
        return;
    };
    terminal.wait_for("MOVE");
    let process = child_of(terminal.child.id());
    let signal = |signal: &str| Command::new("kill").args([signal, &process]).status();
    assert!(signal("-STOP").expect("kill").success());
    // Its link is closed after a second. Otherwise, sending its unread data would block for ten seconds.
    let frozen = Duration::from_secs(13);
    thread::sleep(frozen);
    hand.signal("INT");
    let (_, said) = hand.wait();
    // `script` was frozen with it.
    assert!(signal("-KILL").expect("kill").success());
    terminal.child.kill().expect("kill");
    terminal.child.wait().expect("its state");
    // A blocked send would lose ten of the thirteen seconds. A busy computer loses some.
    let lost = number_before(&said, " tactile updates lost");
    let published = 2.0 * frozen.as_secs_f64() / rig.setup.takes(0.01).as_secs_f64();
    assert!(lost < 0.3 * published, "{said}");
}

/// Returns `true` if this process can access its own file descriptors, and thus keep sockets from lingering.
fn sees_its_descriptors() -> bool {
    use rustix::process::{PidfdFlags, PidfdGetfdFlags, getpid, pidfd_getfd, pidfd_open};
    let this = pidfd_open(getpid(), PidfdFlags::empty());
    this.is_ok_and(|this| pidfd_getfd(this, 0, PidfdGetfdFlags::empty()).is_ok())
}

/// First child of the process `parent`.
fn child_of(parent: u32) -> String {
    let children = fs::read_to_string(format!("/proc/{parent}/task/{parent}/children"));
    let children = children.expect("its children");
    children.split(' ').next().expect("a child").to_string()
}

#[test]
fn missing_rig_is_refused() {
    let endpoint = unused_endpoint();
    let arguments = ["top", "cap-closing", "--once", "--connect", &endpoint];
    let missing = run(&folder("link-top-missing"), &arguments);
    missing.refused(&["no program of rig \"cap-closing\""]);
}
