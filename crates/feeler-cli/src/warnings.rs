//! Warnings on standard error: at once, or so that they hold nobody up, as a terminal may be paused and a pipe full.

use feeler_link::programs::Warn;
use std::io::{Write, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Prints a warning on standard error at once, for commands that may wait for whoever reads it.
pub fn warn(warning: &str) {
    // Standard error that is closed is no reason to stop.
    let _ = writeln!(stderr(), "warning: {warning}");
}

/// Warnings that may wait until somebody takes them.
const WAITING: usize = 64;

/// How long the end of the program waits for those that are not shown yet.
const LAST: Duration = Duration::from_secs(1);

/// Shows warnings, each on a line of its own. What finds no room is dropped and counted.
#[derive(Clone)]
pub struct Warnings(Arc<Queue>);

struct Queue {
    lines: Option<SyncSender<String>>,
    dropped: Arc<AtomicU64>,
    /// Ends with the thread that shows them.
    ended: Mutex<Receiver<()>>,
}

impl Warnings {
    /// On standard error.
    pub fn on_stderr() -> Self {
        Self::shown_by(|line| {
            // Where nobody listens, the exit status and the record say it.
            let _ = writeln!(stderr(), "{line}");
        })
    }

    /// Each by `show`, on a thread of its own.
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
                        "{count} warnings were dropped, as nobody took them"
                    ));
                }
            }
        };
        let thread = thread::Builder::new().name("warnings".into());
        // Without a thread there is no queue, and nothing is shown.
        let lines = thread.spawn(show_all).ok().map(|_| lines);
        Self(Arc::new(Queue {
            lines,
            dropped,
            ended: Mutex::new(ended),
        }))
    }

    /// Shows `warning` as soon as somebody takes it; never waits.
    pub fn say(&self, warning: &str) {
        let queue = &*self.0;
        let taken = |lines: &SyncSender<String>| lines.try_send(warning.into()).is_ok();
        if !queue.lines.as_ref().is_some_and(taken) {
            queue.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The same, for a program of a rig.
    pub fn warn(&self) -> Warn {
        let warnings = self.clone();
        Box::new(move |warning| warnings.say(warning))
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        self.lines = None;
        let ended = self.ended.get_mut().unwrap_or_else(PoisonError::into_inner);
        // The thread sends nothing: it has ended, or takes too long.
        let _ = ended.recv_timeout(LAST);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Warnings that are shown as permits come, and what was shown.
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
    fn a_paused_terminal_holds_nobody_up_and_is_told_what_it_missed() {
        let (warnings, permit, shown) = gated();
        let said = 2 * WAITING;
        for number in 0..said {
            warnings.say(&format!("warning {number}"));
        }
        drop(permit);
        drop(warnings);
        let shown = shown.lock().unwrap();
        let dropped = shown.iter().find_map(|line| {
            let count = line.strip_suffix(" warnings were dropped, as nobody took them")?;
            count.parse::<usize>().ok()
        });
        // What is dropped, and a line that says so.
        assert_eq!(shown.len() - 1 + dropped.unwrap(), said, "{shown:?}");
        assert_eq!(shown[0], "warning 0");
    }

    #[test]
    fn the_end_shows_what_waits() {
        let (warnings, permit, shown) = gated();
        let mut warn = warnings.warn();
        drop(warnings);
        warn("the last");
        drop(permit);
        drop(warn);
        assert_eq!(*shown.lock().unwrap(), ["the last"]);
    }
}
