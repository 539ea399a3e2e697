//! Writer of [LeRobot](https://github.com/huggingface/lerobot) data sets (format v3.0); each run becomes an episode.

mod data_set;
mod episode;
mod feature;
mod frames;
mod meta;
mod mp4;
mod run;
mod stats;
pub mod tactile;
mod video;
mod videos;
mod window;

pub use data_set::DataSet;
pub use frames::Sampling;
pub use meta::FileSizes;
pub use run::Run;
pub use video::Watch;
pub use window::longest_window;
