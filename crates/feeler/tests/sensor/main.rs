//! From moments to forces, with calibrations whose forces are known in closed form.

mod beyond_calibration;
mod drift;
mod exposure;
