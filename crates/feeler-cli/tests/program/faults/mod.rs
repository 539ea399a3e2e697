//! Faults: each changes what it should, when it should, and nothing else.

mod bench;
mod refused;
mod rig;
mod same_stop;
mod sensor;
