//! Programs of a rig and their problems, from their heartbeats.

use crate::snapshot::{Program, ProgramState, UNKNOWN};
use feeler_link::inboxes::{Peer, Peers};
use feeler_link::messages::Mismatch;
use feeler_link::messages::message::{NO_FINGER, ProgramKind};

/// Lists the programs of a hand with `fingers` fingers: the expected ones first, then the rejected ones.
pub fn programs(peers: &Peers, fingers: usize, now: f64) -> Vec<Program> {
    let senses = (0..fingers).map(|finger| (ProgramKind::Sense, finger as u32));
    let places = senses.chain([
        (ProgramKind::Hand, NO_FINGER),
        (ProgramKind::World, NO_FINGER),
    ]);
    let in_place = places.map(|(name, finger)| {
        let heartbeats = peers.all().iter().filter(|peer| peer.refused.is_none());
        let mut there = heartbeats
            .filter(|peer| peer.heartbeat.program == name && peer.heartbeat.finger == finger);
        match there.next() {
            Some(peer) => program(peer, now),
            None => absent(name.as_str(), finger),
        }
    });
    in_place
        .chain(refused(peers, now).map(|(peer, _)| program(peer, now)))
        .collect()
}

/// Returns the live programs that are rejected, with the reason.
fn refused(peers: &Peers, now: f64) -> impl Iterator<Item = (&Peer, &Mismatch)> {
    let there = peers.all().iter().filter(move |peer| !peer.is_silent(now));
    there.filter_map(|peer| Some((peer, peer.refused.as_ref()?)))
}

/// Describes the problems of programs: those that have become silent, and those that are rejected.
pub fn warnings(peers: &Peers, now: f64) -> Vec<String> {
    let gone = |peer: &&Peer| peer.refused.is_none() && peer.works() && peer.is_silent(now);
    let gone = peers.all().iter().filter(gone).map(|peer| {
        let (name, since) = (peer.name(), now - peer.heard);
        format!("{name} silent for {since:.1} s")
    });
    let refused = refused(peers, now).map(|(peer, mismatch)| {
        let version = &peer.heartbeat.version;
        format!("refused, feeler {version}: {mismatch}")
    });
    gone.chain(refused).collect()
}

fn program(peer: &Peer, now: f64) -> Program {
    let heartbeat = &peer.heartbeat;
    let silent = peer.is_silent(now);
    let (rate, age) = if silent {
        (UNKNOWN, now - peer.heard)
    } else {
        (heartbeat.rate, heartbeat.age)
    };
    let state = match &peer.refused {
        Some(mismatch) => ProgramState::Refused {
            why: mismatch.to_string(),
        },
        None if silent => ProgramState::Silent,
        None => ProgramState::Alive,
    };
    Program {
        name: heartbeat.program.to_string(),
        finger: finger(heartbeat.finger),
        version: heartbeat.version.clone(),
        rate,
        age,
        received: None,
        lost: heartbeat.lost,
        late: Some(heartbeat.missed),
        state,
    }
}

/// Returns the entry of an expected program that has not been found yet.
fn absent(name: &str, number: u32) -> Program {
    Program {
        name: name.into(),
        finger: finger(number),
        version: String::new(),
        rate: UNKNOWN,
        age: UNKNOWN,
        received: None,
        lost: 0,
        late: None,
        state: ProgramState::Silent,
    }
}

fn finger(number: u32) -> Option<usize> {
    (number != NO_FINGER).then_some(number as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use feeler_link::inboxes::Expected;
    use feeler_link::messages::message::{Heartbeat, PROTOCOL};
    use feeler_record::wire::cdr;

    fn hear(peers: &mut Peers, program: &str, instance: u64, experiment: &str, now: f64) {
        let heartbeat = Heartbeat {
            protocol: PROTOCOL,
            instance,
            program: program.into(),
            version: "9.9.9".into(),
            finger: NO_FINGER,
            experiment: experiment.into(),
            sequence: 1,
            rate: 50.0,
            ..Heartbeat::default()
        };
        let mut bytes = Vec::new();
        cdr::encode(&heartbeat, &mut bytes).expect("bytes");
        peers
            .heard(heartbeat.place().expect("a place"), &bytes, now)
            .expect("a heartbeat");
    }

    #[test]
    fn silent_refused_and_absent_programs_are_distinguished() {
        let mut peers = Peers::new(Expected {
            experiment: "ours".into(),
            ..Expected::default()
        });
        hear(&mut peers, "hand", 1, "ours", 0.0);
        hear(&mut peers, "world", 2, "another", 3.0);
        let shown = programs(&peers, 1, 3.5);
        let states: Vec<_> = shown
            .iter()
            .map(|program| (program.name.as_str(), program.state.clone(), program.age))
            .collect();
        assert_eq!(states[1], ("hand", ProgramState::Silent, 3.5));
        for (index, name) in [(0, "sense"), (2, "world")] {
            assert_eq!(
                (states[index].0, &states[index].1),
                (name, &ProgramState::Silent)
            );
            assert!(states[index].2.is_nan(), "{states:?}");
        }
        assert!(matches!(
            states[3],
            ("world", ProgramState::Refused { .. }, _)
        ));
        let warnings = warnings(&peers, 3.5);
        assert_eq!(warnings[0], "hand silent for 3.5 s");
        assert!(warnings[1].starts_with("refused, feeler 9.9.9: world runs experiment another"));
    }
}
