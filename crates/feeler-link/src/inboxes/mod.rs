//! Inboxes: storage of the latest messages from other programs, one type for each kind of program.

pub(crate) mod beacon;
pub(crate) mod hand_inbox;
pub(crate) mod inbox;
pub(crate) mod peers;
pub(crate) mod rig_inbox;
pub(crate) mod sense_inbox;
pub(crate) mod watch_inbox;

pub use crate::messages::decode::read;
pub use beacon::Beacon;
pub use hand_inbox::HandInbox;
pub use inbox::{Inbox, listen};
pub use peers::{Expected, MAX_PEERS, Peer, Peers};
pub use rig_inbox::RigInbox;
pub use sense_inbox::{Exposed, SenseInbox};
pub use watch_inbox::WatchInbox;
