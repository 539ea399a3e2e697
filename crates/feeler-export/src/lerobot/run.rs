//! A run to be added to a data set.

use feeler_record::Recording;
use std::path::Path;

/// A run to be added as an episode.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// Name of the run in messages and in the list of episodes.
    pub name: &'a str,
    /// Task description in natural language, for language-conditioned policies.
    pub task: &'a str,
    /// The run's recording.
    pub recording: &'a Recording,
    /// File of the recording, from which images are read.
    pub path: &'a Path,
}
