//! Complete runs of tasks on objects with contact forces in closed form.

mod cap;
mod carry;
mod contour;
mod fingers;
mod friction_scan;
