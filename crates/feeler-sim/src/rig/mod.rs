//! Simulated hardware of a hand: servos, encoders, torque sensor, direct sensing, and their faults.

pub(crate) mod arm;
pub(crate) mod direct_sensor;
pub(crate) mod fault;
pub(crate) mod fault_check;
pub(crate) mod hand;
pub(crate) mod rig_faults;
pub(crate) mod sensor_faults;
pub(crate) mod servo;
pub(crate) mod torque_sensor;

pub use arm::{ArmMotion, ArmMotionKind, acceleration, displacement};
pub use direct_sensor::DirectSensor;
pub use fault::{FaultConfig, FaultKind};
pub use hand::{SimHand, SimRig};
pub use sensor_faults::SensorFaults;
pub use servo::{Joints, ServoConfig};
pub use torque_sensor::{TorqueReading, TorqueSensorConfig};
