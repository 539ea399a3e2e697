//! One finger with three elements, a task that only moves, and their configuration.

use feeler::control::task::Task;
use feeler::control::{
    ControlConfig, Controller, HandReadings, MonitorConfig, Phase, Plan, StopReason, TactileReading,
};
use feeler::hand::{
    FingerConfig, FingerGeometry, HandState, JointState, JointVector, inverse_kinematics,
};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig, RingConfig};
use glam::DVec3;

const CONTROL: &str = "
period = 0.01
stale_periods = 3.5
touch_force = 0.1
over_force = 2.0
slip_threshold = 4.0
recompression_speed = 0.003
minimum_grasp_force = 0.6
law = \"open-loop\"
[limits]
workspace_lower = [-0.06, -0.03, 0.07]
workspace_upper = [0.06, 0.03, 0.13]
fingertip_speed = 0.05
joint_acceleration = 20.0
element_force = 4.0
";

pub fn control() -> ControlConfig {
    toml::from_str(CONTROL).expect("a controller's configuration")
}

pub fn geometry() -> FingerGeometry {
    let config = FingerConfig {
        base_position: [-0.1655, 0.0, 0.0576],
        phi1_deg: 0.0,
        phi2_deg: 0.0,
        links: [0.030, 0.060, 0.055],
        joint_lower_deg: [-60.0, -30.0, -150.0],
        joint_upper_deg: [60.0, 120.0, 0.0],
        joint_speed_limit: [2.0; 3],
    };
    FingerGeometry::new(&config).expect("a finger")
}

/// Initial joint angles of the finger (rad).
pub fn home() -> JointVector {
    let geometry = geometry();
    let middle = (geometry.joint_lower() + geometry.joint_upper()) / 2.0;
    inverse_kinematics(&geometry, DVec3::new(-0.038, -0.001, 0.1), middle).expect("home")
}

/// An apex element and two others.
pub fn layout() -> ElementLayout {
    let ring = |elements, polar_angle_deg| RingConfig {
        elements,
        polar_angle_deg,
    };
    ElementLayout::new(&LayoutConfig {
        dome_radius: 0.018,
        rings: vec![ring(1, 0.0), ring(2, 45.0)],
        grid: None,
    })
}

/// Moves along y forever and counts its steps.
#[derive(Debug, Clone, Default)]
struct Along {
    asked: u32,
}

impl Task for Along {
    fn advance(&mut self, _: &HandReadings<'_>) -> Result<(), StopReason> {
        self.asked += 1;
        Ok(())
    }

    fn stroke(&self) -> u32 {
        self.asked
    }

    fn plan(&self, _: usize, _: &HandReadings<'_>) -> Plan {
        Plan {
            velocity: 0.01 * DVec3::Y,
            ..Plan::default()
        }
    }

    fn phase(&self) -> Phase {
        Phase::Move
    }
}

pub fn controller() -> Controller {
    controller_with(MonitorConfig::default())
}

/// Like [`controller`], but with this configuration of the monitors.
pub fn controller_with(monitor: MonitorConfig) -> Controller {
    controller_of(1, monitor)
}

/// Controller of this number of equal fingers.
pub fn controller_of(fingers: usize, monitor: MonitorConfig) -> Controller {
    let config = ControlConfig {
        monitor,
        ..control()
    };
    Controller::with_task(
        config,
        Box::new(Along::default()),
        &vec![geometry(); fingers],
        &vec![layout(); fingers],
    )
    .expect("a controller")
}

/// The finger at rest, at 1 s.
pub fn state() -> HandState {
    HandState {
        stamp: 1.0,
        joints: vec![JointState {
            position: home(),
            velocity: JointVector::zeros(3),
        }],
        efforts: Vec::new(),
    }
}

/// Reading without contact at `stamp` (s).
pub fn touch(stamp: f64) -> TactileReading {
    let mut touch = TactileReading::none(layout().elements.len());
    touch.frame.stamp = stamp;
    touch.stamp = stamp;
    touch
}
