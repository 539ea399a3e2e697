//! `feeler export`: other programs read the recorded data from its files.
//!
//! Requires `pip install av datasets pandas polars pyarrow` in the Python named by `FEELER_PYTHON` (default `python3`).
//! Without them the tests report that they are skipped, or fail if `FEELER_REQUIRE_ALL` is set.

mod data_sets;
#[path = "../../../../feeler-export/tests/support/mod.rs"]
mod made_up;
#[path = "../../../../feeler-record/tests/support/python.rs"]
mod python;
mod refused;
mod tables;
mod touch_windows;

use std::path::Path;

/// Records a run of 3 s called `name` in `folder`.
fn short_run(folder: &Path, name: &str, seed: &str) {
    let arguments = [
        "run",
        "cap-closing",
        "--sensing=direct",
        "--set=time_limit=3",
    ];
    let ended = crate::program::run(
        folder,
        &[&arguments[..], &["--seed", seed, "--out", name]].concat(),
    );
    // The time limit ends the run before the task is done.
    assert_eq!(ended.status, Some(1), "{ended:?}");
}
