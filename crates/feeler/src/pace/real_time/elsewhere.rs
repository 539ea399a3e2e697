//! Fallback for operating systems on which real-time requests are not supported.

use super::Refusal;

pub fn raise_priority(_priority: u8) -> Result<(), Refusal> {
    unsupported("real-time priority")
}

pub fn lock_memory() -> Result<(), Refusal> {
    unsupported("locked memory")
}

pub fn fine_timer() -> Result<(), Refusal> {
    unsupported("fine timer")
}

fn unsupported(what: &'static str) -> Result<(), Refusal> {
    Err(Refusal::Unsupported { what })
}
