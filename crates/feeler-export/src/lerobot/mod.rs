//! Writer of [LeRobot](https://github.com/huggingface/lerobot) data sets (format v3.0); each run becomes an episode.

mod data_set;
mod episode;
mod feature;
mod meta;
mod mp4;
mod run;
mod stats;
pub mod tactile;
mod video;
mod videos;

pub use data_set::DataSet;
pub use meta::FileSizes;
pub use run::Run;
pub use video::Watch;
