//! Warnings on standard error: printed at once, or queued so that a paused terminal or full pipe blocks no caller.

use std::io::{Write, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Prints a warning on standard error at once. Blocks while standard error is blocked.
pub fn warn(warning: &str) {
    // A closed standard error does not end the program.
    let _ = writeln!(stderr(), "warning: {warning}");
}

/// Maximum number of queued warnings.
const CAPACITY: usize = 64;

/// Maximum time to wait for queued warnings when the program ends.
const FLUSH_LIMIT: Duration = Duration::from_secs(1);

/// Queue of warnings that a background thread prints, one per line. Warnings that do not fit are dropped and counted.
#[derive(Clone)]
pub struct Warnings(Arc<Queue>);

struct Queue {
    lines: Option<SyncSender<String>>,
    dropped: Arc<AtomicU64>,
    /// Disconnects when the printing thread ends.
    ended: Mutex<Receiver<()>>,
}

impl Warnings {
    /// Creates a queue whose warnings are printed on standard error.
    pub fn on_stderr() -> Self {
        Self::shown_by(|line| {
            // If standard error is closed, the exit status and the recording report the problem.
            let _ = writeln!(stderr(), "{line}");
        })
    }

    /// Creates a queue whose warnings are passed to `show` on a background thread.
    pub fn shown_by(mut show: impl FnMut(&str) + Send + 'static) -> Self {
        let (lines, waiting) = sync_channel::<String>(CAPACITY);
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
        // Without a thread there is no queue, and nothing is printed.
        let lines = thread.spawn(show_all).ok().map(|_| lines);
        Self(Arc::new(Queue {
            lines,
            dropped,
            ended: Mutex::new(ended),
        }))
    }

    /// Queues `warning`; never blocks.
    pub fn queue(&self, warning: &str) {
        let queue = &*self.0;
        let taken = |lines: &SyncSender<String>| lines.try_send(warning.into()).is_ok();
        if !queue.lines.as_ref().is_some_and(taken) {
            queue.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Returns a callback that queues warnings.
    pub fn warn(&self) -> Box<dyn FnMut(&str) + Send> {
        let warnings = self.clone();
        Box::new(move |warning| warnings.queue(warning))
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        self.lines = None;
        let ended = self.ended.get_mut().unwrap_or_else(PoisonError::into_inner);
        // The thread never sends: this returns when it ends, or after the limit.
        let _ = ended.recv_timeout(FLUSH_LIMIT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Warnings printed one for each permit, and the list of printed warnings.
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
    fn a_blocked_terminal_blocks_no_caller_and_gets_the_dropped_count() {
        let (warnings, permit, shown) = gated();
        let queued = 2 * CAPACITY;
        for number in 0..queued {
            warnings.queue(&format!("warning {number}"));
        }
        drop(permit);
        drop(warnings);
        let shown = shown.lock().unwrap();
        let dropped = shown.iter().find_map(|line| {
            let count =
                line.strip_suffix(" warnings were dropped because they were not read in time")?;
            count.parse::<usize>().ok()
        });
        // One of the lines reports the number of dropped warnings.
        assert_eq!(shown.len() - 1 + dropped.unwrap(), queued, "{shown:?}");
        assert_eq!(shown[0], "warning 0");
    }

    #[test]
    fn queued_warnings_are_printed_at_the_end() {
        let (warnings, permit, shown) = gated();
        let mut warn = warnings.warn();
        drop(warnings);
        warn("the last");
        drop(permit);
        drop(warn);
        assert_eq!(*shown.lock().unwrap(), ["the last"]);
    }
}
