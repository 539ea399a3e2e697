//! Commands that run, repeat or judge experiments.

pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod compare_grips;
pub(crate) mod contenders;
pub(crate) mod identify;
pub(crate) mod init;
pub(crate) mod list;
pub(crate) mod replay;
pub(crate) mod report;
pub(crate) mod robustness;
pub(crate) mod run;
pub(crate) mod run_progress;
pub(crate) mod simulate_grasps;
pub(crate) mod sweep;
pub(crate) mod throttle;
pub(crate) mod trials;
pub(crate) mod tune;
pub(crate) mod watcher;
