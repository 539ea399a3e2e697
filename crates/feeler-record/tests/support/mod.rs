//! A synthetic but plausible run: two fingers close a cap in four strokes.

#![allow(dead_code, reason = "not every test program needs all of it")]

use feeler::hand::{FingerConfig, FingerDescription};
use feeler_record::wire::{Quaternion, Vector3};
use feeler_record::{
    Cap, Command, Digest, FindingName, Findings, FingerModel, Fingertip, Flags, Joints,
    MessageSink, NO_ELEMENT, Phase, RecordError, Recorder, RunFacts, Tactile, Task, TaskOutcome,
    TorqueSensor, TrueSlip, topics,
};
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

pub const ELEMENTS: usize = 41;
pub const PERIOD: f64 = 0.01;
const FINGERS: usize = 2;
const CAP_RADIUS: f64 = 0.014;
const TIP_RADIUS: f64 = 0.0015;
const DOME_RADIUS: f64 = 0.018;
/// Distance of a dome's centre from the axis when its tip touches the cap.
const REACH: f64 = DOME_RADIUS + CAP_RADIUS + TIP_RADIUS;
/// Curvature of each stroke's path, relative to the arc about the cap's axis.
pub const BENDS: [f64; 4] = [0.1, 0.7, 0.95, 0.95];
/// Length of a stroke (m).
pub const TRAVEL: f64 = 0.010;
/// Phases of a stroke and their numbers of control steps.
const PHASES: [(Phase, usize); 4] = [
    (Phase::Search, 90),
    (Phase::Move, 100),
    (Phase::Release, 30),
    (Phase::Return, 80),
];

pub const EXPERIMENT: &str = "# A made-up run.\nname = \"made up <&> \\\"quoted\\\"\"\n[control]\nslip_threshold = 3.0 # N/s\n";

pub fn facts() -> RunFacts {
    RunFacts {
        experiment: "made-up".into(),
        task: "screw".into(),
        seed: u64::MAX,
        version: "0.1.0".into(),
        sensing: "direct".into(),
        law: None,
        control_period: PERIOD,
        fingers: FINGERS,
        cap_radius: CAP_RADIUS,
        feeler_tip_radius: TIP_RADIUS,
        touch_force_threshold: 0.1,
        over_force_threshold: 1.5,
        slip_threshold: 3.0,
        grasp_force_threshold: 1.0,
        approach: vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        stroke_direction: vec![[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]],
        stroke_count: 4,
        section: Vec::new(),
        truth: BTreeMap::new(),
        cap: None,
        carry: None,
        hand: vec![finger_model(1.0), finger_model(-1.0)],
        solids: Vec::new(),
        replay_of: None,
    }
}

/// Model of the finger on this side (-1 or 1) of the cap.
fn finger_model(side: f64) -> FingerModel {
    let tip = |element| (DOME_RADIUS * normal(element, side)).to_array();
    FingerModel {
        geometry: FingerDescription::ThreeJoints(FingerConfig {
            base_position: [side * 0.1, 0.0, 0.1],
            phi1_deg: 0.0,
            phi2_deg: 0.0,
            links: [0.0, 0.06, 0.055],
            joint_lower_deg: [-90.0; 3],
            joint_upper_deg: [90.0; 3],
            joint_speed_limit: [2.0; 3],
        }),
        dome_radius: DOME_RADIUS,
        element_tips: (0..ELEMENTS).map(tip).collect(),
    }
}

/// Instruments of a synthetic run besides the hand.
#[derive(Debug, Clone, Copy)]
pub struct Rig {
    /// `true` if the rig is simulated, with ground truth of cap and feelers.
    pub simulated: bool,
    /// Time of the torque sensor's first sample (s), or `None` without a sensor.
    pub torque_from: Option<f64>,
    /// `true` if the hand reports findings about the cap and the final outcome.
    pub feels: bool,
}

/// Rig with all instruments.
pub const SIMULATED: Rig = Rig {
    simulated: true,
    torque_from: Some(0.0),
    feels: false,
};

/// Rig without instruments.
pub const REAL: Rig = Rig {
    simulated: false,
    torque_from: None,
    feels: false,
};

/// Writes a run of `strokes` strokes and closes it.
pub fn write_run(path: &Path, strokes: u32) -> Result<Digest, RecordError> {
    let mut recorder = Recorder::create(path, &facts(), EXPERIMENT)?;
    write_strokes(&mut recorder, strokes)?;
    recorder.finish(Some(0.25))
}

/// Writes a run of four strokes on a rig and closes it.
pub fn write_run_on(path: &Path, rig: Rig) -> Result<Digest, RecordError> {
    let mut facts = facts();
    if !rig.simulated {
        facts.cap_radius = 0.0;
        facts.feeler_tip_radius = 0.0;
    }
    let mut recorder = Recorder::create(path, &facts, EXPERIMENT)?;
    write_strokes_on(&mut recorder, facts.stroke_count, rig)?;
    recorder.finish(Some(0.25))
}

