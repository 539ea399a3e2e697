//! Steps of environments do not allocate, on any thread.

use feeler_lab::environment::{Autoreset, Batch, EnvironmentConfig, VectorEnvironment};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

/// The system's allocator with a count of all threads' allocations.
struct Counting;

static COUNT: AtomicU64 = AtomicU64::new(0);

// SAFETY: all requests are forwarded to the system's allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`; all memory came from the system.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Only test of this program, as allocations of others would be counted.
#[test]
fn steps_do_not_allocate() {
    for experiment in ["cap-closing", "cap-until-closed", "contour"] {
        let config = EnvironmentConfig {
            experiment: experiment.to_string(),
            ..EnvironmentConfig::default()
        };
        let vector = VectorEnvironment::new(&config, 7, 3, Autoreset::NextStep);
        let mut vector = vector.expect("environments");
        let mut observations = vec![0.0; 7 * vector.observation_len()];
        let mut infos = vec![0.0; 7 * vector.info_len()];
        let (mut rewards, mut terminated, mut truncated) = ([0.0; 7], [false; 7], [false; 7]);
        let mut batch = Batch {
            observations: &mut observations,
            rewards: &mut rewards,
            terminated: &mut terminated,
            truncated: &mut truncated,
            infos: &mut infos,
        };
        let seeds: Vec<_> = (0..7).map(Some).collect();
        vector.reset(&seeds, None, &mut batch).expect("episodes");
        // Moves along the domes' axes until the fingers touch and press.
        let actions: Vec<f64> = (0..7 * vector.action_len())
            .map(|number| [0.01, 0.0, 0.0][number % 3])
            .collect();
        for step in 0..150 {
            let before = COUNT.load(Ordering::Relaxed);
            vector.step(&actions, &mut batch).expect("a step");
            let allocated = COUNT.load(Ordering::Relaxed) - before;
            assert!(allocated == 0, "{experiment}: {allocated} in step {step}");
            if batch.terminated.contains(&true) {
                break;
            }
        }
    }
}
