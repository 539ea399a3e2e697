#![doc = include_str!("../README.md")]
#![warn(missing_docs)]
#![cfg_attr(
    test,
    allow(
        clippy::disallowed_methods,
        reason = "test inputs need not be bit-identical across platforms"
    )
)]

pub mod bench;
pub mod contact;
pub mod error;
pub mod objects;
pub mod optics;
pub mod random;
pub mod rig;
pub mod shapes;
pub mod world;
