//! Accepted and rejected messages of the inboxes. Each rejection is tested with a message that is valid except for one
//! field.

mod bench;
mod hand;
mod heartbeats;
mod joints;
mod rig;
mod sense;
