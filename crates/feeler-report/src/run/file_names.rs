//! File names in a run's folder.

/// File name of the recording in a run's folder.
pub const RECORDING: &str = "recording.mcap";
/// File name of the report page in a run's folder.
pub const REPORT: &str = "report.html";
/// Folder name of the individual figures in a run's folder.
pub const FIGURES: &str = "figures";
/// File name of the summary in a run's folder.
pub const SUMMARY: &str = "summary.json";
