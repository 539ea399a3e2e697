//! Real-time privileges are granted, or refused with the setting that would help.

use feeler::pace::real_time::{self, MODERATE, Refusal};

/// On a separate thread, whose priority ends with it.
#[test]
fn a_priority_is_granted_or_the_error_states_the_limit() {
    std::thread::spawn(|| match real_time::raise_priority(MODERATE) {
        Ok(()) => {}
        Err(refusal @ Refusal::Priority { priority, limit }) => {
            assert!(priority == MODERATE && limit < u64::from(MODERATE));
            let text = refusal.to_string();
            assert!(
                text.contains("ulimit -r") && text.contains("CAP_SYS_NICE"),
                "{text}"
            );
        }
        Err(Refusal::Unsupported { .. }) if !cfg!(target_os = "linux") => {}
        // A container may forbid priorities that the user's limits permit.
        Err(Refusal::System { what, .. }) => assert_eq!(what, "real-time priority"),
        Err(other) => panic!("{other}"),
    })
    .join()
    .unwrap();
}

#[test]
fn invalid_priorities_are_rejected() {
    for priority in [0, 100, 255] {
        let refusal = real_time::raise_priority(priority).unwrap_err();
        assert!(
            matches!(refusal, Refusal::PriorityRange { .. }),
            "{refusal}"
        );
    }
}

#[test]
fn memory_is_locked_or_the_error_states_the_limit() {
    match real_time::lock_memory() {
        Ok(()) => {}
        Err(refusal @ Refusal::MemoryLimit { .. }) => {
            let text = refusal.to_string();
            assert!(
                text.contains("ulimit -l") && text.contains("CAP_IPC_LOCK"),
                "{text}"
            );
        }
        Err(Refusal::Unsupported { .. }) if !cfg!(target_os = "linux") => {}
        Err(Refusal::System { what, .. }) => assert_eq!(what, "locked memory"),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn a_fine_timer_requires_no_privilege() {
    let granted = std::thread::spawn(real_time::fine_timer).join().unwrap();
    assert_eq!(granted.is_ok(), cfg!(target_os = "linux"), "{granted:?}");
}
