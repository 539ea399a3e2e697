//! Whole runs of the reference experiment: what comes out, and that it comes out again.

mod determinism;
mod reference_run;
mod report;
