//! Whole runs: claims, reports and reproducibility.

mod any_hand;
mod determinism;
mod reference_run;
mod report;
