//! Whole runs of the reference experiment: what comes out, and that it comes out again.

mod any_hand;
mod determinism;
mod reference_run;
mod report;
