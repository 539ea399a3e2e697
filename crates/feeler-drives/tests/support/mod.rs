//! A hand of emulated servos in lockstep, with its packet log.

// Not every test program uses all items.
#![allow(dead_code)]

use feeler::hand::{
    FingerConfig, FingerGeometry, Hand, HandCommand, HandError, HandState, JointVector,
};
use feeler_drives::DriveError;
use feeler_drives::bus::Bus;
use feeler_drives::config::{DrivesConfig, JointDriveConfig};
use feeler_drives::emulator::{EmulatedBus, EmulatorConfig, LagPlant, Lockstep};
use feeler_drives::hand::DriveHand;
use feeler_drives::packet::Protocol;
use feeler_drives::packet::instruction::SYNC_WRITE;
use feeler_drives::registers::{DriveMode, Model, Register, Registers};

/// Model of the servos of [`config`].
pub fn model(protocol: Protocol) -> &'static Model {
    let name = match protocol {
        Protocol::Dynamixel => "XL330-M077",
        Protocol::Feetech => "STS3215",
        Protocol::FeetechScs => "SCS0009",
    };
    Model::named(name).expect("a model")
}

/// Maximum age of the joint angles of a command (s).
pub const MAX_AGE: f64 = 0.035;
/// Control period (s).
pub const PERIOD: f64 = 0.01;

pub fn finger() -> FingerGeometry {
    let config = FingerConfig {
        base_position: [-0.1655, 0.0, 0.0576],
        phi1_deg: 0.0,
        phi2_deg: 0.0,
        links: [0.030, 0.060, 0.055],
        joint_lower_deg: [-60.0, -30.0, -150.0],
        joint_upper_deg: [60.0, 120.0, 0.0],
        joint_speed_limit: [2.0, 2.0, 2.0],
    };
    FingerGeometry::new(&config).expect("a finger")
}

/// Configuration of servos with `protocol`, in the first mode that they support, and different offsets, directions and gear
/// ratios.
pub fn config(protocol: Protocol, fingers: usize) -> DrivesConfig {
    let mut config = DrivesConfig::emulated(&vec![vec![false; 3]; fingers]);
    config.protocol = protocol;
    config.reply_timeout = 0.004;
    if protocol != Protocol::Dynamixel {
        (config.fast_sync_read, config.bus_watchdog, config.baud_rate) = (false, 0.0, 1_000_000);
    }
    let middle = (finger().joint_lower() + finger().joint_upper()) / 2.0;
    for (index, joint) in config
        .finger
        .iter_mut()
        .flat_map(|f| &mut f.joint)
        .enumerate()
    {
        joint.direction = if index % 2 == 0 { 1 } else { -1 };
        joint.homing_offset = 0.3 * index as f64;
        joint.gear_ratio = 1.0 + index as f64;
        joint.current_limit = Some(0.65);
        match protocol {
            Protocol::Dynamixel => {}
            Protocol::Feetech => (joint.model, joint.gear_ratio) = ("STS3215".into(), 1.0),
            Protocol::FeetechScs => {
                (joint.model, joint.gear_ratio) = ("SCS0009".into(), 1.0);
                (joint.mode, joint.current_limit) = (Some(DriveMode::Position), None);
                centre(joint, middle[index % 3]);
            }
        }
    }
    config
}

/// Lets the servo of `joint` be in the middle of its range when the joint is at `position` (rad).
fn centre(joint: &mut JointDriveConfig, position: f64) {
    let half = joint.known_model().expect("a model").range / 2.0;
    joint.homing_offset = position - joint.turn(half);
}

/// Limit of the current in current-limited position mode (A).
pub const CURRENT_LIMIT: f64 = 0.3;

