//! The control path does not allocate, over whole runs.

mod allocation;
#[path = "../../../../feeler/tests/all/control_contract/hand.rs"]
mod hand;
mod physics;
