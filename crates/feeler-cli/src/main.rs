//! Entry point of the `feeler` program.

/// Zenoh runtime configuration: a single thread for all tasks. A hand's messages are handled in microseconds; passing
/// them between threads takes longer and costs twice the processor time.
#[cfg(feature = "link")]
const LINK_THREADS: &str = "(rx: (worker_threads: 1), tx: (handover: rx), acc: (handover: rx), app: (handover: rx), net: (handover: rx))";

fn main() -> std::process::ExitCode {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    set_allocator();
    #[cfg(feature = "link")]
    if std::env::var_os("ZENOH_RUNTIME").is_none() {
        // SAFETY: no other thread exists yet that could access the environment.
        unsafe { std::env::set_var("ZENOH_RUNTIME", LINK_THREADS) };
    }
    feeler_cli::main()
}

/// Tunes the C library's allocator for the given subcommand.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn set_allocator() {
    use libc::{M_ARENA_MAX, M_MMAP_THRESHOLD, M_TRIM_THRESHOLD, c_int};
    /// Subcommands that simulate runs; the memory that they free is kept, because they soon need it again.
    const RUNS: [&str; 4] = ["run", "sweep", "compare", "robustness"];
    /// Bytes of freed memory that are kept rather than returned to the system, which would have to clear them again;
    /// saves an eighth of a trial's time.
    const KEPT: c_int = 256 << 20;
    /// Block size (bytes) above which the allocator uses `mmap`: the largest value that it accepts, so that large
    /// blocks are kept too.
    const LARGE: c_int = 32 << 20;
    /// Number of heaps that the threads of all other subcommands share. The link library allocates threads and
    /// megabytes per connection, and a peer may reconnect any number of times.
    const HEAPS: c_int = 2;
    /// Block size (bytes) above which all other subcommands map and unmap memory individually.
    const OF_THE_SYSTEM: c_int = 32 << 10;
    let command = std::env::args_os().nth(1);
    let is_run = RUNS.iter().any(|run| command == Some(run.into()));
    let settings: &[(c_int, c_int)] = match (is_run, cfg!(feature = "link")) {
        (true, _) => &[(M_TRIM_THRESHOLD, KEPT), (M_MMAP_THRESHOLD, LARGE)],
        (false, true) => &[(M_ARENA_MAX, HEAPS), (M_MMAP_THRESHOLD, OF_THE_SYSTEM)],
        (false, false) => &[],
    };
    for &(what, to) in settings {
        // SAFETY: `mallopt` sets an integer option of the allocator; no other thread exists yet.
        unsafe { libc::mallopt(what, to) };
    }
}
