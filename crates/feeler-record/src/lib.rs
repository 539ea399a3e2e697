#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod error;
pub mod messages;
pub mod reading;
pub mod ros;
pub mod sensed;
pub mod tactile_array;
mod text_enum;
pub mod viewers;
pub mod wire;
pub mod writing;

pub use crate::messages::channels::{
    Cap, Command, Findings, Fingertip, Flags, Joints, Moments, NO_ELEMENT, ObjectPose,
    RecordingGap, Stamped, Tactile, TactileSample, Task, TorqueSensor, TrueSlip,
};
pub use crate::messages::contact::Contact;
pub use crate::messages::efforts::Efforts;
pub use crate::messages::facts::{CapFacts, CarryGoal, RunFacts};
pub use crate::messages::felt::Felt;
pub use crate::messages::image::Image;
pub use crate::messages::model::{FingerModel, Solid, SolidFrame, SolidShape};
pub use crate::messages::names::{FindingName, SensingKind, TaskKind, TaskOutcome};
pub use crate::messages::recorded::RecordedMessage;
pub use crate::messages::run_end::{RunEnd, RunState};
pub use crate::messages::topic::{RecordedTopic, topics};
pub use crate::reading::digest::Digest;
pub use crate::reading::part::PART;
pub use crate::reading::recorded_camera::RecordedCamera;
pub use crate::reading::recording::{FingerRecord, Gap, PictureAt, Recording};
pub use crate::reading::replay::{RecordedHand, RecordedSensor};
pub use crate::reading::steps::{FingerStep, Step, Steps};
pub use crate::sensed::images::SensedPictures;
pub use crate::sensed::readings::{SensedWriter, read_moments};
pub use crate::sensed::taxel_messages::{TaxelFacts, TaxelMessages};
pub use crate::writing::buffer_recorder::BufferRecorder;
pub use crate::writing::closing::CLOSE_TIMEOUT;
pub use crate::writing::instruments::InstrumentRecord;
pub use crate::writing::memory::{MemoryRecorder, MessageSink};
pub use crate::writing::newest::{LatestAt, SAME_TIME};
pub use crate::writing::options::{Backpressure, FLUSH_INTERVAL, PolicyFile, RecordOptions};
pub use crate::writing::recorder::Recorder;
pub use crate::writing::run_log::RunLog;
pub use error::RecordError;
pub use feeler::control::Phase;
