//! From pictures to moments to forces: whatever is known in closed form or by a slower way.

mod beyond_calibration;
mod dome;
mod drift;
mod exposure;
mod live_calibration;
mod locate;
mod mismatch;
mod moments;
mod moments_paths;
mod taxel_layouts;
mod taxel_tables;
mod taxels;
