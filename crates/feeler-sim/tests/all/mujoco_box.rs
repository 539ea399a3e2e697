//! A free box on a table, dropped, tipped and pushed, compared with MuJoCo.
//!
//! `references/mujoco_box.json` contains MuJoCo's results; `references/mujoco_box.py` regenerates it.

use crate::experiment_file::read;
use feeler_sim::objects::{FreeConfig, MotionConfig, ObjectConfig};
use feeler_sim::shapes::ShapeConfig;
use feeler_sim::world::{SimConfig, World};
use glam::DVec3;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Deserialize)]
struct Reference {
    header: Header,
    #[serde(flatten)]
    cases: BTreeMap<String, Case>,
}

#[derive(Deserialize)]
struct Header {
    half_size: [f64; 3],
    mass: f64,
    friction: f64,
    sample: f64,
}

#[derive(Deserialize)]
struct Case {
    /// Initial position (m), tilt about y (rad), force along x (N), height of its point above the centre (m), and end
    /// (s).
    case: ([f64; 3], f64, f64, f64, f64),
    /// Position (m) and quaternion (w, x, y, z) every `sample` seconds.
    poses: Vec<[f64; 7]>,
}

fn reference() -> Reference {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/references/mujoco_box.json"
    );
    let text = std::fs::read_to_string(file).expect("the reference");
    serde_json::from_str(&text).expect("a reference")
}

fn object(shape: ShapeConfig, motion: MotionConfig) -> ObjectConfig {
    ObjectConfig {
        shape,
        motion,
        position: [0.0; 3],
        orientation_deg: [0.0; 3],
        offset: [0.0; 3],
        friction: None,
    }
}

fn world(header: &Header, case: &Case) -> World {
    let mut sim: SimConfig = read("experiments/cap-closing.toml", "sim");
    let shape = ShapeConfig::Box {
        size: header.half_size.map(|h| 2.0 * h),
    };
    let motion = MotionConfig::Free(FreeConfig {
        density: 1000.0,
        mass: Some(header.mass),
        inertia: None,
        friction: header.friction,
    });
    let (start, tilt, ..) = case.case;
    let free = ObjectConfig {
        position: start,
        orientation_deg: [0.0, tilt.to_degrees(), 0.0],
        ..object(shape, motion)
    };
    let table = object(ShapeConfig::HalfSpace, MotionConfig::Fixed);
    sim.object = [("box".into(), free), ("table".into(), table)].into();
    World::new(&sim, &[], &[], Path::new(""), 0).expect("a world")
}

/// Position (m) and pitch (rad) of the box in MuJoCo and in feeler, for each sample.
fn compare(name: &str) -> Vec<[(DVec3, f64); 2]> {
    let reference = reference();
    let (header, case) = (&reference.header, &reference.cases[name]);
    let (_, _, force, height, _) = case.case;
    let mut world = world(header, case);
    let every = (header.sample / world.model().step).round() as usize;
    let poses = case.poses.iter().map(|&[x, y, z, w, _, pitch, _]| {
        for _ in 0..every {
            let pose = world.state().objects[0].pose;
            let point = pose.to_world(DVec3::new(-header.half_size[0], 0.0, height));
            world.push(0, force * DVec3::X, point);
            world.step().expect("a step");
        }
        let pose = world.state().objects[0].pose;
        let ours = f64::atan2(-pose.rotation.x_axis.z, pose.rotation.x_axis.x);
        let theirs = 2.0 * f64::atan2(pitch, w);
        [(DVec3::new(x, y, z), theirs), (pose.position, ours)]
    });
    poses.collect()
}

/// Largest differences of the positions along x and z (m) and of the pitch (rad) over the samples.
fn largest(samples: &[[(DVec3, f64); 2]]) -> (f64, f64, f64) {
    let worst = |difference: fn(&[(DVec3, f64); 2]) -> f64| {
        let differences = samples.iter().map(|sample| difference(sample).abs());
        differences.fold(0.0, f64::max)
    };
    (
        worst(|[a, b]| a.0.x - b.0.x),
        worst(|[a, b]| a.0.z - b.0.z),
        worst(|[a, b]| a.1 - b.1),
    )
}

/// Penetration (m) of a box at rest in MuJoCo, whose contacts are softer than feeler's.
const SOFTNESS: f64 = 2e-5;

#[test]
fn a_dropped_box_falls_and_comes_to_rest_as_in_mujoco() {
    let poses = compare("dropped_flat");
    // Half a millisecond at the fall's 0.6 m/s, as both integrate in first order.
    let (along, up, pitch) = largest(&poses);
    assert!(
        along < SOFTNESS && up < 4e-4 && pitch < 1e-3,
        "{along} {up} {pitch}"
    );
    let (_, up, _) = largest(&poses[10..]);
    assert!(up < SOFTNESS, "{up} m at rest");
}

#[test]
fn a_box_dropped_on_its_edge_rocks_and_comes_to_rest_as_in_mujoco() {
    let poses = compare("dropped_tilted");
    // Over the first four impacts. Each depends on the previous ones and on the contacts' stiffness: at 0.6 m/s, a
    // corner penetrates by 0.6 m/s 5 ms / e = 1.1 mm with MuJoCo's time constant of 5 ms.
    let (along, up, pitch) = largest(&poses[..11]);
    assert!(
        along < 2e-4 && up < 1.1e-3 && pitch < 4e-3,
        "{along} {up} {pitch}"
    );
    let (along, up, pitch) = largest(&poses[30..]);
    assert!(
        along < 1e-4 && up < SOFTNESS && pitch < 1e-3,
        "{along} {up} {pitch}"
    );
}

#[test]
fn a_weakly_pushed_box_stays_as_in_mujoco() {
    let (along, up, pitch) = largest(&compare("pushed_stays"));
    assert!(
        along < SOFTNESS && up < SOFTNESS && pitch < 2e-4,
        "{along} {up} {pitch}"
    );
}

#[test]
fn a_box_pushed_low_slides_as_in_mujoco() {
    let poses = compare("pushed_slides");
    // MuJoCo's box rattles by up to 20 mrad, which reduces its friction.
    let (along, _, pitch) = largest(&poses);
    assert!(
        along < 6e-4 && pitch < 0.03,
        "{along} m of 200 mm, {pitch} rad"
    );
}

#[test]
fn a_box_pushed_high_tips_over_as_in_mujoco() {
    let poses = compare("pushed_tips");
    let falling = poses
        .iter()
        .take_while(|[theirs, _]| theirs.1 < 1.5)
        .count();
    let (along, up, pitch) = largest(&poses[..falling]);
    assert!(
        along < 5e-4 && up < 3e-4 && pitch < 0.01,
        "{along} {up} {pitch}"
    );
    let [(_, theirs), (_, ours)] = poses[poses.len() - 1];
    assert!(
        (theirs - ours).abs() < 3e-3,
        "expected a pitch of {theirs} rad, got {ours} rad"
    );
}
