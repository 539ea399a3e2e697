//! Steps from images to moments to forces, compared with closed forms and slower methods.

mod beyond_calibration;
mod contact;
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
