#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod calibration;
mod camera;
mod league;
mod record_skin;
mod score_slip;
mod sense;

pub use camera::{CameraName, CameraOptions, NAMES, NO_GENICAM, NO_VIDEO, OpenCamera};
pub use league::{LeagueOptions, league};
pub use record_skin::{SkinRecordOptions, record_skin};
pub use score_slip::{RecordedOptions, SlipScoreOptions, score_slip};
pub use sense::{
    ContactOptions, SenseOptions, TaxelOptions, Track, named_sensor, read_taxel_layout, sense,
    taxel_layout_text,
};
