//! `feeler export`: what other programs read in its files is what was recorded.
//!
//! Needs `pip install av datasets pandas polars pyarrow` in the Python named by `FEELER_PYTHON` (default `python3`); without them those
//! tests say that they are skipped, or fail where `FEELER_REQUIRE_ALL` is set.

mod data_sets;
#[path = "../../../../feeler-export/tests/support/mod.rs"]
mod made_up;
#[path = "../../../../feeler-lab/tests/all/record/python.rs"]
mod python;
mod refused;
mod tables;

use std::path::Path;

/// Makes a run of 3 s called `name` in `folder`.
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
    // Its time is up before the task is done.
    assert_eq!(ended.status, Some(1), "{ended:?}");
}
