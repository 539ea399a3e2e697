#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod columnar;
mod columns;
pub mod error;
mod joint_units;
pub mod lerobot;
pub mod table;

pub use error::ExportError;
