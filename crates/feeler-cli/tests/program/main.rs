//! End-to-end tests of the program: its input, output, files and exit status.

mod bad_input;
mod calibrate_checks;
mod calibrate_live;
mod calibrate_live_wrench;
mod calibrate_loads;
mod calibrate_taxels;
mod calibrate_wrench;
mod cameras;
mod cap;
mod carry;
mod chains;
mod check_objects;
mod cli;
mod compare;
mod contour;
#[cfg(feature = "export")]
mod export;
mod faults;
mod fingertips;
mod follow;
mod for_programs;
mod friction_scan;
mod fuzz_corpus;
#[cfg(unix)]
mod gap;
mod grip;
mod hands;
#[path = "../../../feeler-link/tests/support/how_many.rs"]
mod how_many;
mod identify;
mod interrupted;
mod league;
mod locate;
mod lying_sensors;
mod named_recording;
mod outputs;
mod policy;
#[path = "../../../feeler/tests/support/policy_file.rs"]
mod policy_file;
#[cfg(feature = "ros2")]
#[path = "../../../feeler-link/tests/support/ports.rs"]
mod ports;
#[path = "../support/program.rs"]
mod program;
mod real;
mod real_rig;
#[path = "../../../feeler-lab/tests/support/recordings.rs"]
mod recordings;
mod replay;
mod robustness;
mod schema;
mod score_slip;
mod score_slip_recorded;
mod sense;
mod simulated_grasps;
#[path = "../../../feeler-lab/tests/support/skip.rs"]
mod skip;
mod sweep;
mod tune;
mod urdf;
mod verdicts;
mod verify;
mod videos;

use assert_no_alloc::AllocDisabler;

/// Aborts the process if code within `assert_no_alloc` of a test allocates.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
