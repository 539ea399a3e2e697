//! Warnings on standard error: printed immediately, or queued so that a paused terminal or a full pipe does not block
//! the program.

use feeler_link::programs::Warn;
use std::io::{Write, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Prints a warning on standard error immediately. For commands that may block.
pub fn warn(warning: &str) {
    // A closed standard error is not a reason to stop.
    let _ = writeln!(stderr(), "warning: {warning}");
}

/// Capacity of the queue.
const WAITING: usize = 64;

/// Time to wait at the program's end for queued warnings to be printed.
const LAST: Duration = Duration::from_secs(1);

/// A queue of warnings, printed one per line. Warnings that do not fit are dropped and counted.
#[derive(Clone)]
pub struct Warnings(Arc<Queue>);

struct Queue {
    lines: Option<SyncSender<String>>,
    dropped: Arc<AtomicU64>,
    /// Disconnects when the printing thread ends.
    ended: Mutex<Receiver<()>>,
}

impl Warnings {
    /// Creates a queue that prints on standard error.
    pub fn on_stderr() -> Self {
        Self::shown_by(|line| {
            // If standard error is closed, exit status and recording still report the problem.
            let _ = writeln!(stderr(), "{line}");
        })
    }

    /// Creates a queue that passes warnings to `show` on a background thread.
    pub fn shown_by(mut show: impl FnMut(&str) + Send + 'static) -> Self {
        let (lines, waiting) = sync_channel::<String>(WAITING);
        let (ends, ended) = channel::<()>();
        let dropped = Arc::new(AtomicU64::new(0));
        let unseen = Arc::clone(&dropped);
        let show_all = move || {
            let _ends = ends;
            for line in waiting {
                show(&line);
                let count = unseen.swap(0, Ordering::Relaxed);
                if count > 0 {
                    show(&format!(
                        "{count} warnings were dropped because they were not read in time"
                    ));
                }
            }
        };
        let thread = thread::Builder::new().name("warnings".into());
        // If the thread cannot be started, warnings are not shown.
        let lines = thread.spawn(show_all).ok().map(|_| lines);
        Self(Arc::new(Queue {
            lines,
            dropped,
            ended: Mutex::new(ended),
        }))
    }

    /// Queues `warning`. Never blocks.
    pub fn say(&self, warning: &str) {
        let queue = &*self.0;
        let taken = |lines: &SyncSender<String>| lines.try_send(warning.into()).is_ok();
        if !queue.lines.as_ref().is_some_and(taken) {
            queue.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Returns a function that queues warnings, for a program of a rig.
    pub fn warn(&self) -> Warn {
        let warnings = self.clone();
        Box::new(move |warning| warnings.say(warning))
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        self.lines = None;
        let ended = self.ended.get_mut().unwrap_or_else(PoisonError::into_inner);
        // An error means that the thread has ended or takes too long.
        let _ = ended.recv_timeout(LAST);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a queue that shows one warning per permit, and the list of shown warnings.
    fn gated() -> (
        Warnings,
        std::sync::mpsc::Sender<()>,
        Arc<Mutex<Vec<String>>>,
    ) {
        let (permit, permits) = channel();
        let shown = Arc::new(Mutex::new(Vec::new()));
        let lines = Arc::clone(&shown);
        let warnings = Warnings::shown_by(move |line| {
            let _ = permits.recv();
            lines.lock().unwrap().push(line.to_string());
        });
        (warnings, permit, shown)
    }

    #[test]
    fn a_paused_terminal_does_not_block_and_drops_are_reported() {
        let (warnings, permit, shown) = gated();
        let said = 2 * WAITING;
        for number in 0..said {
            warnings.say(&format!("warning {number}"));
        }
        drop(permit);
        drop(warnings);
        let shown = shown.lock().unwrap();
        let dropped = shown.iter().find_map(|line| {
            let count =
                line.strip_suffix(" warnings were dropped because they were not read in time")?;
            count.parse::<usize>().ok()
        });
        // One line reports the number of dropped warnings.
        assert_eq!(shown.len() - 1 + dropped.unwrap(), said, "{shown:?}");
        assert_eq!(shown[0], "warning 0");
    }

    #[test]
    fn queued_warnings_are_shown_at_the_end() {
        let (warnings, permit, shown) = gated();
        let mut warn = warnings.warn();
        drop(warnings);
        warn("the last");
        drop(permit);
        drop(warn);
        assert_eq!(*shown.lock().unwrap(), ["the last"]);
    }
}
