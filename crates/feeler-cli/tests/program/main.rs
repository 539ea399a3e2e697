//! The program end to end: what a user gives it, what it prints, writes and exits with.

mod bad_input;
mod calibrate_loads;
mod cap;
mod carry;
mod check_objects;
mod cli;
mod compare;
mod contour;
mod friction_scan;
#[cfg(unix)]
mod gap;
mod hands;
mod interrupted;
mod locate;
mod lying_sensors;
mod outputs;
mod policy;
#[path = "../../../feeler/tests/support/policy_file.rs"]
mod policy_file;
#[path = "../support/program.rs"]
mod program;
mod real_rig;
mod replay;
mod robustness;
mod schema;
mod score_slip;
mod sweep;
mod urdf;
