//! Faults: each has its effect, at the specified time, and no other.

mod bench;
mod refused;
mod rig;
mod same_stop;
mod sensor;
