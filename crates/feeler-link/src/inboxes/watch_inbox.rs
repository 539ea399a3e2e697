//! Messages received by a passive observer of a rig: heartbeats, forces, joint states and the hand's mode.
//!
//! An observer sends nothing, so it does not affect the rig.

use super::hand_inbox::flags;
use super::inbox::Inbox;
use super::peers::{Expected, Peers};
use crate::messages::decode::read;
use crate::messages::joints::JointCounts;
use crate::messages::message::{
    HandMode, Heartbeat, NO_FINGER, ProgramKind, StateMessage, TactileUpdate,
};
use crate::messages::plausible::{check_protocol, check_state, check_update};
use crate::messages::rejection::{Rejection, Rejections};
use crate::messages::sequence::Sequence;
use crate::transport::topic::Topic;
use feeler::control::FingerFlags;
use feeler_record::wire::cdr;

/// Inbox of a passive observer.
#[derive(Debug, Clone)]
pub struct WatchInbox {
    elements: Vec<usize>,
    /// Configuration that programs must match: the experiment of the hand or, until a hand appears, of the first
    /// program.
    expected: Expected,
    peers: Peers,
    fingers: Vec<Option<TactileUpdate>>,
    mode: Option<HandMode>,
    state: Option<StateMessage>,
    /// Sequence number of the latest update of each finger.
    updates: Vec<Sequence>,
    /// Sequence number of the latest state.
    states: Sequence,
    /// Sequence number of the latest mode.
    modes: Sequence,
    /// Number of force and joint messages lost by this observer. The hand may have received them.
    pub missed: u64,
    /// Counters of rejected messages.
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
    /// Creates an empty inbox for a rig with the given number of elements, fingertip hash (SHA-256) and number of joints
    /// of each finger.
    pub fn new(elements: &[usize], fingertips: Vec<String>, joints: JointCounts) -> Self {
        let expected = Expected {
            experiment: String::new(),
            fingertips,
            joints,
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

    /// Returns the topics to subscribe to.
    pub fn topics(&self) -> Vec<Topic> {
        let fingers = (0..self.fingers.len()).map(Topic::Tactile);
        let others = [Topic::State, Topic::Mode].into_iter().chain(fingers);
        others.chain(Topic::heartbeats()).collect()
    }

    /// Returns the SHA-256 of the rig's experiment; empty until a program has been found.
    pub fn experiment(&self) -> &str {
        &self.expected.experiment
    }

    /// Returns the latest flags and tactile update of `finger`.
    pub fn finger(&self, finger: usize) -> Option<(FingerFlags, &TactileUpdate)> {
        let update = self.fingers.get(finger)?.as_ref()?;
        Some((flags(update), update))
    }

    /// Returns the latest mode of the hand.
    pub fn mode(&self) -> Option<&HandMode> {
        self.mode.as_ref()
    }

    /// Returns the latest joint state.
    pub fn state(&self) -> Option<&StateMessage> {
        self.state.as_ref()
    }

    /// Uses the experiment of the hand or, until a hand appears, of the first program. After a change, all programs are
    /// checked again at their next heartbeats.
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
        let missed = self.updates[finger].accept(update.header.number(), now)?;
        self.missed = self.missed.saturating_add(missed);
        self.fingers[finger] = Some(update);
        Ok(())
    }

    fn take_state(&mut self, state: StateMessage, now: f64) -> Result<(), Rejection> {
        check_state(self.fingers.len(), self.peers.joints(), &state)?;
        self.peers
            .check(state.header.instance, &ProgramKind::World, NO_FINGER)?;
        let missed = self.states.accept(state.header.number(), now)?;
        self.missed = self.missed.saturating_add(missed);
        self.state = Some(state);
        Ok(())
    }

    /// Stores a mode. Gaps in the sequence numbers do not count as losses, because the hand does not send every mode.
    fn take_mode(&mut self, mut mode: HandMode, now: f64) -> Result<(), Rejection> {
        self.peers.check_hand(mode.header)?;
        self.modes.accept(mode.header.number(), now)?;
        mode.make_printable();
        self.mode = Some(mode);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::message::PROTOCOL;
    use crate::transport::outlet::header;
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
    fn the_experiment_of_the_hand_is_adopted() {
        let mut inbox = WatchInbox::new(&[], Vec::new(), JointCounts::default());
        let mut hear = |program, instance, experiment, sequence| {
            let (topic, heard) = heartbeat(program, instance, experiment, sequence);
            inbox.take(topic, &heard, 0.1).expect("accepted");
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
    fn losses_are_counted_and_unknown_senders_and_duplicates_are_rejected() {
        let mut inbox = WatchInbox::new(&[], Vec::new(), JointCounts::default());
        let (topic, world) = heartbeat("world", 1, "ours", 1);
        inbox.take(topic, &world, 0.1).expect("accepted");
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
