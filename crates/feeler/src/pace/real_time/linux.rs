//! Real-time requests on Linux.

use super::Refusal;
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, getrlimit};
use rustix::thread::{CapabilitySet, capabilities, set_current_timer_slack};
use std::io;
use std::num::NonZeroU64;
use thread_priority::{
    Error, RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// Requires a `priority` from 1 to 99.
pub fn raise_priority(priority: u8) -> Result<(), Refusal> {
    let Ok(value) = ThreadPriorityValue::try_from(priority) else {
        return Err(Refusal::PriorityRange { priority });
    };
    let raised = set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(value),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    );
    raised.map_err(|error| priority_refusal(priority, &error))
}

fn priority_refusal(priority: u8, error: &Error) -> Refusal {
    let reason = match error {
        Error::OS(code) => io::Error::from_raw_os_error(*code),
        other => io::Error::other(other.to_string()),
    };
    let limit = getrlimit(Resource::Rtprio).current.unwrap_or(u64::MAX);
    if reason.kind() == io::ErrorKind::PermissionDenied && limit < u64::from(priority) {
        return Refusal::Priority { priority, limit };
    }
    Refusal::System {
        what: "real-time priority",
        reason,
    }
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