/// Like [`config`], but with all joints in `mode`.
pub fn config_in(protocol: Protocol, mode: DriveMode, fingers: usize) -> DrivesConfig {
    let mut config = config(protocol, fingers);
    let middle = (finger().joint_lower() + finger().joint_upper()) / 2.0;
    let joints = config.finger.iter_mut().flat_map(|f| &mut f.joint);
    for (index, joint) in joints.enumerate() {
        joint.mode = Some(mode);
        if mode == DriveMode::CurrentLimitedPosition {
            joint.current_limit = Some(CURRENT_LIMIT);
        }
        if protocol == Protocol::Feetech && mode != DriveMode::Velocity {
            // Far from the wrap.
            centre(joint, middle[index % 3]);
        }
    }
    config
}

/// Lets the servos of finger 0 also move the joints of finger 1 of `config`, with other gear ratios. Both fingers are in the
/// middle of their ranges at once.
pub fn share(mut config: DrivesConfig) -> DrivesConfig {
    let middle = (finger().joint_lower() + finger().joint_upper()) / 2.0;
    let servos = config.finger[0].joint.clone();
    let joints = config.finger[1].joint.iter_mut().zip(servos);
    for (index, (joint, servo)) in joints.enumerate() {
        *joint = JointDriveConfig {
            shared: true,
            model: String::new(),
            mode: None,
            current_limit: None,
            gear_ratio: servo.gear_ratio * [2.0, 0.8, 1.0][index],
            ..servo.clone()
        };
        joint.homing_offset = middle[index] - joint.turn(servo.horn(middle[index]));
    }
    config
}

/// Simulated mechanism for the servos of `config`, with joints at the middle of their ranges.
pub fn plant(config: &DrivesConfig) -> Box<LagPlant> {
    let geometry = finger();
    let middle = (geometry.joint_lower() + geometry.joint_upper()) / 2.0;
    let servos = config.servos().enumerate();
    let angles = servos.map(|(i, servo)| servo.horn(middle[i % 3]));
    Box::new(LagPlant::new(0.01, &angles.collect::<Vec<_>>()))
}

/// Emulated bus with the servos of `config`.
pub fn bus(config: &DrivesConfig) -> Lockstep {
    Lockstep::new(&EmulatorConfig::of(config, 1), plant(config))
}

/// Master of `bus`.
pub fn master(bus: &Lockstep, config: &DrivesConfig) -> Bus {
    let how = (config.protocol, config.baud_rate);
    Bus::on(
        Box::new(bus.clone()),
        how,
        config.reply_timeout,
        bus.clock(),
    )
}

/// Hand with `config` on `bus`.
pub fn hand_on(bus: &Lockstep, config: &DrivesConfig) -> Result<DriveHand, DriveError> {
    let master = master(bus, config);
    let fingers = vec![finger(); config.finger.len()];
    DriveHand::on(master, config, &fingers, MAX_AGE)
}

/// A hand and its emulated bus.
pub struct Rig {
    pub hand: DriveHand,
    pub state: HandState,
    pub command: HandCommand,
    pub emulator: Lockstep,
    pub config: DrivesConfig,
}

impl Rig {
    pub fn new(protocol: Protocol) -> Self {
        Self::of(config(protocol, 2)).unwrap_or_else(|error| panic!("{error}"))
    }

    pub fn of(config: DrivesConfig) -> Result<Self, DriveError> {
        let emulator = bus(&config);
        Self::on(emulator, config)
    }

    /// Hand with `config` on `emulator`.
    pub fn on(emulator: Lockstep, config: DrivesConfig) -> Result<Self, DriveError> {
        let count = config.finger.len();
        Ok(Self {
            hand: hand_on(&emulator, &config)?,
            state: HandState::zero(count),
            command: HandCommand::stop(count),
            emulator,
            config,
        })
    }

    /// Runs a control period: reads the state and commands all joints with `velocity` (rad/s).
    pub fn period(&mut self, velocity: f64) -> Result<(), HandError> {
        self.hand.read(&mut self.state)?;
        self.command(velocity)?;
        self.emulator.wait(PERIOD);
        Ok(())
    }

