//! A cable between two hosts that is cut and mended: network namespaces, where the system lets us.

use super::faults::{LastWords, NO_HURRY, check};
use crate::rig::Setup;
use crate::skip::not_permitted;
use std::process::Command;
use std::time::Duration;

/// Addresses of the hand's host and of the rig's.
const ADDRESSES: [&str; 2] = ["10.77.0.1", "10.77.0.2"];

/// Two network namespaces with a cable between them.
struct Cable {
    namespaces: [String; 2],
}

/// Runs `ip`; whether it did what it was told.
fn ip(arguments: &str) -> bool {
    let output = Command::new("ip").args(arguments.split(' ')).output();
    output.is_ok_and(|output| output.status.success())
}

impl Cable {
    /// None where the system does not let us. Of each `name` there is one at a time.
    fn lay(name: &str) -> Option<Self> {
        let id = std::process::id();
        let namespaces = ["hand", "rig"].map(|host| format!("{name}-{id}-{host}"));
        let [hand, rig] = &namespaces;
        let laid = ip(&format!("netns add {hand}"));
        // From here on, dropped where it is laid but in part.
        let cable = Self {
            namespaces: namespaces.clone(),
        };
        let ends = format!("link add end netns {hand} type veth peer name end netns {rig}");
        let laid = laid && ip(&format!("netns add {rig}")) && ip(&ends);
        let plugged = |(namespace, address): (&String, &&str)| {
            ip(&format!("-n {namespace} addr add {address}/24 dev end"))
                && ip(&format!("-n {namespace} link set lo up"))
                && ip(&format!("-n {namespace} link set end up"))
        };
        (laid && namespaces.iter().zip(&ADDRESSES).all(plugged)).then_some(cable)
    }

    fn set(&self, state: &str) {
        assert!(ip(&format!(
            "-n {} link set end {state}",
            self.namespaces[1]
        )));
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        for namespace in &self.namespaces {
            ip(&format!("netns del {namespace}"));
        }
    }
}

/// Cuts the cable for so long (s) while the hand moves, over TLS.
fn cut(name: &str, seconds: u64, by_itself: bool) {
    let setup = Setup::new(name).with(&[NO_HURRY]);
    let resume = format!(
        "control.resume={}",
        if by_itself { "fresh" } else { "told" }
    );
    let mut setup = setup.with(&[&resume]);
    let Some(cable) = Cable::lay(name) else {
        not_permitted("a cable needs `ip` and the right to make network namespaces");
        return;
    };
    setup = setup.with_certificates(ADDRESSES[0], ADDRESSES[1]);
    setup.namespaces = Some(cable.namespaces.clone());
    let mut rig = setup.start();
    let mut hand = rig.moving_hand(&[]);
    cable.set("down");
    hand.wait_for("stopped: ");
    std::thread::sleep(Duration::from_secs(seconds));
    assert!(!hand.said().contains("resuming"), "{}", hand.said());
    cable.set("up");
    if !by_itself {
        rig.resume(&hand);
    }
    hand.wait_for("resuming");
    std::thread::sleep(Duration::from_millis(300));
    let LastWords { world, .. } = check(&mut rig, hand, "s old (limit");
    assert!(!world.contains(" 0 stops by the watchdog"), "{world}");
}

#[test]
fn a_cable_that_is_cut_for_a_second_stops_the_hand_until_it_is_told_to_go_on() {
    cut("link-cable", 1, false);
}

/// Both ends give the connection up meanwhile. A minute where `FEELER_LONG_TESTS` is set.
#[test]
fn after_a_long_cut_the_programs_find_each_other_again() {
    let long = std::env::var_os("FEELER_LONG_TESTS").is_some();
    cut("link-long-cable", if long { 60 } else { 5 }, true);
}
