//! Recordings: writing, reading (also by other tools), reports and replay.

mod claims;
mod digest;
mod figures;
mod long_run;
mod mcap_tools;
mod page_contract;
mod page_data;
mod python;
mod real_rig;
mod recorded_camera;
mod recording;
mod replay;
mod report;
mod rewritten;
mod strokes;
mod tactile_array;
mod viewers;