    /// Commands all joints with `velocity` (rad/s).
    pub fn command(&mut self, velocity: f64) -> Result<(), HandError> {
        let velocities = vec![JointVector::splat(3, velocity); self.config.finger.len()];
        self.command.relay(&velocities);
        self.hand.command(&self.command)
    }

    /// Checks that a command of `velocity` is refused once the joint angles are too old.
    pub fn refuse_stale_command(&mut self, velocity: f64) {
        // The transmission time of the command itself does not count.
        self.emulator.wait(1.001 * MAX_AGE);
        let error = self.command(velocity).unwrap_err().to_string();
        assert!(
            error.contains("s old: expected at most 0.0350 s"),
            "{error}"
        );
        self.settle();
    }

    /// Current time of the rig (s).
    pub fn now(&self) -> f64 {
        self.emulator.clock().now()
    }

    /// Goal velocities of all servos (rad/s).
    pub fn goals(&self) -> Vec<f64> {
        let bus = self.emulator.servos();
        bus.servos().iter().map(|servo| servo.goal()).collect()
    }

    /// Values of `register` of all servos.
    pub fn get(&self, register: Register) -> Vec<i64> {
        let bus = self.emulator.servos();
        let servos = bus.servos().iter();
        servos.map(|servo| servo.get(register)).collect()
    }

    /// Positions of all joints by their servos (rad), not unwrapped.
    pub fn positions(&self) -> Vec<f64> {
        let position = Registers::of(self.config.protocol).position;
        let bus = self.emulator.servos();
        let horn = |id: u8| {
            let servo = bus.servos().iter().find(|servo| servo.id == id);
            let servo = servo.expect("a servo");
            servo.model.to_angle(servo.get(position) as f64)
        };
        let joints = self.config.joints();
        joints.map(|joint| joint.position(horn(joint.id))).collect()
    }

    /// Waits until the bus has executed all instructions.
    pub fn settle(&self) {
        self.emulator.wait(0.02);
    }
}

/// Time of each command on the bus that changes a goal position, and age of the latest response at that time (s).
pub fn ages_of_goal_positions(bus: &EmulatedBus, protocol: Protocol) -> Vec<(f64, f64)> {
    let goal = Registers::of(protocol).goal_position;
    let (data, stride) = match protocol {
        Protocol::Dynamixel => (4, 5),
        Protocol::Feetech | Protocol::FeetechScs => (2, 3),
    };
    let mut newest = f64::NEG_INFINITY;
    let mut before = Vec::new();
    let mut ages = Vec::new();
    for entry in bus.log().entries() {
        if entry.instruction == 0 {
            newest = entry.time;
        } else if entry.instruction == SYNC_WRITE && u16::from(entry.parameters[0]) == goal.address
        {
            let goals = entry.parameters[data..].chunks(stride);
            let goals: Vec<_> = goals.map(|servo| goal.decode(&servo[1..])).collect();
            if !before.is_empty() && goals != before {
                ages.push((entry.time, entry.time - newest));
            }
            before = goals;
        }
    }
    ages
}

/// Time of each motion command on the bus, and age of the latest response at that time (s).
pub fn ages_of_commands(bus: &EmulatedBus, protocol: Protocol) -> Vec<(f64, f64)> {
    let goal = Registers::of(protocol).goal_velocity;
    let mut newest = f64::NEG_INFINITY;
    let mut ages = Vec::new();
    for entry in bus.log().entries() {
        let (address, stride) = match protocol {
            Protocol::Dynamixel => (4, 5),
            Protocol::Feetech | Protocol::FeetechScs => (2, 3),
        };
        if entry.instruction == 0 {
            newest = entry.time;
        } else if entry.instruction == SYNC_WRITE
            && u16::from(entry.parameters[0]) == goal.address
            && entry.parameters[address..]
                .chunks(stride)
                .any(|servo| goal.decode(&servo[1..]) != 0)
        {
            ages.push((entry.time, entry.time - newest));
        }
    }
    ages
}
