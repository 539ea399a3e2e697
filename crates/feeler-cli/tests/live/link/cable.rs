//! A cable between two hosts that is cut and reconnected, simulated with network namespaces if permitted.

use super::faults::{LastWords, NO_HURRY, check};
use crate::how_many::is_long;
use crate::rig::Setup;
use crate::skip::not_permitted;
use std::process::Command;
use std::time::Duration;

/// Addresses of the hand's host and the rig's host.
const ADDRESSES: [&str; 2] = ["10.77.0.1", "10.77.0.2"];

/// Two network namespaces connected by a virtual cable.
struct Cable {
    namespaces: [String; 2],
}

/// Runs `ip` and returns whether it succeeded.
fn ip(arguments: &str) -> bool {
    let output = Command::new("ip").args(arguments.split(' ')).output();
    output.is_ok_and(|output| output.status.success())
}

impl Cable {
    /// Creates the namespaces, or returns `None` if not permitted. Each `name` may be in use only once at a time.
    fn lay(name: &str) -> Option<Self> {
        let id = std::process::id();
        let namespaces = ["hand", "rig"].map(|host| format!("{name}-{id}-{host}"));
        let [hand, rig] = &namespaces;
        let laid = ip(&format!("netns add {hand}"));
        // Created first, so that a partial set-up is removed on drop.
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

/// Cuts the cable for `seconds` while the hand moves, over TLS. With `by_itself`, the hand must resume automatically.
fn cut(name: &str, seconds: u64, by_itself: bool) {
    let setup = Setup::new(name).with(&[NO_HURRY]);
    let resume = format!(
        "control.resume={}",
        if by_itself { "fresh" } else { "told" }
    );
    let mut setup = setup.with(&[&resume]);
    let Some(cable) = Cable::lay(name) else {
        not_permitted("cutting a cable requires `ip` and permission to create network namespaces");
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
fn cut_cable_stops_the_hand_until_it_is_resumed() {
    cut("link-cable", 1, false);
}

/// The cut is long enough that both ends close the connection. It lasts a minute if `FEELER_LONG_TESTS` is set.
#[test]
fn programs_reconnect_after_a_long_cut() {
    cut("link-long-cable", if is_long() { 60 } else { 5 }, true);
}
