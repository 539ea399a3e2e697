//! Writing recordings.

pub(crate) mod batch;
pub(crate) mod buffer_recorder;
pub(crate) mod closing;
pub(crate) mod instruments;
pub(crate) mod memory;
pub(crate) mod newest;
pub(crate) mod options;
pub(crate) mod recorder;
pub(crate) mod run_log;
pub(crate) mod sink;
pub(crate) mod writer;
