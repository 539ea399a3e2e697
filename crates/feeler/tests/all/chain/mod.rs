//! Kinematics of chains compared with Pinocchio, nalgebra, finite differences and the finger of three joints.

mod configuration;
mod extremes;
mod inverse_kinematics;
mod paper_finger;
mod pinocchio;
mod redundancy;
mod resolved_rate;

use feeler::hand::chain::{Chain, ChainConfig, DhRow, JointConfig, MAX_JOINTS};
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use serde::Deserialize;
use std::collections::BTreeMap;

type Joints = [f64; MAX_JOINTS];

/// Finger of `references/chain.json`.
#[derive(Deserialize)]
struct Reference {
    config: ChainConfig,
    samples: Vec<Sample>,
}

/// Results of Pinocchio at one set of joint positions. Matrices are in column order.
#[derive(Deserialize)]
struct Sample {
    joints: Vec<f64>,
    position: DVec3,
    rotation: [f64; 9],
    jacobian: Vec<f64>,
}

fn references() -> BTreeMap<String, Reference> {
    serde_json::from_str(include_str!("../../references/chain.json")).unwrap()
}

fn reference_chain(name: &str) -> Chain {
    Chain::new(&references()[name].config).unwrap()
}

fn reference_chains() -> Vec<Chain> {
    let references = references().into_values();
    references.map(|r| Chain::new(&r.config).unwrap()).collect()
}

/// Joint positions within the limits.
fn random_joints(rng: &mut Pcg64Mcg, chain: &Chain) -> Joints {
    let (lower, upper) = (chain.joint_lower(), chain.joint_upper());
    let mut joints = [0.0; MAX_JOINTS];
    for (joint, q) in joints.iter_mut().enumerate().take(chain.joint_count()) {
        *q = rng.random_range(lower[joint]..upper[joint]);
    }
    joints
}

fn random_vector(rng: &mut Pcg64Mcg) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| rng.random_range(-1.0..1.0)))
}

/// Fingertip velocity of joint velocities.
fn fingertip_velocity(chain: &Chain, joints: &Joints, velocity: &Joints) -> DVec3 {
    let columns = chain.jacobian(joints).into_iter().zip(velocity);
    columns.map(|(column, &v)| column * v).sum()
}

fn within_limits(chain: &Chain, joints: &Joints) -> bool {
    let (lower, upper) = (chain.joint_lower(), chain.joint_upper());
    (0..chain.joint_count()).all(|j| (lower[j]..=upper[j]).contains(&joints[j]))
}

/// A chain of revolute joints of +-2 rad in the x-y plane of the world, with links of 0.04 m.
fn planar(joints: usize) -> ChainConfig {
    let name = |index| format!("joint {index}");
    ChainConfig {
        base_position: [0.0; 3],
        base_rpy: [0.0; 3],
        joints: (0..joints)
            .map(|index| JointConfig {
                name: name(index),
                lower: -2.0,
                upper: 2.0,
                speed: 3.0,
            })
            .collect(),
        dh: (0..joints)
            .map(|index| DhRow {
                joint: Some(name(index)),
                a: 0.04,
                ..DhRow::default()
            })
            .collect(),
        frames: Vec::new(),
        tip_position: [0.0; 3],
        tip_rpy: [0.0; 3],
        damping_threshold: None,
    }
}
