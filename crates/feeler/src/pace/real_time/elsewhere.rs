//! Fallback for systems without real-time support in feeler.

use super::Refusal;

pub fn raise_priority(_priority: u8) -> Result<(), Refusal> {
    let what = "real-time priority";
    Err(Refusal::Unsupported { what })
}

pub fn lock_memory() -> Result<(), Refusal> {
    let what = "locked memory";
    Err(Refusal::Unsupported { what })
}

pub fn fine_timer() -> Result<(), Refusal> {
    let what = "fine timer";
    Err(Refusal::Unsupported { what })
}
