//! Exchange between a hand and its live pages: the latest state of the hand in one direction, orders in the other.
//! Neither side blocks.

use feeler_record::Felt;
use std::mem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

/// Capacity of the text of a [`Moment`] in bytes.
const WORDS: usize = 512;
/// Maximum time for which a page plays the rumble and tone of one row.
const LONGEST_PLAYED: Duration = Duration::from_millis(100);

/// State of the hand at one time. Its memory is allocated at construction.
#[derive(Debug, Clone)]
pub struct Moment {
    /// Time (s), or NaN if unknown.
    pub time: f64,
    /// Numbers of a row, without its time; incomplete if no data has arrived.
    pub numbers: Vec<f32>,
    /// Description of the hand's state.
    pub words: Words,
    /// `true` if the hand is stopped.
    pub stopped: bool,
    /// `true` for the final state.
    pub over: bool,
}

/// Text of fixed capacity, at which longer text is cut off.
#[derive(Debug, Clone)]
pub struct Words(String);

impl Words {
    /// The current text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Removes all text.
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

/// Orders from live pages since the last call of [`Feed::orders`].
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Orders {
    /// Source of a stop order, if any.
    pub stop: Option<String>,
    /// `true` if the hand must resume.
    pub resume: bool,
}

/// Exchange between a hand and its live pages.
pub struct Feed {
    /// Number of values in a row, without its time.
    width: usize,
    /// `true` if a page has requested the next state.
    wanted: AtomicBool,
    /// Latest state, and `true` if it has not been read.
    newest: Mutex<(Moment, bool)>,
    /// `true` if there are orders.
    ordered: AtomicBool,
    orders: Mutex<Orders>,
    /// `true` if `played` has not been read.
    was_played: AtomicBool,
    /// Latest report of rumble and tone, and the time of its arrival.
    played: Mutex<(Felt, Option<Instant>)>,
}

impl Feed {
    /// Creates a feed for rows with `width` values besides the time.
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
            // The recording starts with silence.
            was_played: AtomicBool::new(true),
            played: Mutex::new((Felt::SILENT, None)),
        }
    }

    /// Number of values in a row, without its time.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Calls `fill` to update the latest state, if a page has requested one and the latest is not being read.
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

    /// Calls `fill` to write the final state, even if no page has requested one.
    pub fn offer_last(&self, fill: impl FnOnce(&mut Moment)) {
        let mut newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        fill(&mut newest.0);
        newest.0.over = true;
        newest.1 = true;
    }

    /// Requests the next state.
    pub fn want(&self) {
        self.wanted.store(true, Ordering::Relaxed);
    }

    /// Calls `look` with the latest state if it has not been read. Returns `true` if it did.
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

    /// Orders the hand to stop, on behalf of `by`.
    pub fn stop(&self, by: &str) {
        self.order(|orders| orders.stop = Some(by.into()));
    }

    /// Orders the hand to resume.
    pub fn resume(&self) {
        self.order(|orders| orders.resume = true);
    }

    fn order(&self, order: impl FnOnce(&mut Orders)) {
        let mut orders = self.orders.lock().unwrap_or_else(PoisonError::into_inner);
        order(&mut orders);
        self.ordered.store(true, Ordering::Release);
    }

    /// Stores the rumble and tone that a page plays from now on.
    pub fn play(&self, felt: Felt) {
        let mut played = self.played.lock().unwrap_or_else(PoisonError::into_inner);
        *played = (felt, Some(Instant::now()));
        self.was_played.store(true, Ordering::Release);
    }

    /// Stores silence if the pages have not reported for longer than the time for which they play without new data.
    pub fn fade(&self) {
        let mut played = self.played.lock().unwrap_or_else(PoisonError::into_inner);
        let is_old = played.1.is_some_and(|at| at.elapsed() > LONGEST_PLAYED);
        if is_old && !played.0.is_silent() {
            *played = (Felt::SILENT, None);
            self.was_played.store(true, Ordering::Release);
        }
    }

    /// Takes the latest rumble and tone, if they have not been read. Those that are being stored at present are
    /// returned by the next call.
    pub fn felt(&self) -> Option<Felt> {
        if !self.was_played.load(Ordering::Acquire) {
            return None;
        }
        let played = free(&self.played)?;
        self.was_played.store(false, Ordering::Relaxed);
        Some(played.0)
    }

    /// Takes the orders since the last call. Orders that are being stored at present are returned by the next call.
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

/// Locks a mutex if it is free.
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
        feed.offer(|_| unreachable!("not requested"));
        feed.want();
        feed.offer(|moment| moment.time = 1.0);
        feed.offer(|_| unreachable!("not requested again"));
        assert_eq!(seen(&feed), Some(1.0));
        assert_eq!(seen(&feed), None);
        feed.want();
        feed.offer(|moment| moment.time = 2.0);
        assert_eq!(seen(&feed), Some(2.0));
    }

    #[test]
    fn offering_does_not_wait_for_a_reader() {
        let feed = Feed::new(1);
        feed.want();
        feed.offer(|moment| moment.time = 1.0);
        let taken = feed.take(|_| {
            feed.want();
            feed.offer(|_| unreachable!("being read"));
        });
        feed.offer_last(|moment| moment.time = 3.0);
        assert!(taken && feed.take(|moment| assert!(moment.over)));
    }

    #[test]
    fn orders_are_given_once_and_a_stop_names_its_source() {
        let feed = Feed::new(1);
        assert_eq!(feed.orders(), Orders::default());
        feed.resume();
        feed.stop("a page");
        let orders = Orders {
            stop: Some("a page".into()),
            resume: true,
        };
        assert_eq!(feed.orders(), orders);
        assert_eq!(feed.orders(), Orders::default());
    }

    #[test]
    fn played_rumble_is_taken_once_and_silence_first() {
        let feed = Feed::new(1);
        assert!(feed.felt().is_some_and(|felt| felt.is_silent()));
        assert_eq!(feed.felt(), None);
        let felt = Felt {
            rumble_strong: 0.5,
            ..Felt::default()
        };
        feed.play(felt);
        // Recent, so it does not fade yet.
        feed.fade();
        assert_eq!(feed.felt(), Some(felt));
        std::thread::sleep(LONGEST_PLAYED + Duration::from_millis(1));
        feed.fade();
        assert!(feed.felt().is_some_and(|felt| felt.is_silent()));
        feed.fade();
        assert_eq!(feed.felt(), None);
    }

    #[test]
    fn text_does_not_grow_its_buffer() {
        let mut words = Words(String::with_capacity(8));
        let capacity = words.0.capacity();
        for _ in 0..100 {
            write!(words, "µm").expect("words");
        }
        assert_eq!(words.0.capacity(), capacity);
        assert!(words.as_str().starts_with("µmµm"), "{words:?}");
    }
}
