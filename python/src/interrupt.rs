//! Long work that Ctrl-C ends.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How long a signal may wait for its handler.
const POLL: Duration = Duration::from_millis(20);

/// Does `work` on a thread of its own with the interpreter released. Meanwhile this thread lets Python handle signals and
/// calls `watch`, some 50 times a second; what either raises tells `work` to stop, by its flag, and is raised when it
/// has.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
    mut watch: impl FnMut(Python<'_>) -> PyResult<()> + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let look = |raised: &mut Option<PyErr>| {
        let looked = Python::attach(|py| py.check_signals().and_then(|()| watch(py)));
        if let Err(error) = looked {
            stop.store(true, Ordering::Relaxed);
            raised.get_or_insert(error);
        }
    };
    py.detach(|| {
        thread::scope(|scope| {
            let (done, finished) = channel::<()>();
            let worker = scope.spawn(|| {
                // Dropped when the work ends, however it does.
                let _done = done;
                work(&stop)
            });
            let mut look = look;
            let mut raised = None;
            while let Err(RecvTimeoutError::Timeout) = finished.recv_timeout(POLL) {
                look(&mut raised);
            }
            match (worker.join(), raised) {
                (_, Some(error)) => Err(error),
                (Ok(value), None) => Ok(value),
                (Err(panic), None) => Err(PyRuntimeError::new_err(panicked(&*panic))),
            }
        })
    })
}

/// What a thread said that panicked.
fn panicked(panic: &(dyn Any + Send)) -> String {
    let words = panic.downcast_ref::<String>().map(String::as_str);
    let words = words.or_else(|| panic.downcast_ref::<&str>().copied());
    format!(
        "a thread of feeler failed: {}",
        words.unwrap_or("it did not say why")
    )
}
