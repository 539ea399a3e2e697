//! What somebody who only watches a rig has heard: every program, forces, joint angles and the hand's mode.
//!
//! Nothing of it is answered, so no program of the rig can tell whether it is watched.

use super::hand_inbox::flags;
use super::inbox::{Inbox, read};
use super::message::{
    HandMode, Heartbeat, MessageHeader, NO_FINGER, ProgramKind, StateMessage, TactileUpdate,
};
use super::peers::{Expected, Peers};
use super::plausible::{check_protocol, check_state, check_update};
use super::rejection::{Rejection, Rejections};
use super::sequence::Sequence;
use super::topic::Topic;
use feeler::control::flags::FingerFlags;
use feeler_record::wire::cdr;

/// Everything that has arrived for somebody who watches.
#[derive(Debug, Clone)]
pub struct WatchInbox {
    elements: Vec<usize>,
    /// What the programs must agree in: the experiment of the rig's hand, or of whoever was heard first.
    expected: Expected,
    peers: Peers,
    fingers: Vec<Option<TactileUpdate>>,
    mode: Option<HandMode>,
    state: Option<StateMessage>,
    /// The newest of each finger's updates, of the states and of the modes.
    updates: Vec<Sequence>,
    states: Sequence,
    modes: Sequence,
    /// Updates of forces and joints that never came here, by their numbers. They may have come to the hand.
    pub missed: u64,
    /// What was not taken.
    pub rejected: Rejections,
}

impl Inbox for WatchInbox {
    fn take_in(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection> {
        match topic {
            Topic::Heartbeat(place) => {
                self.agree(bytes, now);
                self.peers.heard(place, bytes, now).map(|_| ())
            }
            Topic::Tactile(finger) => {
                read(bytes).and_then(|update| self.take_update(finger, update, now))
            }
            Topic::State => read(bytes).and_then(|state| self.take_state(state, now)),
            Topic::Mode => read(bytes).and_then(|mode| self.take_mode(mode, now)),
            _ => Err(Rejection::Stranger),
        }
    }

    fn peers(&self) -> &Peers {
        &self.peers
    }

    fn rejected(&mut self) -> &mut Rejections {
        &mut self.rejected
    }
}

impl WatchInbox {
    /// Nothing has arrived yet of a rig whose fingers have so many `elements` and whose fingertips are
    /// `fingertips` (SHA-256).
    pub fn new(elements: &[usize], fingertips: Vec<String>) -> Self {
        let expected = Expected {
            experiment: String::new(),
            fingertips,
            speed: None,
        };
        Self {
            elements: elements.to_vec(),
            peers: Peers::new(expected.clone()),
            expected,
            fingers: vec![None; elements.len()],
            mode: None,
            state: None,
            updates: vec![Sequence::default(); elements.len()],
            states: Sequence::default(),
            modes: Sequence::default(),
            missed: 0,
            rejected: Rejections::default(),
        }
    }

    /// The topics that are taken in.
    pub fn topics(&self) -> Vec<Topic> {
        let fingers = (0..self.fingers.len()).map(Topic::Tactile);
        let others = [Topic::State, Topic::Mode].into_iter().chain(fingers);
        others.chain(Topic::heartbeats()).collect()
    }

    /// The experiment (SHA-256) that the rig works by; empty before a program of it was heard.
    pub fn experiment(&self) -> &str {
        &self.expected.experiment
    }

    /// What `finger` felt last.
    pub fn finger(&self, finger: usize) -> Option<(FingerFlags, &TactileUpdate)> {
        let update = self.fingers.get(finger)?.as_ref()?;
        Some((flags(update), update))
    }

    /// What the hand was about last.
    pub fn mode(&self) -> Option<&HandMode> {
        self.mode.as_ref()
    }

    /// Where the joints were last.
    pub fn state(&self) -> Option<&StateMessage> {
        self.state.as_ref()
    }

    /// Whoever only watches has no say in what the experiment is. That of the hand counts, and before one
    /// is there, that of whoever came first; then all are judged anew by their next heartbeats.
    fn agree(&mut self, bytes: &[u8], now: f64) {
        let Ok(heartbeat) = cdr::decode::<Heartbeat>(bytes) else {
            return;
        };
        let is_first = self.expected.experiment.is_empty() && !heartbeat.experiment.is_empty();
        let leads = heartbeat.program == ProgramKind::Hand
            && self.peers.taken(ProgramKind::Hand, now).next().is_none();
        let is_sound = check_protocol(heartbeat.protocol).is_ok();
        if is_sound && (is_first || leads) && heartbeat.experiment != self.expected.experiment {
            self.expected.experiment = heartbeat.experiment;
            self.peers = Peers::new(self.expected.clone());
        }
    }

