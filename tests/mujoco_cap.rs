//! Two fingertips turn a cap: feeler's quasi-static feelers against MuJoCo, under the same motion.
//!
//! `references/mujoco_cap_*.json` are MuJoCo's part; `references/mujoco_cap.py` makes them anew.

use feeler::config::Experiment;
use feeler::hand::finger::{FingerConfig, FingerGeometry};
use feeler::sensor::layout::{ElementLayout, LayoutConfig};
use feeler::sim::model::Model;
use feeler::sim::servo::Joints;
use feeler::sim::state::State;
use feeler::sim::step::step;
use glam::DVec3;
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
struct Reference {
    header: Header,
    /// rad, after every `sample` seconds.
    cap_angle: Vec<f64>,
    /// "finger/element" to F_x, F_y, F_z, N, of those that touch at all.
    forces: BTreeMap<String, Vec<[f64; 3]>>,
}

#[derive(Deserialize)]
struct Header {
    dome_radius: f64,
    tip_radius: f64,
    normal_stiffness: f64,
    shear_stiffness: f64,
    friction: f64,
    cap: Cap,
    links: [f64; 3],
    bases: Vec<[f64; 3]>,
    phi1_deg: Vec<f64>,
    knot_times: Vec<f64>,
    /// Per finger and knot, rad.
    knot_joints: Vec<Vec<[f64; 3]>>,
    sample: f64,
    /// Until when halving MuJoCo's step changes its cap angle by less than 0.5 % of the last, s.
    converged_until: f64,
}

#[derive(Deserialize)]
struct Cap {
    radius: f64,
    height: f64,
    position: [f64; 3],
    running_torque: f64,
    seat_angle: f64,
    seat_stiffness: f64,
}

impl Header {
    /// Joint angles of `finger` at `time`, rad.
    fn joints(&self, finger: usize, time: f64) -> DVec3 {
        let knots = &self.knot_joints[finger];
        let after = self.knot_times.iter().position(|&t| t > time);
        let i = after.unwrap_or(knots.len() - 1) - 1;
        let (from, to) = (self.knot_times[i], self.knot_times[i + 1]);
        let s = ((time - from) / (to - from)).clamp(0.0, 1.0);
        let s = s * s * (3.0 - 2.0 * s);
        DVec3::from_array(knots[i]).lerp(DVec3::from_array(knots[i + 1]), s)
    }
}

/// The one place that knows how the simulator is set up and driven.
struct Scene {
    model: Model,
    state: State,
}

impl Scene {
    fn new(header: &Header, time_step: f64) -> Self {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/experiments/cap-closing.toml");
        let mut sim = Experiment::load(file, &[])
            .expect("an experiment")
            .config
            .sim;
        sim.step = time_step;
        sim.servo.lag = 0.0;
        sim.torque_sensor.stiffness = 1e9;
        sim.variation.bottle_position = 0.0;
        sim.variation.friction = 0.0;
        sim.variation.seat_angle = 0.0;
        sim.feeler.normal_stiffness = header.normal_stiffness;
        sim.feeler.shear_stiffness = header.shear_stiffness;
        sim.feeler.tip_radius = header.tip_radius;
        sim.feeler.static_friction = header.friction;
        sim.feeler.kinetic_friction = header.friction;
        sim.cap.radius = header.cap.radius;
        sim.cap.height = header.cap.height;
        sim.cap.position = header.cap.position;
        sim.cap.running_torque = header.cap.running_torque;
        sim.cap.seat_angle = header.cap.seat_angle;
        sim.cap.seat_stiffness = header.cap.seat_stiffness;
        sim.cap.static_factor = 1.0;
        sim.cap.lead = 0.0;
        let layout = LayoutConfig::default();
        assert!((layout.dome_radius - header.dome_radius).abs() < 1e-12);
        let fingers = header.bases.iter().zip(&header.phi1_deg);
        let fingers = fingers.map(|(&base_position, &phi1_deg)| {
            FingerGeometry::new(&FingerConfig {
                base_position,
                phi1_deg,
                phi2_deg: 0.0,
                links: header.links,
                joint_lower_deg: [-180.0; 3],
                joint_upper_deg: [180.0; 3],
                joint_speed_limit: [10.0; 3],
            })
            .expect("a finger")
        });
        let model = Model::new(&sim, fingers.collect(), ElementLayout::new(&layout), 0);
        let start: Vec<_> = (0..header.bases.len())
            .map(|f| header.joints(f, 0.0))
            .collect();
        let state = State::new(&model, &start);
        Self { model, state }
    }

