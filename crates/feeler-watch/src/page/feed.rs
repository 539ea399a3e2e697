//! What passes between a hand and those who look at it: the newest moment one way, orders the other. Neither side waits.

use std::mem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Bytes of words that a moment has room for.
const WORDS: usize = 512;

/// What is to be seen at one time. Its memory is there from the beginning.
#[derive(Debug, Clone)]
pub struct Moment {
    /// Time, s; not a number where none is known.
    pub time: f64,
    /// The numbers of a row after its time; too few where nothing is known yet.
    pub numbers: Vec<f32>,
    /// What the hand is about.
    pub words: Words,
    /// Whether the hand is stopped.
    pub stopped: bool,
    /// Whether this is the end.
    pub over: bool,
}

/// Words in memory that does not grow: what does not fit is left out.
#[derive(Debug, Clone)]
pub struct Words(String);

impl Words {
    /// The words so far.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Begins anew.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

impl std::fmt::Write for Words {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        let room = self.0.capacity() - self.0.len();
        let mut end = text.len().min(room);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        self.0.push_str(&text[..end]);
        Ok(())
    }
}

/// What those who look want done since they were asked last.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Orders {
    /// Who wants the hand stopped.
    pub stop: Option<String>,
    /// Whether the hand is to go on.
    pub resume: bool,
}

/// Between a hand and those who look at it.
pub struct Feed {
    /// Numbers of a row after its time.
    width: usize,
    /// Whether somebody waits for a moment.
    wanted: AtomicBool,
    /// The newest moment, and whether nobody has seen it.
    newest: Mutex<(Moment, bool)>,
    /// Whether there are orders.
    ordered: AtomicBool,
    orders: Mutex<Orders>,
}

impl Feed {
    /// For rows of `width` numbers after the time.
    pub fn new(width: usize) -> Self {
        let moment = Moment {
            time: f64::NAN,
            numbers: Vec::with_capacity(width),
            words: Words(String::with_capacity(WORDS)),
            stopped: false,
            over: false,
        };
        Self {
            width,
            wanted: AtomicBool::new(false),
            newest: Mutex::new((moment, false)),
            ordered: AtomicBool::new(false),
            orders: Mutex::default(),
        }
    }

    /// Numbers of a row after its time.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Lets `fill` write the newest moment, if somebody waits for one and does not look at this very moment.
    pub fn offer(&self, fill: impl FnOnce(&mut Moment)) {
        if !self.wanted.load(Ordering::Relaxed) {
            return;
        }
        if let Some(mut newest) = free(&self.newest) {
            self.wanted.store(false, Ordering::Relaxed);
            fill(&mut newest.0);
            newest.1 = true;
        }
    }

    /// The same for the last one, whether somebody waits or not.
    pub fn offer_last(&self, fill: impl FnOnce(&mut Moment)) {
        let mut newest = self
            .newest
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        fill(&mut newest.0);
        newest.0.over = true;
        newest.1 = true;
    }

    /// Asks for the next moment that there is.
    pub fn want(&self) {
        self.wanted.store(true, Ordering::Relaxed);
    }

    /// Lets `look` see the newest moment, if nobody has seen it; whether it did.
    pub fn take(&self, look: impl FnOnce(&Moment)) -> bool {
        let Some(mut newest) = free(&self.newest) else {
            return false;
        };
        let is_new = mem::take(&mut newest.1);
        if is_new {
            look(&newest.0);
        }
        is_new
    }

    /// Says that the hand is to stop, and who says so.
    pub fn stop(&self, by: &str) {
        self.order(|orders| orders.stop = Some(by.into()));
    }

    /// Says that the hand is to go on.
    pub fn resume(&self) {
        self.order(|orders| orders.resume = true);
    }

    fn order(&self, order: impl FnOnce(&mut Orders)) {
        let mut orders = self
            .orders
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        order(&mut orders);
        self.ordered.store(true, Ordering::Release);
    }

    /// What was ordered since the last call. Orders that are being given at this very moment come with the next.
    pub fn orders(&self) -> Orders {
        if !self.ordered.load(Ordering::Acquire) {
            return Orders::default();
        }
        free(&self.orders).map_or_else(Orders::default, |mut orders| {
            self.ordered.store(false, Ordering::Relaxed);
            mem::take(&mut *orders)
        })
    }
}

/// What is behind a lock that nobody holds.
fn free<T>(lock: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    match lock.try_lock() {
        Ok(guard) => Some(guard),
        Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    fn seen(feed: &Feed) -> Option<f64> {
        let mut time = None;
        feed.take(|moment| time = Some(moment.time));
        time
    }

    #[test]
    fn a_moment_is_filled_when_it_is_wanted_and_seen_once() {
        let feed = Feed::new(1);
        feed.offer(|_| unreachable!("nobody asked"));
        feed.want();
        feed.offer(|moment| moment.time = 1.0);
        feed.offer(|_| unreachable!("nobody asked again"));
        assert_eq!(seen(&feed), Some(1.0));
        assert_eq!(seen(&feed), None);
        feed.want();
        feed.offer(|moment| moment.time = 2.0);
        assert_eq!(seen(&feed), Some(2.0));
    }

    #[test]
    fn nobody_waits_for_who_looks() {
        let feed = Feed::new(1);
        feed.want();
        feed.offer(|moment| moment.time = 1.0);
        let taken = feed.take(|_| {
            feed.want();
            feed.offer(|_| unreachable!("somebody looks"));
        });
        feed.offer_last(|moment| moment.time = 3.0);
        assert!(taken && feed.take(|moment| assert!(moment.over)));
    }

    #[test]
    fn orders_are_given_once_and_a_stop_says_whose_it_is() {
        let feed = Feed::new(1);
        assert_eq!(feed.orders(), Orders::default());
        feed.resume();
        feed.stop("somebody");
        let orders = Orders {
            stop: Some("somebody".into()),
            resume: true,
        };
        assert_eq!(feed.orders(), orders);
        assert_eq!(feed.orders(), Orders::default());
    }

    #[test]
    fn words_stay_in_their_memory() {
        let mut words = Words(String::with_capacity(8));
        let capacity = words.0.capacity();
        for _ in 0..100 {
            write!(words, "µm").expect("words");
        }
        assert_eq!(words.0.capacity(), capacity);
        assert!(words.as_str().starts_with("µmµm"), "{words:?}");
    }
}
