//! Reading, scanning and replaying recordings.

pub(crate) mod chunk;
pub(crate) mod collector;
pub(crate) mod container;
pub(crate) mod digest;
pub(crate) mod part;
pub(crate) mod picture_reader;
pub(crate) mod read;
pub(crate) mod record;
pub(crate) mod recorded_camera;
pub(crate) mod recording;
pub(crate) mod replay;
pub(crate) mod rewritten;
pub(crate) mod scan;
pub(crate) mod steps;

pub use digest::Digester;
pub use picture_reader::PictureReader;
pub use recording::PictureAt;
pub use steps::{FingerStep, Step, Steps};
