#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod batch;
pub mod channels;
mod chunk;
mod closing;
mod collector;
mod container;
pub mod digest;
pub mod error;
pub mod facts;
pub mod image;
pub mod memory;
pub mod model;
pub mod names;
mod newest;
pub mod options;
pub mod picture_reader;
mod read;
pub mod recorded_camera;
pub mod recorder;
pub mod recording;
pub mod replay;
mod rewritten;
pub mod ros;
pub mod run_end;
pub mod run_log;
pub mod scan;
mod scene;
pub mod sensed;
pub mod sensed_pictures;
pub mod sensed_taxels;
mod sink;
pub mod steps;
pub mod taxels;
mod text_enum;
pub mod topic;
pub mod urdf;
mod viewer_log;
pub mod wire;
mod writer;

pub use channels::{
    Cap, Command, Findings, Fingertip, Flags, Joints, Moments, NO_ELEMENT, ObjectPose,
    RecordingGap, Stamped, Tactile, Task, TorqueSensor, TrueSlip,
};
pub use closing::CLOSE_LIMIT;
pub use digest::Digest;
pub use error::RecordError;
pub use facts::{CapFacts, CarryGoal, RunFacts};
pub use feeler::control::phase::Phase;
pub use image::Image;
pub use memory::{MemoryRecorder, MessageSink};
pub use model::{FingerModel, Solid, SolidFrame, SolidShape};
pub use names::{FindingName, SensingKind, TaskKind, TaskOutcome};
pub use newest::{Newest, SAME_TIME};
pub use options::{FLUSH_INTERVAL, Patience, PolicyFile, RecordOptions};
pub use read::PART;
pub use recorded_camera::RecordedCamera;
pub use recorder::Recorder;
pub use recording::{FingerRecord, Gap, PictureAt, Recording};
pub use replay::{RecordedHand, RecordedSensor};
pub use run_end::{RunEnd, RunState};
pub use run_log::{InstrumentRecord, RunLog};
pub use sensed::{SensedWriter, read_moments};
pub use sensed_pictures::SensedPictures;
pub use sensed_taxels::{TaxelFacts, TaxelWriter};
pub use steps::{FingerStep, Step, Steps};
pub use topic::{RecordedMessage, RecordedTopic, topics};
