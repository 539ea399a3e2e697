//! Tasks from their beginning to their end, on objects whose contact forces are known in closed form.

mod cap;
mod carry;
mod contour;
mod fingers;
mod friction_scan;
