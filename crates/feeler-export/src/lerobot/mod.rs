//! Writer of [LeRobot](https://github.com/huggingface/lerobot) data sets (format v3.0); each run becomes an episode.

mod data_set;
mod episode;
mod feature;
mod meta;
mod mp4;
mod stats;
mod video;
mod videos;

pub use data_set::{DataSet, Run};
pub use meta::FileSizes;
pub use video::Watch;
