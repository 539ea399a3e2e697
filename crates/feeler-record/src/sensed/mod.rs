//! Recordings of a single sensor.

pub(crate) mod images;
pub(crate) mod readings;
pub(crate) mod taxel_messages;
pub(crate) mod taxels;

pub use images::is_sensed;
pub use readings::{CONTACT, MOMENTS, TACTILE, WRENCH};
pub use taxels::{Elements, taxels};
