//! Long work that Ctrl-C ends.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How long a signal may wait for its handler.
const POLL: Duration = Duration::from_millis(20);
/// How many such times work may take to stop that can be abandoned.
const PATIENCE: u32 = 2;

/// Does `work` on a thread of its own with the interpreter released. Meanwhile this thread lets Python handle signals and
/// calls `watch`, some 50 times a second; what either raises tells `work` to stop, by its flag, and is raised when it
/// has.
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
                // Dropped when the work ends, however it does.
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

/// The same for work that may take long to see the flag: what was raised waits for [`PATIENCE`] at most, and the work ends by
/// itself, unheeded.
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

/// Lets Python handle signals and calls `watch` until nobody can say `finished` any more, or something was raised `patience`
/// polls ago: that is returned.
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

/// What a thread said that panicked.
fn panicked(panic: &(dyn Any + Send)) -> PyErr {
    let words = panic.downcast_ref::<String>().map(String::as_str);
    let words = words.or_else(|| panic.downcast_ref::<&str>().copied());
    let words = words.unwrap_or("it did not say why");
    PyRuntimeError::new_err(format!("a thread of feeler failed: {words}"))
}
