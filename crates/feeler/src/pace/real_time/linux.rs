//! Real-time requests on Linux.

use super::Refusal;
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, getrlimit};
use rustix::thread::{CapabilitySet, capabilities, set_current_timer_slack};
use std::io;
use std::num::NonZeroU64;

/// Implements [`super::raise_priority`]. `priority` must be from 1 to 99.
pub fn raise_priority(priority: u8) -> Result<(), Refusal> {
    if !(1..=99).contains(&priority) {
        return Err(Refusal::PriorityRange { priority });
    }
    let parameters = libc::sched_param {
        sched_priority: priority.into(),
    };
    // SAFETY: the pointer is valid during the call; thread 0 is the calling thread.
    let status = unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameters) };
    if status == 0 {
        return Ok(());
    }
    let reason = io::Error::last_os_error();
    let limit = getrlimit(Resource::Rtprio).current.unwrap_or(u64::MAX);
    if reason.kind() == io::ErrorKind::PermissionDenied && limit < u64::from(priority) {
        return Err(Refusal::Priority { priority, limit });
    }
    Err(Refusal::System {
        what: "real-time priority",
        reason,
    })
}

pub fn lock_memory() -> Result<(), Refusal> {
    if let Some(limit) = getrlimit(Resource::Memlock).current
        && !may_lock_without_limit()
    {
        return Err(Refusal::MemoryLimit { limit });
    }
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|e| Refusal::System {
        what: "locked memory",
        reason: e.into(),
    })
}

fn may_lock_without_limit() -> bool {
    capabilities(None).is_ok_and(|own| own.effective.contains(CapabilitySet::IPC_LOCK))
}

pub fn fine_timer() -> Result<(), Refusal> {
    // Zero would restore the default slack.
    set_current_timer_slack(Some(NonZeroU64::MIN)).map_err(|e| Refusal::System {
        what: "fine timer",
        reason: e.into(),
    })
}
