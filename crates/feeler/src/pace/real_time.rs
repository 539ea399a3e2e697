//! Asks the system for punctuality: priority over other threads, memory that stays, a fine timer.
//!
//! Each is asked for by itself, and a refusal ends nothing: the loop runs as it is, less punctually. Start
//! other threads before [`raise_priority`] and [`fine_timer`]: on Linux threads inherit both.

#[cfg_attr(target_os = "linux", path = "real_time/linux.rs")]
#[cfg_attr(not(target_os = "linux"), path = "real_time/elsewhere.rs")]
mod system;

/// A moderate real-time priority: above every ordinary thread, below 50, which Linux gives its interrupt
/// threads. They bring pictures and messages, and must get ahead of the loop that waits for them.
pub const MODERATE: u8 = 40;

/// Why the system did not grant something, and what would help.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The user may not have this priority.
    #[error(
        "no real-time priority {priority}, this user may have at most {limit}: raise the limit \
         (`ulimit -r`, or rtprio in /etc/security/limits.conf and log in again), or grant the program \
         CAP_SYS_NICE (`sudo setcap cap_sys_nice+ep PROGRAM`)"
    )]
    Priority {
        /// The priority asked for.
        priority: u8,
        /// The highest that the user's limit allows: 0 for none.
        limit: u64,
    },
    /// The priority is none.
    #[error("a real-time priority is between 1 and 99, not {priority}")]
    PriorityRange {
        /// The priority asked for.
        priority: u8,
    },
    /// The user may lock only some memory. A program that grew beyond it would be given no more memory
    /// and end, so nothing is locked.
    #[error(
        "memory is not locked, this user may lock at most {limit} bytes: lift the limit (`ulimit -l \
         unlimited`, or memlock in /etc/security/limits.conf and log in again), or grant the program \
         CAP_IPC_LOCK (`sudo setcap cap_ipc_lock+ep PROGRAM`)"
    )]
    MemoryLimit {
        /// What the user's limit allows, bytes.
        limit: u64,
    },
    /// This kind of system has no such thing, or feeler does not know how to ask for it.
    #[error("no {what}: feeler asks for it on Linux only")]
    Unsupported {
        /// What was asked for.
        what: &'static str,
    },
    /// The system refused for a reason that is not known to be its user's limits: memory, or what a
    /// container or control group is allowed.
    #[error("no {what}: {reason} (in a container, see what it is allowed)")]
    System {
        /// What was asked for.
        what: &'static str,
        /// The system's reason.
        reason: std::io::Error,
    },
}

/// Schedules the calling thread ahead of all ordinary ones (`SCHED_FIFO`), at `priority` from 1 to 99.
///
/// It must sleep in every period: while it runs, nothing else may.
///
/// # Errors
/// When the system refuses; the thread then goes on as it was.
pub fn raise_priority(priority: u8) -> Result<(), Refusal> {
    if !(1..=99).contains(&priority) {
        return Err(Refusal::PriorityRange { priority });
    }
    system::raise_priority(priority)
}

/// Keeps all of the program's memory, present and future, from being paged out.
///
/// # Errors
/// When the system refuses, or would later on: see [`Refusal::MemoryLimit`]. Nothing is locked then.
pub fn lock_memory() -> Result<(), Refusal> {
    system::lock_memory()
}

/// Has the calling thread woken when its sleep ends, not up to 50 us later, which Linux does to wake
/// several threads at once. Takes no privilege; a thread of real-time priority has no need of it.
///
/// # Errors
/// When the system refuses.
pub fn fine_timer() -> Result<(), Refusal> {
    system::fine_timer()
}
