//! Simulated bodies: meshes and shapes, and boxes and caps compared with MuJoCo.

mod meshes;
mod mujoco_box;
mod mujoco_cap;
#[path = "../../support/mujoco_scene.rs"]
mod mujoco_scene;
mod shapes;
