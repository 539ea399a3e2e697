//! Simulated bodies: meshes and shapes, boxes and caps compared with MuJoCo, and a soft tip with closed forms.

mod meshes;
mod mujoco_box;
mod mujoco_cap;
#[path = "../../support/mujoco_scene.rs"]
mod mujoco_scene;
#[path = "../../support/soft_tip.rs"]
mod scene;
mod shapes;
mod soft_tip;
