//! A cable between hand and rig that is cut and mended.

use crate::faults::{BY_ITSELF, DIRECT, waits};
use crate::promises::Stop;
use crate::rig::{Rig, STALE, WATCHDOG, count};
use crate::strangers::certificates;
use std::process::Command;
use std::thread;
use std::time::Duration;

/// Two network namespaces with a cable between them: the hand's at 10.77.0.1, the rig's at 10.77.0.2.
struct Cable {
    namespaces: [String; 2],
}

fn ip(arguments: &[&str]) -> bool {
    let output = Command::new("ip").args(arguments).output();
    output.is_ok_and(|output| output.status.success())
}

impl Cable {
    /// None where the system does not let us.
    fn lay(name: &str) -> Option<Self> {
        let id = std::process::id();
        let namespaces = ["a", "b"].map(|end| format!("feeler-{id}-{name}-{end}"));
        let [a, b] = &namespaces;
        let laid = ip(&["netns", "add", a]);
        let cable = Self {
            namespaces: namespaces.clone(),
        };
        let laid = laid
            && ip(&["netns", "add", b])
            && ip(&[
                "link", "add", "end0", "netns", a, "type", "veth", "peer", "name", "end0", "netns",
                b,
            ])
            && ip(&["-n", a, "addr", "add", "10.77.0.1/24", "dev", "end0"])
            && ip(&["-n", b, "addr", "add", "10.77.0.2/24", "dev", "end0"])
            && namespaces.iter().all(|namespace| {
                ip(&["-n", namespace, "link", "set", "lo", "up"])
                    && ip(&["-n", namespace, "link", "set", "end0", "up"])
            });
        laid.then_some(cable)
    }

    fn cut(&self) {
        assert!(ip(&[
            "-n",
            &self.namespaces[1],
            "link",
            "set",
            "end0",
            "down"
        ]));
    }

    fn mend(&self) {
        assert!(ip(&[
            "-n",
            &self.namespaces[1],
            "link",
            "set",
            "end0",
            "up"
        ]));
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        for namespace in &self.namespaces {
            ip(&["netns", "del", namespace]);
        }
    }
}

/// Cuts the cable for so long (s) while the cap is being closed, over TLS.
fn cut_for(name: &str, seconds: f64, by_itself: bool) {
    let Some(cable) = Cable::lay(name) else {
        eprintln!("SKIPPED: a cut cable needs root and the `ip` program for network namespaces");
        return;
    };
    let mut rig = Rig::new(&format!("cable-{name}"), "1").with(&[DIRECT]);
    if by_itself {
        rig = rig.with(&[BY_ITSELF]);
    }
    rig.endpoint = "tls/10.77.0.1:7447".into();
    rig.namespaces = Some(cable.namespaces.clone());
    rig.hand_link = certificates(&rig.folder, "lab", "10.77.0.1");
    rig.joining = certificates(&rig.folder, "lab", "10.77.0.2");
    let hand = rig.hand(&[]);
    hand.wait_to_say("waiting for");
    let others = rig.others(&[]);
    rig.wait_for_record(300_000);
    let said = hand.warnings();
    cable.cut();
    let said = hand.wait_to_warn("stopped: ", said);
    thread::sleep(Duration::from_secs_f64(seconds));
    assert_eq!(hand.warnings(), said, "it went on without a cable");
    cable.mend();
    if by_itself {
        hand.wait_to_warn("going on", said);
    } else {
        waits(&hand, said);
        rig.resume(&hand, said);
    }
    rig.wait_for_more_record();
    let ended = hand.interrupt();
    let world = others.interrupt();
    assert_eq!(count(&world, STALE), 0, "{ended:?}\n{world:?}");
    assert!(count(&world, WATCHDOG) >= 1, "{world:?}");
    let stops = rig.recorded().keeps_its_promises();
    let stale = |stop: &Stop| stop.reason.contains("s old (limit");
    assert!(stops.iter().any(stale), "{stops:?}");
}

#[test]
fn a_cable_cut_for_a_second_stops_the_hand_until_it_is_told_to_go_on() {
    cut_for("short", 1.0, false);
}

/// Long enough for both ends to give the connection up. With FEELER_LONG_TESTS in the environment, a minute.
#[test]
fn after_a_long_cut_the_programs_find_each_other_again() {
    let long = std::env::var_os("FEELER_LONG_TESTS").is_some();
    cut_for("long", if long { 60.0 } else { 5.0 }, true);
}
