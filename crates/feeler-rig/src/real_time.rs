//! Real-time scheduling of a program.

use feeler::pace::real_time::{self, MODERATE, Refusal};
use feeler_console::warn;

/// Requests real-time priority and locked memory. Prints a warning for each that the system refuses.
pub fn request_real_time() {
    let requests: [(&str, Result<(), Refusal>); 2] = [
        ("real-time priority", real_time::raise_priority(MODERATE)),
        ("locked memory", real_time::lock_memory()),
    ];
    for (request, answer) in requests {
        if let Err(refusal) = answer {
            warn(&format!("no {request}: {refusal}"));
        }
    }
}