    fn take_update(
        &mut self,
        finger: usize,
        update: TactileUpdate,
        now: f64,
    ) -> Result<(), Rejection> {
        let elements = *self.elements.get(finger).ok_or(Rejection::Size)?;
        check_update(finger, elements, &update)?;
        self.peers
            .check(update.header.instance, &ProgramKind::Sense, update.finger)?;
        let missed = follow(&mut self.updates[finger], update.header, now)?;
        self.missed = self.missed.saturating_add(missed);
        self.fingers[finger] = Some(update);
        Ok(())
    }

    fn take_state(&mut self, state: StateMessage, now: f64) -> Result<(), Rejection> {
        check_state(self.fingers.len(), &state)?;
        self.peers
            .check(state.header.instance, &ProgramKind::World, NO_FINGER)?;
        let missed = follow(&mut self.states, state.header, now)?;
        self.missed = self.missed.saturating_add(missed);
        self.state = Some(state);
        Ok(())
    }

    /// The hand tells no more modes than others need, so that numbers that are left out are not missed.
    fn take_mode(&mut self, mut mode: HandMode, now: f64) -> Result<(), Rejection> {
        check_protocol(mode.header.protocol)?;
        self.peers
            .check(mode.header.instance, &ProgramKind::Hand, NO_FINGER)?;
        follow(&mut self.modes, mode.header, now)?;
        mode.make_printable();
        self.mode = Some(mode);
        Ok(())
    }
}

/// How many messages are missing before that of `header`, which came at `now`, s.
fn follow(sequence: &mut Sequence, header: MessageHeader, now: f64) -> Result<u64, Rejection> {
    let number = (header.instance, header.sequence);
    let missing = sequence.missing(number, now)?;
    sequence.take(number, now);
    Ok(missing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::PROTOCOL;
    use crate::outlet::header;
    use feeler_record::wire::Message;

    fn bytes<M: Message>(message: &M) -> Vec<u8> {
        let mut bytes = Vec::new();
        cdr::encode(message, &mut bytes).expect("bytes");
        bytes
    }

    fn heartbeat(
        program: &str,
        instance: u64,
        experiment: &str,
        sequence: u64,
    ) -> (Topic, Vec<u8>) {
        let heartbeat = Heartbeat {
            protocol: PROTOCOL,
            instance,
            program: program.into(),
            finger: NO_FINGER,
            experiment: experiment.into(),
            sequence,
            ..Heartbeat::default()
        };
        let place = heartbeat.place().expect("a place");
        (Topic::Heartbeat(place), bytes(&heartbeat))
    }

    fn state(instance: u64, sequence: u64) -> Vec<u8> {
        bytes(&StateMessage {
            header: header(instance, sequence, 1.0),
            ..StateMessage::default()
        })
    }

    #[test]
    fn the_hand_says_what_the_experiment_is() {
        let mut inbox = WatchInbox::new(&[], Vec::new());
        let mut hear = |program, instance, experiment, sequence| {
            let (topic, heard) = heartbeat(program, instance, experiment, sequence);
            inbox.take(topic, &heard, 0.1).expect("heard");
            let refused = inbox.peers.all().last().map(|peer| peer.refused.is_some());
            (inbox.experiment().to_string(), refused)
        };
        let here = |experiment: &str, refused| (experiment.to_string(), Some(refused));
        assert_eq!(hear("world", 1, "other", 1), here("other", false));
        assert_eq!(hear("hand", 2, "ours", 1), here("ours", false));
        assert_eq!(hear("world", 1, "other", 2), here("ours", true));
        assert_eq!(hear("hand", 3, "third", 1), here("ours", true));
    }

    #[test]
    fn what_is_missing_is_counted_and_nothing_is_taken_of_strangers_or_twice() {
        let mut inbox = WatchInbox::new(&[], Vec::new());
        let (topic, world) = heartbeat("world", 1, "ours", 1);
        inbox.take(topic, &world, 0.1).expect("heard");
        let mut take = |instance, sequence| {
            let taken = inbox.take(Topic::State, &state(instance, sequence), 0.2);
            (taken, inbox.missed)
        };
        assert_eq!(take(1, 5), (Ok(()), 0));
        assert_eq!(take(1, 6), (Ok(()), 0));
        assert_eq!(take(1, 9), (Ok(()), 2));
        assert_eq!(take(1, 9), (Err(Rejection::Old), 2));
        assert_eq!(take(2, 20), (Err(Rejection::Unintroduced), 2));
        assert_eq!(inbox.state().map(|state| state.header.sequence), Some(9));
        assert_eq!(
            inbox.take(Topic::Stop, &[], 0.2),
            Err(Rejection::Stranger),
            "it takes no orders"
        );
    }
}
