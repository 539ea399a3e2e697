#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod hand;
pub mod inboxes;
pub mod messages;
pub mod programs;
pub mod security;
pub mod stop_server;
pub mod transport;
