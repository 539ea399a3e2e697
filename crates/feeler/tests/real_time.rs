//! Requests for real-time scheduling are granted, or refused with advice.

use feeler::pace::real_time::{self, MODERATE, Refusal};

/// On a separate thread, whose priority ends with it.
#[test]
fn a_priority_is_granted_or_the_limit_is_told() {
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
        // A container may forbid what the user's limits allow.
        Err(Refusal::System { what, .. }) => assert_eq!(what, "real-time priority"),
        Err(other) => panic!("{other}"),
    })
    .join()
    .unwrap();
}

#[test]
fn a_priority_that_is_none_is_refused() {
    for priority in [0, 100, 255] {
        let refusal = real_time::raise_priority(priority).unwrap_err();
        assert!(
            matches!(refusal, Refusal::PriorityRange { .. }),
            "{refusal}"
        );
    }
}

#[test]
fn memory_is_locked_or_the_limit_is_told() {
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
fn a_fine_timer_takes_no_privilege() {
    let granted = std::thread::spawn(real_time::fine_timer).join().unwrap();
    assert_eq!(granted.is_ok(), cfg!(target_os = "linux"), "{granted:?}");
}
