//! Real-time scheduling: thread priority, locked memory and fine-grained timers.
//!
//! The requests are independent of each other. If the system refuses one, the loop still runs, but less punctually. On
//! Linux, threads inherit the effects of [`raise_priority`] and [`fine_timer`], so start other threads first.

#[cfg_attr(target_os = "linux", path = "real_time/linux.rs")]
#[cfg_attr(not(target_os = "linux"), path = "real_time/elsewhere.rs")]
mod system;

/// A moderate real-time priority: above all ordinary threads, and below 50, the priority of Linux interrupt threads.
/// These deliver images and messages, so they must take precedence over the loop that waits for them.
pub const MODERATE: u8 = 40;

/// Error returned when the system refuses a request, with instructions for granting it.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The priority exceeds the user's limit.
    #[error(
        "real-time priority {priority} exceeds this user's limit of {limit}: raise the limit \
         (`ulimit -r`, or rtprio in /etc/security/limits.conf and log in again), or grant the program \
         CAP_SYS_NICE (`sudo setcap cap_sys_nice+ep PROGRAM`)"
    )]
    Priority {
        /// The requested priority.
        priority: u8,
        /// Maximum priority allowed by the user's limit; 0 if none is allowed.
        limit: u64,
    },
    /// The priority is out of range.
    #[error("expected a real-time priority between 1 and 99, got {priority}")]
    PriorityRange {
        /// The requested priority.
        priority: u8,
    },
    /// The amount of memory that the user may lock is limited. A program that exceeds the limit would fail to allocate
    /// and abort, so nothing is locked.
    #[error(
        "cannot lock memory, this user may lock at most {limit} bytes: raise the limit (`ulimit -l \
         unlimited`, or memlock in /etc/security/limits.conf and log in again), or grant the program \
         CAP_IPC_LOCK (`sudo setcap cap_ipc_lock+ep PROGRAM`)"
    )]
    MemoryLimit {
        /// Maximum amount of memory that the user may lock, in bytes.
        limit: u64,
    },
    /// The feature is not available on this operating system, or not supported there by feeler.
    #[error("{what} is supported on Linux only")]
    Unsupported {
        /// The requested feature.
        what: &'static str,
    },
    /// The system refused for a reason other than the user's limits, such as a lack of memory or the restrictions of a
    /// container or control group.
    #[error("{what} refused: {reason} (in a container, check its permissions)")]
    System {
        /// The requested feature.
        what: &'static str,
        /// Error reported by the system.
        reason: std::io::Error,
    },
}

/// Gives the calling thread real-time scheduling (`SCHED_FIFO`) at `priority` from 1 to 99.
///
/// The thread must sleep in every period, because ordinary threads cannot use its processor while it runs.
///
/// # Errors
/// If the system refuses. The thread's scheduling is then unchanged.
pub fn raise_priority(priority: u8) -> Result<(), Refusal> {
    if !(1..=99).contains(&priority) {
        return Err(Refusal::PriorityRange { priority });
    }
    system::raise_priority(priority)
}

/// Locks all current and future memory of the process, so that it is not paged out.
///
/// # Errors
/// If the system refuses, or would refuse later; see [`Refusal::MemoryLimit`]. No memory is locked then.
pub fn lock_memory() -> Result<(), Refusal> {
    system::lock_memory()
}

/// Reduces the timer slack of the calling thread to the minimum. By default, Linux may wake a thread up to 50 us
/// late, to wake several threads at once. Needs no privilege. Threads with a real-time priority have no timer slack.
///
/// # Errors
/// If the system refuses.
pub fn fine_timer() -> Result<(), Refusal> {
    system::fine_timer()
}