    /// Steps with the fingers at `joints` (rad) at the end of it.
    fn advance(&mut self, joints: impl Fn(usize) -> DVec3) {
        for (f, finger) in self.state.fingers.iter_mut().enumerate() {
            finger.joints = Joints::at_rest(joints(f));
        }
        step(&self.model, &mut self.state);
    }

    fn cap_angle(&self) -> f64 {
        self.state.cap.angle
    }

    /// F_x, F_y on the feeler, F_z compression, N, in the element's frame.
    fn force(&self, finger: usize, element: usize) -> DVec3 {
        let finger = &self.state.fingers[finger];
        let to_world = finger.rotation * self.model.layout.elements[element].rotation;
        let on_feeler = to_world.transpose() * -finger.forces[element];
        on_feeler.with_z(-on_feeler.z)
    }
}

/// How far feeler is from MuJoCo.
#[derive(Debug)]
struct Difference {
    /// Largest while MuJoCo agrees with itself, relative to MuJoCo's final cap angle.
    converged_cap_angle: f64,
    /// In the end.
    final_cap_angle: f64,
    /// RMS over time and touching elements, over the RMS of MuJoCo's.
    forces: f64,
}

fn compare(reference: &Reference, time_step: f64) -> Difference {
    let header = &reference.header;
    let mut scene = Scene::new(header, time_step);
    let every = (header.sample / time_step).round() as usize;
    let last = *reference.cap_angle.last().expect("samples");
    let (mut worst, mut in_the_end) = (0.0_f64, 0.0);
    let (mut error, mut size) = (0.0, 0.0);
    let mut steps = 0_u32;
    for (sample, &angle) in reference.cap_angle.iter().enumerate() {
        for _ in 0..every {
            steps += 1;
            let time = f64::from(steps) * time_step;
            scene.advance(|finger| header.joints(finger, time));
        }
        in_the_end = (scene.cap_angle() - angle) / last;
        if (sample + 1) as f64 * header.sample <= header.converged_until {
            worst = worst.max(in_the_end.abs());
        }
        for finger in 0..header.bases.len() {
            for element in 0..scene.model.layout.elements.len() {
                let name = format!("{finger}/{element}");
                let theirs = reference.forces.get(&name).map_or([0.0; 3], |f| f[sample]);
                let theirs = DVec3::from_array(theirs);
                error += (scene.force(finger, element) - theirs).length_squared();
                size += theirs.length_squared();
            }
        }
        if std::env::var_os("FEELER_TRACE").is_some() {
            println!("{sample} {:.5} {angle:.5}", scene.cap_angle());
            for name in ["0/0", "0/1", "0/3", "0/5", "0/7"] {
                let element = name[2..].parse().expect("an element");
                let ours = scene.force(0, element);
                println!(
                    "   {name} {ours:.4} {:.4?}",
                    reference.forces.get(name).map(|f| f[sample])
                );
            }
        }
    }
    Difference {
        converged_cap_angle: worst,
        final_cap_angle: in_the_end,
        forces: (error / size).sqrt(),
    }
}

/// Relative goals: cap angle, forces.
const GOALS: (f64, f64) = (0.015, 0.05);

fn check(name: &str) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/references");
    let text = std::fs::read_to_string(format!("{folder}/mujoco_cap_{name}.json"));
    let reference: Reference =
        serde_json::from_str(&text.expect("the reference")).expect("a reference");
    assert!(reference.cap_angle.last().is_some_and(|&a| a > 0.1));
    let differences = [0.001, 0.0005, 0.00025].map(|step| (step, compare(&reference, step)));
    for (step, difference) in &differences {
        println!("{name}, {step} s: {difference:?}");
    }
    for (step, difference) in &differences {
        let (angle, forces) = (difference.converged_cap_angle, difference.forces);
        assert!(angle <= GOALS.0, "{step} s: {difference:?}");
        assert!(
            difference.final_cap_angle.abs() <= GOALS.0,
            "{step} s: {difference:?}"
        );
        assert!(forces <= GOALS.1, "{step} s: {difference:?}");
    }
}

#[test]
fn cap_angle_and_element_forces_agree_with_mujoco() {
    check("point_tips");
}

/// A stuck tip's centre goes round with the cap in feeler, which turns the cap by 14 / 15.5 of what
/// a tip that cannot rotate does.
#[test]
#[ignore = "a feeler's round tip does not roll on the cap yet: cap angle is off by 7 %"]
fn with_round_tips_too() {
    check("round_tips");
}
