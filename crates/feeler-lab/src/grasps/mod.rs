//! Slip detectors on labelled recordings of grasps.
//!
//! A [`GraspRecording`] has a vector per element and frame, from whatever sensor. [`DetectorTrace`] is what all detectors say
//! of it, frame by frame; [`score`] holds one detector's numbers against labels, as they come out on groups of recordings (objects,
//! say) that its threshold was not chosen on.

mod detectors;
mod outcome;
pub mod simulated;
mod transfer;

pub use detectors::{DETECTORS, Detector, DetectorTrace, GraspFrame, GraspRecording, Untouched};
pub use feeler::control::grasp_slip::Picture;
pub use outcome::{Confusion, Judged, Labelled, Outcome, Verdict, score};
pub use transfer::{Transfer, transfer};
