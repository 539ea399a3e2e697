//! Connects a custom hand and a custom tactile sensor in a loop at 100 Hz. Both are toys: the drives follow their
//! commands instantly, and the feelers are springs that touch a wall, which the finger approaches, strokes and
//! leaves.

use feeler::control::task::TaskConfig;
use feeler::control::{ControlConfig, ControlLoop, Controller, FlaggedSensor, Phase};
use feeler::glam::DVec3;
use feeler::hand::kinematics::fingertip_pose;
use feeler::hand::{
    FingerConfig, FingerGeometry, Hand, HandCommand, HandError, HandState, JointState, JointVector,
    inverse_kinematics,
};
use feeler::pace::FixedRate;
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use std::{cell::Cell, ops::ControlFlow, rc::Rc, sync::atomic::AtomicBool};

#[derive(serde::Deserialize)]
struct Config {
    finger: FingerConfig,
    layout: LayoutConfig,
    control: ControlConfig,
    task: TaskConfig,
}

/// Joint angles (rad) and time (s), the readings of a rig's encoders and clock.
type Rig = Rc<Cell<(JointVector, f64)>>;

/// A finger whose drives follow their commands instantly.
pub struct MyHand {
    rig: Rig,
    velocity: JointVector,
    period: f64,
}

impl Hand for MyHand {
    fn finger_count(&self) -> usize {
        1
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        let (position, stamp) = self.rig.get(); // replace: read the encoders
        let velocity = self.velocity;
        state.stamp = stamp;
        state.joints.fill(JointState { position, velocity });
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.velocity = command.joint_velocity()[0]; // replace: send it to the drives
        let (position, stamp) = self.rig.get();
        let moved = position + self.period * self.velocity;
        self.rig.set((moved, stamp + self.period));
        Ok(())
    }
}

/// Feelers that act as springs on a wall.
pub struct MyTouch {
    rig: Rig,
    finger: FingerGeometry,
    layout: ElementLayout,
    frames: u64,
}

impl TactileSensor for MyTouch {
    fn element_count(&self) -> usize {
        self.layout.elements.len()
    }

    /// Replace by your sensor, for example `OpticalSensor`, which combines a camera and a calibration.
    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        const WALL: f64 = -0.018; // m, x in W
        const STIFFNESS: f64 = 200.0; // N/m
        let (theta, stamp) = self.rig.get();
        let (centre, rotation) = fingertip_pose(&self.finger, theta);
        for (element, force) in reading.forces.iter_mut().enumerate() {
            let tip = centre + rotation * self.layout.tip(element);
            *force = DVec3::Z * (STIFFNESS * (tip.x - WALL)).max(0.0);
        }
        (reading.sequence, reading.stamp) = (self.frames, stamp);
        self.frames += 1;
        Ok(())
    }
}

type Failure = Box<dyn std::error::Error>;

/// Creates the loop, with the finger at home.
pub fn control_loop() -> Result<ControlLoop<FlaggedSensor<MyTouch>, MyHand>, Failure> {
    let config: Config = toml::from_str(include_str!("own_hand.toml"))?;
    let (period, thresholds) = (config.control.period, config.control.thresholds());
    let finger = FingerGeometry::new(&config.finger)?;
    let layout = ElementLayout::new(&config.layout);
    let home = config.task.homes()[0].into();
    let home = inverse_kinematics(&finger, home, finger.joint_lower())?;
    let (fingers, layouts) = ([finger.clone()], [layout.clone()]);
    let controller = Controller::new(config.control, &config.task, &fingers, &layouts)?;
    let rig = Rig::new(Cell::new((home, 0.0)));
    let touch = MyTouch {
        rig: rig.clone(),
        finger,
        layout,
        frames: 0,
    };
    let hand = MyHand {
        rig,
        velocity: JointVector::default(),
        period,
    };
    let sensors = vec![FlaggedSensor::new(touch, thresholds)];
    Ok(ControlLoop::new(sensors, hand, controller))
}

/// Runs the task. Returns its final phase and the maximum grasp force (N).
pub fn touch_and_stroke() -> Result<(Phase, f64), Failure> {
    let mut control_loop = control_loop()?;
    let interrupted = AtomicBool::new(false); // replace: set on Ctrl-C
    let mut greatest = 0.0_f64;
    control_loop.run(
        &mut FixedRate::new(0.01)?,
        100,
        &interrupted,
        |after, _tick| {
            greatest = greatest.max(after.touches()[0].flags.grasp_force);
            match after.controller().phase().is_final() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        },
    )?;
    Ok((control_loop.controller().phase(), greatest))
}

fn main() -> Result<(), Failure> {
    let (phase, force) = touch_and_stroke()?;
    println!("{phase:?} with {force:.2} N at most");
    Ok(())
}
