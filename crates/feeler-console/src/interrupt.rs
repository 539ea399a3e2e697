//! Ctrl-C and termination by the system.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Returns a flag that Ctrl-C or a termination signal raises, so that a program can close its files and stop.
///
/// # Errors
/// If the signal handler cannot be installed.
pub fn watch_for_interrupt() -> Result<Arc<AtomicBool>, ctrlc::Error> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))?;
    Ok(interrupted)
}

/// Installs a handler that calls `clean_up` and ends the process with status 130 on Ctrl-C or a termination signal. For
/// commands that have no partial result to complete.
///
/// # Errors
/// If the signal handler cannot be installed.
pub fn exit_on_interrupt(mut clean_up: impl FnMut() + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || {
        clean_up();
        process::exit(130);
    })
}

/// Returns `true` if an interrupt was requested.
pub fn is_raised(flag: &AtomicBool) -> bool {
    flag.load(Ordering::Relaxed)
}
