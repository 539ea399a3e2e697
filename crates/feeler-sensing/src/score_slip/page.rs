//! Page with the scores.

use super::options::SlipScoreOptions;
use feeler_console::CommandError;
use feeler_report::run::make::create_folder;

/// File name of the page.
pub const PAGE: &str = "slip.html";

/// Creates the output folder.
pub fn make_folder(options: &SlipScoreOptions) -> Result<(), CommandError> {
    create_folder(&options.out)
        .map_err(|e| format!("--out {}: {e}; expected a folder", options.out.display()).into())
}
