//! The `feeler` program: arguments in, exit code out.

/// One thread for all that the link's library does: what it does for a hand is over in microseconds, and handing
/// it from thread to thread takes longer and twice the processor time.
#[cfg(feature = "link")]
const LINK_THREADS: &str = "(rx: (worker_threads: 1), tx: (handover: rx), acc: (handover: rx), app: (handover: rx), net: (handover: rx))";

fn main() -> std::process::ExitCode {
    hold_memory();
    #[cfg(feature = "link")]
    if std::env::var_os("ZENOH_RUNTIME").is_none() {
        // SAFETY: there is no other thread yet that could read or write the environment.
        unsafe { std::env::set_var("ZENOH_RUNTIME", LINK_THREADS) };
    }
    feeler_cli::main()
}

/// Holds what the C library keeps of memory that was freed: the link's library takes threads and megabytes for each
/// connection, and a peer may connect again and again.
fn hold_memory() {
    #[cfg(all(feature = "link", target_os = "linux", target_env = "gnu"))]
    // SAFETY: they set numbers of the allocator, before there is another thread.
    unsafe {
        /// Threads share so many heaps.
        const HEAPS: libc::c_int = 2;
        /// Blocks from this size, bytes, are taken from the system and given back: buffers of connections.
        const OF_THE_SYSTEM: libc::c_int = 32 * 1024;
        libc::mallopt(libc::M_ARENA_MAX, HEAPS);
        libc::mallopt(libc::M_MMAP_THRESHOLD, OF_THE_SYSTEM);
    }
}
