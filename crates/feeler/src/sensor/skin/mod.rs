//! Serial protocols of tactile skins. Performs no I/O.
//!
//! A [`SkinDecoder`] converts received bytes to the values in the columns x, y and z of each taxel, for a
//! [`TaxelChain`](super::taxel::TaxelChain). It finds the next whole frame after lost, inserted or changed bytes.
//! [`SerialConfig`], the table `[serial]` of a taxel layout, selects the protocol. [`Arrivals`] estimates when a frame's
//! first byte arrived.
//!
//! | protocol | frame | protection |
//! |---|---|---|
//! | [`Magnetometers`](SkinProtocol::Magnetometers) | temperature (°C) and flux x, y, z (µT) of each chip as little-endian `f32`, then CR LF | terminators before and behind, ranges of numbers |
//! | [`Flexitac`](SkinProtocol::Flexitac) | `AA 55`, then one byte per taxel, row by row | markers before and behind |
//! | [`Paxini`](SkinProtocol::Paxini) | response to a request: header, address, x, y (`i8`) and z (`u8`) of each taxel | checksum, address, length |
//!
//! Sources: the firmware `5X_binary_burst_stream` and the Python packages of AnySkin 1.0.0 and ReSkin 2.0.2 (MIT); the
//! package `flexitac` 0.3.1 with its firmware (MIT); the ROS 2 driver `paxini_ros2` at commit 25009ba (Apache-2.0).

mod arrivals;
mod config;
mod decoder;
mod flexitac;
mod magnetometers;
mod paxini;
mod step;

pub use arrivals::Arrivals;
pub use config::{SerialConfig, SkinProtocol};
pub use decoder::{SkinDecoder, SkinFrame};