/// Writes the messages of `strokes` strokes, followed by DONE if there are four.
pub fn write_strokes(recorder: &mut Recorder, strokes: u32) -> Result<(), RecordError> {
    write_strokes_on(recorder, strokes, SIMULATED)
}

/// Like [`write_strokes`], but on `rig`.
pub fn write_strokes_on(
    recorder: &mut Recorder,
    strokes: u32,
    rig: Rig,
) -> Result<(), RecordError> {
    let mut run = MadeUp::on(rig);
    for stroke in 1..=strokes {
        for (phase, steps) in PHASES {
            for step in 0..steps {
                run.step(recorder, stroke, phase, step as f64 / steps as f64)?;
            }
        }
    }
    if strokes == facts().stroke_count {
        for _ in 0..20 {
            run.step(recorder, strokes, Phase::Done, 0.0)?;
        }
    }
    Ok(())
}

struct MadeUp {
    rig: Rig,
    step: u64,
    noise: u64,
    angle: f64,
    last_shear: [f64; FINGERS],
    last_press: f64,
    slipping: [bool; FINGERS],
}

impl MadeUp {
    fn on(rig: Rig) -> Self {
        Self {
            rig,
            step: 0,
            noise: 0,
            angle: 0.0,
            last_shear: [0.0; FINGERS],
            last_press: 0.0,
            slipping: [false; FINGERS],
        }
    }

    /// Pseudo-random noise in -1..1, identical in all runs.
    fn noise(&mut self) -> f64 {
        let next = self.noise.wrapping_mul(6364136223846793005);
        self.noise = next.wrapping_add(1442695040888963407);
        (self.noise >> 33) as f64 / (1u64 << 30) as f64 - 1.0
    }

    fn step(
        &mut self,
        recorder: &mut Recorder,
        stroke: u32,
        phase: Phase,
        s: f64,
    ) -> Result<(), RecordError> {
        let stamp = self.step as f64 * PERIOD;
        let k = (stroke as usize).min(4) - 1;
        let (press, travel) = motion(phase, s);
        let closing = [
            [0.003, 0.029],
            [0.050, 0.071],
            [0.079, 0.081],
            [0.080, 0.081],
        ][k];
        let tightness = [0.0, 0.7, 1.0, 1.0][k];
        let bump = tightness * (TAU * 7.0 * s).sin().max(0.0) * travel.min(0.3) / 0.3;
        let moving = phase == Phase::Move;
        let torque = match phase {
            Phase::Move => {
                let rise =
                    closing[0] + (closing[1] - closing[0]) * ((s - 0.3) / 0.5).clamp(0.0, 1.0);
                rise * (s / 0.15).min(1.0) * (1.0 - 0.2 * bump)
            }
            Phase::Release => 0.6 * closing[1] * (1.0 - s / 0.3).max(0.0),
            _ => 0.0,
        };
        if moving {
            self.angle += [0.4, 0.08, 0.02, 0.0][k] / 100.0;
        }
        let grasp = press * ([1.2, 1.7, 2.1, 2.1][k] + 0.2 * bump);
        let bend = BENDS[k] * sagitta(TRAVEL * travel);
        for finger in 0..FINGERS {
            let shear = torque / CAP_RADIUS / 2.0;
            self.finger(recorder, finger, stamp, press, travel, bend, grasp, shear)?;
        }
        self.last_press = press;
        self.instruments(recorder, stamp, torque)?;
        if self.rig.feels {
            let outcome = (phase == Phase::Done).then_some(TaskOutcome::Closed);
            recorder.write(topics::FINDINGS, &self.felt(stamp, torque, outcome))?;
        }
        let reason = format!("{phase:?}");
        self.step += 1;
        recorder.write(
            topics::TASK,
            &Task {
                stamp,
                phase,
                stroke,
                reason,
            },
        )?;
        recorder.step_ends().map(|_| ())
    }

    /// Writes the messages of the rig's instruments.
    fn instruments(
        &mut self,
        recorder: &mut Recorder,
        stamp: f64,
        torque: f64,
    ) -> Result<(), RecordError> {
        let slip = self.slipping.map(|slips| if slips { 30e-6 } else { 5e-6 });
        let noise = 0.0004 * self.noise();
        let slip = TrueSlip {
            stamp,
            distance: slip.into(),
        };
        let sample = TorqueSensor {
            stamp,
            torque: torque + noise,
            bridge_voltage: 12.5 * (torque + noise),
            counts: ((torque + noise) * 40_000.0) as i32,
        };
        let cap = Cap {
            stamp,
            angle: self.angle,
            height: 0.1 - 0.003 * self.angle / TAU,
            centre: Vector3 {
                x: 0.0002,
                y: -0.0001,
                z: 0.1,
            },
            resisting_torque: torque,
        };
        if self.rig.simulated {
            recorder.write(topics::TRUE_SLIP, &slip)?;
        }
        if self.rig.torque_from.is_some_and(|from| stamp >= from) {
            recorder.write(topics::TORQUE_SENSOR, &sample)?;
        }
        if self.rig.simulated {
            recorder.write(topics::CAP, &cap)?;
        }
        Ok(())
    }

