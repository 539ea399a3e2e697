//! What inboxes take and what they refuse: each reason by a message that is sound but for one thing.

mod bench;
mod hand;
mod heartbeats;
mod rig;
mod sense;
