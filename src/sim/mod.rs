//! The simulated rig: feelers, an object to touch, a torque sensor, servos, and the camera's picture.

pub mod calibration_bench;
pub mod camera_noise;
pub mod cap;
pub mod config;
pub mod direct_sensor;
pub mod feeler;
pub mod knurled_cylinder;
pub mod mesh_file;
pub mod model;
pub mod object;
pub mod optics;
pub mod optics_config;
pub mod optics_model;
pub mod random;
pub mod rig;
pub mod servo;
pub mod sim_camera;
pub mod state;
pub mod step;
pub mod torque_sensor;
pub mod world;
