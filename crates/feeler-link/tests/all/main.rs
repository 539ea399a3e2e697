//! All tests of this crate in one binary, which links once and runs in parallel, except those that need a separate
//! process.

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
mod stop_server;
mod stop_wire;
