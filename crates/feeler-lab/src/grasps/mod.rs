//! Slip detectors on labelled recordings of grasps.
//!
//! A [`GraspRecording`] contains a vector per element and frame from any sensor. [`DetectorTrace`] contains the scores
//! of all detectors for each frame. [`score`] evaluates the scores of one detector against labels with
//! cross-validation: the threshold for each group of recordings (for example, an object) is chosen on the other
//! groups.

mod confusion;
mod detectors;
mod onset;
mod outcome;
mod probability;
pub mod simulated;
mod transfer;

pub use confusion::Confusion;
pub use detectors::{
    ContactReference, DETECTORS, Detector, DetectorTrace, GraspFrame, GraspRecording,
};
pub use feeler::control::grasp_slip::Picture;
pub use onset::{SlipEvent, timing};
pub use outcome::{Judged, Labelled, Outcome, Verdict, score, score_at, score_in_folds};
pub use probability::{Calibrated, calibrate};
pub use transfer::{Transfer, transfer};
