//! What `feeler top` shows of a rig, and that its keys reach the hand.

use super::faults::{GOES_ON, NO_HURRY};
use super::soak::number_before;
use crate::in_terminal::InTerminal;
use crate::ports::unused_endpoint;
use crate::program::{folder, run};
use crate::rig::{HANGS, QUARTER, Rig, Setup, within_reason};
use crate::skip::not_permitted;
use std::fs;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

/// The phases of a stroke. The one that the hand is in is written large.
const PHASES: [&str; 4] = [" SEARCH ", " MOVE ", " RELEASE ", " RETURN "];

/// Wide enough for a program's state in words.
const WIDE: (u16, u16) = (120, 40);

/// What `feeler top --once` prints of `rig`, with `more` arguments.
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

/// `feeler top` of `rig` in a terminal, where there can be one.
fn viewer(rig: &Rig) -> Option<InTerminal> {
    let feeler = env!("CARGO_BIN_EXE_feeler");
    let (endpoint, settings) = (&rig.setup.endpoint, rig.setup.settings.join(" "));
    let command = format!("{feeler} top cap-closing --connect {endpoint} {settings}");
    InTerminal::start_in(&rig.setup.folder, WIDE, &command)
}

/// The number before `unit` in the line of `picture` that begins with `name`.
fn shown_before(picture: &str, name: &str, unit: &str) -> Option<f64> {
    let line = picture.lines().find(|line| line.contains(name))?;
    let (_, rest) = line.split_once(name)?;
    let (before, _) = rest.split_once(unit)?;
    before.split_whitespace().last()?.parse().ok()
}

#[test]
fn a_rig_is_shown_with_its_programs_flags_and_phase() {
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
    // It takes a moment until all are, and until each has told its rate; and no phase is lit while the hand is stopped.
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
    // Of a bad network, the picture says that it may be incomplete.
    let bad = picture(&rig, &["--rehearse=loss=0.3"]);
    let missed = shown_before(&bad, "╰ last", " missed here");
    assert!(missed.is_some_and(|missed| missed > 0.0), "{bad}");
}

#[test]
fn keys_reach_the_hand_and_it_is_missed_when_it_is_gone() {
    let rig = Setup::new("link-top-keys").with(&[NO_HURRY]).start();
    let mut hand = rig.setup.hand(&[]);
    let Some(mut terminal) = viewer(&rig) else {
        return;
    };
    terminal.wait_for("SEARCH");
    terminal.press("s");
    terminal.wait_for("STOPPED");
    hand.wait_for("stopped: stop requested by the keyboard of feeler top");
    // A busy machine may have stopped the hand for want of fresh data, too.
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
fn a_viewer_that_is_frozen_holds_up_nobody() {
    if !sees_its_descriptors() {
        not_permitted("this system does not let a process see its own descriptors");
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
    // Its link is closed after a second. What it had not read by then would be waited for for ten seconds.
    let frozen = Duration::from_secs(13);
    thread::sleep(frozen);
    hand.signal("INT");
    let (_, said) = hand.wait();
    // `script` froze itself with it.
    assert!(signal("-KILL").expect("kill").success());
    terminal.child.kill().expect("kill");
    terminal.child.wait().expect("its state");
    // Ten of the thirteen seconds would have been lost; a busy computer loses some.
    let lost = number_before(&said, " tactile updates lost");
    let published = 2.0 * frozen.as_secs_f64() / rig.setup.takes(0.01).as_secs_f64();
    assert!(lost < 0.3 * published, "{said}");
}

/// Whether sockets can be kept from lingering here.
fn sees_its_descriptors() -> bool {
    use rustix::process::{PidfdFlags, PidfdGetfdFlags, getpid, pidfd_getfd, pidfd_open};
    let this = pidfd_open(getpid(), PidfdFlags::empty());
    this.is_ok_and(|this| pidfd_getfd(this, 0, PidfdGetfdFlags::empty()).is_ok())
}

/// The process that the process `parent` started.
fn child_of(parent: u32) -> String {
    let children = fs::read_to_string(format!("/proc/{parent}/task/{parent}/children"));
    let children = children.expect("its children");
    children.split(' ').next().expect("a child").to_string()
}

#[test]
fn a_rig_that_is_not_there_is_not_shown() {
    let endpoint = unused_endpoint();
    let arguments = ["top", "cap-closing", "--once", "--connect", &endpoint];
    let nobody = run(&folder("link-top-nobody"), &arguments);
    nobody.refused(&["no program of rig \"cap-closing\""]);
}
