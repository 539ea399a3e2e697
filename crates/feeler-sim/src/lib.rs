#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod balance;
pub mod calibration_bench;
pub mod camera_noise;
pub mod columnar_feeler;
pub mod config;
pub mod direct_sensor;
pub mod element;
pub mod error;
pub mod fault;
pub mod free_bodies;
pub mod holder;
pub mod knurled_cylinder;
pub mod mesh_file;
pub mod model;
pub mod object;
pub mod optics;
pub mod optics_config;
pub mod optics_model;
pub mod pose;
pub mod prism;
pub mod random;
pub mod relaxation;
pub mod rig;
pub mod rig_faults;
pub mod section;
pub mod sensor_faults;
pub mod servo;
pub mod shape;
pub mod sim_camera;
mod start;
pub mod state;
pub mod step;
pub mod thread;
pub mod torque_sensor;
pub mod world;