    /// Findings of the hand about the cap.
    fn felt(&self, stamp: f64, torque: f64, outcome: Option<TaskOutcome>) -> Findings {
        Findings {
            stamp,
            outcome,
            names: vec![FindingName::Turned, FindingName::Torque],
            values: vec![self.angle, torque],
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn finger(
        &mut self,
        recorder: &mut Recorder,
        finger: usize,
        stamp: f64,
        press: f64,
        travel: f64,
        bend: f64,
        grasp: f64,
        shear: f64,
    ) -> Result<(), RecordError> {
        let side = if finger == 0 { 1.0 } else { -1.0 };
        let reach = REACH + 0.008 * (1.0 - press) - bend;
        let position = side * DVec3::new(reach - 0.0002 * press, TRAVEL * travel, 0.1 * side);
        // The element that faces the cap changes as the finger passes it.
        let largest = if travel < 0.35 { 0 } else { 1 };
        let mut tactile = Tactile {
            sequence: self.step,
            stamp,
            forces: vec![Vector3::default(); ELEMENTS],
        };
        for force in &mut tactile.forces {
            force.z = 0.002 * self.noise();
        }
        if grasp > 0.0 {
            tactile.forces[largest].z += 0.7 * grasp;
            tactile.forces[2].z += 0.3 * grasp;
            tactile.forces[largest].x = shear;
        }
        let rate = (shear - self.last_shear[finger]).abs() / PERIOD;
        self.last_shear[finger] = shear;
        let mut shear_rate = vec![0.05 + 0.05 * self.noise(); ELEMENTS];
        shear_rate[largest] += rate;
        let touch = grasp > 0.1;
        self.slipping[finger] = rate > 3.0;
        recorder.write(topics::tactile(finger), &tactile)?;
        recorder.write(
            topics::flags(finger),
            &Flags {
                stamp,
                touch,
                slip: self.slipping[finger],
                over: grasp > 2.25,
                largest_element: if touch { largest as u32 } else { NO_ELEMENT },
                grasp_force: grasp,
                shear_rate,
            },
        )?;
        recorder.write(
            topics::joints(finger),
            &Joints {
                stamp,
                position: [0.1, travel, press].into(),
                velocity: [0.0, 0.1, -0.1].into(),
            },
        )?;
        recorder.write(
            topics::command(finger),
            &Command {
                stamp,
                joint_velocity: [0.0, 0.1, -0.1].into(),
                fingertip_velocity: DVec3::new(0.0, 0.01, 0.0).into(),
                limited: press < self.last_press,
                damping: 0.0,
            },
        )?;
        recorder.write(
            topics::fingertip(finger),
            &Fingertip {
                stamp,
                position: position.into(),
                orientation: Quaternion {
                    x: 0.0,
                    y: 0.0,
                    z: 0.0,
                    w: 1.0,
                },
            },
        )
    }
}

/// Inward deviation (m) of an arc about the axis from its tangent along the stroke, at distance `along` (m).
pub fn sagitta(along: f64) -> f64 {
    REACH - (REACH * REACH - along * along).sqrt()
}

/// Compression of the fingers (0 away, 1 grasping) and progress along the stroke (0 to 1).
fn motion(phase: Phase, s: f64) -> (f64, f64) {
    match phase {
        Phase::Search => (((s - 0.8) / 0.2).max(0.0), 0.0),
        Phase::Move => (1.0, s),
        Phase::Release => ((1.0 - s * 2.0).max(0.0), 1.0),
        Phase::Return => (0.0, 1.0 - s),
        Phase::Done | Phase::Stopped => (0.0, 0.0),
    }
}

/// Direction of an element from the dome's centre: a pole and a fan around it, facing the cap.
fn normal(element: usize, side: f64) -> DVec3 {
    if element == 0 {
        return DVec3::new(-side, 0.0, 0.0);
    }
    let polar = 0.39 * (1.0 + (element / 14) as f64);
    let azimuth = TAU * (element - 1) as f64 / 8.0;
    side * DVec3::new(
        -polar.cos(),
        -polar.sin() * azimuth.cos(),
        polar.sin() * azimuth.sin(),
    )
}
