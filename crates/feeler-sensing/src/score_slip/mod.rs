//! `feeler score-slip`: compares slip detectors with the simulator's ground truth or with labelled recordings.

mod collected;
mod images;
mod in_order;
mod labels;
mod notes;
mod onsets;
mod options;
mod page;
mod recorded;
mod said;
mod scores;
mod simulated;
mod sources;
mod taxels;
mod tracks;
mod videos;

pub(crate) use collected::Found;
use feeler_console::{CommandError, Outcome};
use feeler_lab::config::BUILT_IN;
pub(crate) use in_order::in_order;
pub(crate) use labels::Label;
pub(crate) use notes::Notes;
pub use options::{RecordedOptions, SlipScoreOptions};
use std::io::Write;
use std::path::Path;

/// Scores slip detectors against the simulator's ground truth, or against the labels of recordings.
///
/// # Errors
/// If an option has no effect, or recordings, labels or outputs fail.
pub fn score_slip(
    options: &SlipScoreOptions,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let labelled = options.labels.is_some() || options.recorded.frame_labels.is_some();
    if !labelled {
        if let Some(option) = options.recorded.given() {
            let message = format!("{option} is for recordings; add their LABELS or --frame-labels");
            return Err(message.into());
        }
        let source = &options.source;
        // A run of an experiment may have created a folder with the experiment's name.
        let built_in = BUILT_IN.iter().any(|b| b.name == source);
        if !built_in && Path::new(source).is_dir() {
            return Err(format!("{source}: a folder of recordings requires LABELS as the second argument, or --frame-labels").into());
        }
        return simulated::score(options, out);
    }
    recorded::score(options, out)
}
