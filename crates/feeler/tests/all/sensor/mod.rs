//! Steps from images to moments to forces, compared with closed forms and slower methods.

mod beyond_calibration;
mod common_mode;
mod contact;
mod dome;
mod drift;
mod exposure;
mod live_calibration;
mod locate;
mod mismatch;
mod moments;
mod moments_paths;
mod skins;
mod taxel_layouts;
mod taxel_tables;
mod taxels;
mod zero_rule;
