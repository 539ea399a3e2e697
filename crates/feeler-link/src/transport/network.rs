//! Network interface of a program, and an impaired network for tests.

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

/// Callback for received messages.
pub type MessageHandler = Arc<dyn Fn(Topic, &[u8]) + Send + Sync>;

/// Sends and receives messages.
pub trait Network: Outlet {
    /// Subscribes to `topic`. The callback runs on a thread of the network.
    ///
    /// # Errors
    /// If the subscription fails.
    fn listen(&self, topic: Topic, heard: MessageHandler) -> Result<(), LinkError>;
}

/// Impairment applied to received messages, parsed from text such as `loss=0.2,jitter=0.05`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Impairment {
    /// Probability that a message is lost.
    pub loss: f64,
    /// Probability that a message is duplicated.
    pub duplicate: f64,
    /// Delay of every message (s).
    pub delay: f64,
    /// Maximum additional random delay (s), which reorders messages.
    pub jitter: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl FromStr for Impairment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected loss, duplicate (0 to 1), delay, jitter (0 to 10 s) or seed, e.g. loss=0.2,jitter=0.05";
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

/// Wraps a network and injects loss, delay, duplication and reordering of received messages.
pub struct ImpairedNetwork {
    network: Arc<dyn Network>,
    rehearsal: Impairment,
    random: Arc<Mutex<Pcg64>>,
}

impl ImpairedNetwork {
    /// Creates a view of `network` with this impairment.
    pub fn new(network: Arc<dyn Network>, rehearsal: Impairment) -> Self {
        let random = Pcg64::seed_from_u64(rehearsal.seed);
        Self {
            network,
            rehearsal,
            random: Arc::new(Mutex::new(random)),
        }
    }
}

impl Outlet for ImpairedNetwork {
    fn send(&self, topic: Topic, bytes: Vec<u8>) -> Result<(), LinkError> {
        self.network.send(topic, bytes)
    }
}

impl Network for ImpairedNetwork {
    fn listen(&self, topic: Topic, heard: MessageHandler) -> Result<(), LinkError> {
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

impl Impairment {
    /// Forwards to `sender` the copies of a message that are not lost.
    fn strike(&self, random: &mut Pcg64, bytes: &[u8], sender: &Sender<Delayed>) {
        let copies = 1 + usize::from(random.random::<f64>() < self.duplicate);
        for _ in 0..copies {
            let late = self.delay + self.jitter * random.random::<f64>();
            if random.random::<f64>() >= self.loss {
                // The receiver is only gone when the program exits.
                let _ = sender.send(Delayed {
                    due: Instant::now() + Duration::from_secs_f64(late),
                    bytes: bytes.to_vec(),
                });
            }
        }
    }
}

/// Message in flight. The earliest due time compares greatest because `BinaryHeap` is a max-heap.
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

/// Delivers each message when it is due, until the channel is closed.
fn deliver(receiver: &Receiver<Delayed>, topic: Topic, heard: &MessageHandler) {
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
    fn rehearsal_is_parsed() {
        let read: Impairment = "loss=0.2, jitter=0.05,duplicate=0.1,delay=1,seed=7"
            .parse()
            .unwrap();
        let expected = Impairment {
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
            assert!(wrong.parse::<Impairment>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn messages_are_lost_repeated_and_reordered_at_the_given_rates() {
        let rehearsal = Impairment {
            loss: 0.2,
            duplicate: 0.1,
            jitter: 1.0,
            ..Impairment::default()
        };
        let (sender, receiver) = channel();
        let mut random = Pcg64::seed_from_u64(1);
        for n in 0..10_000_u32 {
            rehearsal.strike(&mut random, &n.to_le_bytes(), &sender);
        }
        drop(sender);
        let due: Vec<Instant> = receiver.into_iter().map(|delayed| delayed.due).collect();
        // 10,000 * 1.1 * 0.8, within six standard deviations of about 45.
        assert!(due.len().abs_diff(8800) < 270, "{}", due.len());
        let reordered = due.windows(2).filter(|pair| pair[1] < pair[0]).count();
        assert!(reordered > 3000, "{reordered}");
    }
}
