//! Long-running work that Ctrl-C can interrupt.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Interval at which signals are handled.
const POLL: Duration = Duration::from_millis(20);
/// Number of [`POLL`] intervals by which work run with [`abandonable`] may delay an exception.
const PATIENCE: u32 = 2;

/// Runs `work` on a separate thread with the interpreter released. Meanwhile, this thread lets Python handle signals
/// and calls `watch`, about 50 times a second. If either raises an exception, the flag of `work` is set, and the
/// exception is raised once `work` has stopped.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
    watch: impl FnMut(Python<'_>) -> PyResult<()> + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    py.detach(|| {
        thread::scope(|scope| {
            let (done, finished) = channel::<()>();
            let worker = scope.spawn(|| {
                // Dropped when the work ends, even by a panic.
                let _done = done;
                work(&stop)
            });
            match wait(&finished, &stop, watch, u32::MAX) {
                None => worker.join().map_err(|panic| panicked(&*panic)),
                Some(error) => Err(error),
            }
        })
    })
}

/// Like [`interruptible`], for work that may be slow to check its flag: an exception is delayed by at most [`PATIENCE`]
/// intervals. The work then continues until it ends, and its result is discarded.
pub fn abandonable<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
    watch: impl FnMut(Python<'_>) -> PyResult<()> + Send,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    py.detach(|| {
        let (done, finished) = channel::<()>();
        let flag = Arc::clone(&stop);
        let worker = thread::spawn(move || {
            let _done = done;
            work(&flag)
        });
        match wait(&finished, &stop, watch, PATIENCE) {
            None => worker.join().map_err(|panic| panicked(&*panic)),
            Some(error) => Err(error),
        }
    })
}

/// Lets Python handle signals and calls `watch` until the sender of `finished` is dropped, or until `patience`
/// intervals after an exception. Returns the exception, if any.
fn wait(
    finished: &Receiver<()>,
    stop: &AtomicBool,
    mut watch: impl FnMut(Python<'_>) -> PyResult<()>,
    mut patience: u32,
) -> Option<PyErr> {
    let mut raised = None;
    while let Err(RecvTimeoutError::Timeout) = finished.recv_timeout(POLL) {
        if raised.is_some() {
            patience = patience.saturating_sub(1);
            if patience == 0 {
                break;
            }
        }
        let looked = Python::attach(|py| py.check_signals().and_then(|()| watch(py)));
        if let Err(error) = looked {
            stop.store(true, Ordering::Relaxed);
            raised.get_or_insert(error);
        }
    }
    raised
}

/// Converts the panic of a thread into an exception.
fn panicked(panic: &(dyn Any + Send)) -> PyErr {
    let words = panic.downcast_ref::<String>().map(String::as_str);
    let words = words.or_else(|| panic.downcast_ref::<&str>().copied());
    let words = words.unwrap_or("unknown reason");
    PyRuntimeError::new_err(format!("a thread of feeler failed: {words}"))
}
