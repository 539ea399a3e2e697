//! The finger as a mechanism: geometry, kinematics, and the seam to its drives.

#[allow(clippy::module_inception)]
pub mod hand;
