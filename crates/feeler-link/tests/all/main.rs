//! The tests of this crate, but for those that need a process of their own: linked once, and all at once over the processors.

#[path = "../support/how_many.rs"]
mod how_many;
mod inboxes;
#[cfg(feature = "zenoh")]
#[path = "../support/lab.rs"]
mod lab;
mod link_messages;
mod model;
#[cfg(feature = "zenoh")]
#[path = "../support/ports.rs"]
mod ports;
mod programs;
mod rights;
mod stop_door;
mod stop_wire;
