//! Data sets of [LeRobot](https://github.com/huggingface/lerobot), format v3.0: each run is an episode.

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
