//! Other programs, as one program sees them; and a bad network to rehearse on.

use super::endpoints::LinkError;
use super::outlet::Outlet;
use super::topic::Topic;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::str::FromStr;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Takes in a message of a topic.
pub type Heard = Arc<dyn Fn(Topic, &[u8]) + Send + Sync>;

/// Carries messages both ways.
pub trait Network: Outlet {
    /// Calls `heard` with every message of `topic`, on a thread of the network's.
    ///
    /// # Errors
    /// When nothing can be heard.
    fn listen(&self, topic: Topic, heard: Heard) -> Result<(), LinkError>;
}

/// How bad the network is: what becomes of each message that arrives. Written as in
/// `loss=0.2,jitter=0.05`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Rehearsal {
    /// Part of the messages that is lost.
    pub loss: f64,
    /// Part of the messages that arrives twice.
    pub duplicate: f64,
    /// How long every message takes, s.
    pub delay: f64,
    /// How much longer it takes at most, s, so that messages overtake each other.
    pub jitter: f64,
    /// Which messages it strikes.
    pub seed: u64,
}

impl FromStr for Rehearsal {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected loss, duplicate (0 to 1), delay, jitter (0 to 10 s) or seed, as in loss=0.2,jitter=0.05";
        let mut rehearsal = Self::default();
        for part in text.split(',') {
            let (key, value) = part.split_once('=').ok_or(expected)?;
            let between = |most: f64| {
                let number = value.trim().parse().ok();
                number.filter(|n| (0.0..=most).contains(n)).ok_or(expected)
            };
            match key.trim() {
                "loss" => rehearsal.loss = between(1.0)?,
                "duplicate" => rehearsal.duplicate = between(1.0)?,
                "delay" => rehearsal.delay = between(10.0)?,
                "jitter" => rehearsal.jitter = between(10.0)?,
                "seed" => rehearsal.seed = value.trim().parse().map_err(|_| expected)?,
                _ => return Err(expected.into()),
            }
        }
        Ok(rehearsal)
    }
}

/// A network that loses, delays, repeats and reorders what arrives over another.
pub struct RehearsedNetwork {
    network: Arc<dyn Network>,
    rehearsal: Rehearsal,
    random: Arc<Mutex<Pcg64>>,
}

impl RehearsedNetwork {
    /// `network`, as bad as `rehearsal` says.
    pub fn new(network: Arc<dyn Network>, rehearsal: Rehearsal) -> Self {
        let random = Pcg64::seed_from_u64(rehearsal.seed);
        Self {
            network,
            rehearsal,
            random: Arc::new(Mutex::new(random)),
        }
    }
}

impl Outlet for RehearsedNetwork {
    fn send(&self, topic: Topic, bytes: Vec<u8>) -> Result<(), LinkError> {
        self.network.send(topic, bytes)
    }
}

impl Network for RehearsedNetwork {
    fn listen(&self, topic: Topic, heard: Heard) -> Result<(), LinkError> {
        let (sender, receiver) = channel();
        let work = move || deliver(&receiver, topic, &heard);
        thread::Builder::new()
            .name("rehearsal".into())
            .spawn(work)
            .map_err(|e| LinkError::Transport(e.to_string()))?;
        let (rehearsal, random) = (self.rehearsal, Arc::clone(&self.random));
        let strike = move |_: Topic, bytes: &[u8]| {
            let mut random = random.lock().unwrap_or_else(PoisonError::into_inner);
            rehearsal.strike(&mut random, bytes, &sender);
        };
        self.network.listen(topic, Arc::new(strike))
    }
}

impl Rehearsal {
    /// Sends on what becomes of a message.
    fn strike(&self, random: &mut Pcg64, bytes: &[u8], sender: &Sender<Delayed>) {
        let copies = 1 + usize::from(random.random::<f64>() < self.duplicate);
        for _ in 0..copies {
            let late = self.delay + self.jitter * random.random::<f64>();
            if random.random::<f64>() >= self.loss {
                // The receiver is gone only when the program is ending.
                let _ = sender.send(Delayed {
                    due: Instant::now() + Duration::from_secs_f64(late),
                    bytes: bytes.to_vec(),
                });
            }
        }
    }
}

/// A message on its way. The earliest due is the greatest, as the heap wants it.
#[derive(PartialEq, Eq)]
struct Delayed {
    due: Instant,
    bytes: Vec<u8>,
}

impl Ord for Delayed {
    fn cmp(&self, other: &Self) -> Ordering {
        other.due.cmp(&self.due)
    }
}

impl PartialOrd for Delayed {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Hands on each message when it is due, until no more can come.
fn deliver(receiver: &Receiver<Delayed>, topic: Topic, heard: &Heard) {
    let mut waiting = BinaryHeap::new();
    loop {
        let next = waiting.peek().map(|next: &Delayed| next.due);
        let left = next.map(|due| due.saturating_duration_since(Instant::now()));
        match receiver.recv_timeout(left.unwrap_or(Duration::from_secs(1))) {
            Ok(delayed) => waiting.push(delayed),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        let now = Instant::now();
        while waiting.peek().is_some_and(|next| next.due <= now) {
            if let Some(next) = waiting.pop() {
                heard(topic, &next.bytes);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rehearsal_is_read_from_its_words() {
        let read: Rehearsal = "loss=0.2, jitter=0.05,duplicate=0.1,delay=1,seed=7"
            .parse()
            .unwrap();
        let expected = Rehearsal {
            loss: 0.2,
            duplicate: 0.1,
            delay: 1.0,
            jitter: 0.05,
            seed: 7,
        };
        assert_eq!(read, expected);
        for wrong in [
            "",
            "loss",
            "loss=2",
            "loss=-0.1",
            "jitter=nan",
            "cut=1",
            "seed=x",
        ] {
            assert!(wrong.parse::<Rehearsal>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn messages_are_lost_repeated_and_reordered_as_often_as_asked() {
        let rehearsal = Rehearsal {
            loss: 0.2,
            duplicate: 0.1,
            jitter: 1.0,
            ..Rehearsal::default()
        };
        let (sender, receiver) = channel();
        let mut random = Pcg64::seed_from_u64(1);
        for n in 0..10_000_u32 {
            rehearsal.strike(&mut random, &n.to_le_bytes(), &sender);
        }
        drop(sender);
        let due: Vec<Instant> = receiver.into_iter().map(|delayed| delayed.due).collect();
        // 10,000 * 1.1 * 0.8, and six standard deviations of some 45.
        assert!(due.len().abs_diff(8800) < 270, "{}", due.len());
        let reordered = due.windows(2).filter(|pair| pair[1] < pair[0]).count();
        assert!(reordered > 3000, "{reordered}");
    }
}
