//! The `feeler` program: arguments in, exit code out.

/// One thread for all that the link's library does: what it does for a hand is over in microseconds, and handing
/// it from thread to thread takes longer and twice the processor time.
#[cfg(feature = "link")]
const LINK_THREADS: &str = "(rx: (worker_threads: 1), tx: (handover: rx), acc: (handover: rx), app: (handover: rx), net: (handover: rx))";

fn main() -> std::process::ExitCode {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    set_allocator();
    #[cfg(feature = "link")]
    if std::env::var_os("ZENOH_RUNTIME").is_none() {
        // SAFETY: there is no other thread yet that could read or write the environment.
        unsafe { std::env::set_var("ZENOH_RUNTIME", LINK_THREADS) };
    }
    feeler_cli::main()
}

/// Tells the C library's allocator what to do with memory that was freed, by what the program is to do.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn set_allocator() {
    use libc::{M_ARENA_MAX, M_MMAP_THRESHOLD, M_TRIM_THRESHOLD, c_int};
    /// Commands that soon take again what they gave back: for the next trial, or for the report of what was recorded.
    const RUNS: [&str; 4] = ["run", "sweep", "compare", "robustness"];
    /// So much of it, bytes, is not given back to the system, which would have to clear it again: an eighth of a trial's time.
    const KEPT: c_int = 256 << 20;
    /// The most that the allocator admits, bytes, so that large blocks are kept, too.
    const LARGE: c_int = 32 << 20;
    /// Threads of other programs share so many heaps, and blocks from this size, bytes, are taken from the system and given back: the
    /// link's library takes threads and megabytes for each connection, and a peer may connect again and again.
    const HEAPS: c_int = 2;
    const OF_THE_SYSTEM: c_int = 32 << 10;
    let command = std::env::args_os().nth(1);
    let is_run = RUNS.iter().any(|run| command == Some(run.into()));
    let settings: &[(c_int, c_int)] = match (is_run, cfg!(feature = "link")) {
        (true, _) => &[(M_TRIM_THRESHOLD, KEPT), (M_MMAP_THRESHOLD, LARGE)],
        (false, true) => &[(M_ARENA_MAX, HEAPS), (M_MMAP_THRESHOLD, OF_THE_SYSTEM)],
        (false, false) => &[],
    };
    for &(what, to) in settings {
        // SAFETY: it sets a number of the allocator, before there is another thread.
        unsafe { libc::mallopt(what, to) };
    }
}
