//! Tests of this crate, linked into a single program.
//!
//! They run under an allocator that aborts the process if the sensor allocates.
#![allow(
    clippy::disallowed_methods,
    reason = "test inputs need not be bit-identical across platforms"
)]

mod bodies;
#[path = "../support/experiment_file.rs"]
mod experiment_file;
mod meshes;
mod mujoco_box;
mod mujoco_cap;
#[path = "../support/mujoco_scene.rs"]
mod mujoco_scene;
mod physics;
mod rig;
mod sensor;
mod sensor_allocation;
mod shapes;
mod soft_tip;
#[path = "../support/soft_tip.rs"]
mod soft_tip_scene;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
