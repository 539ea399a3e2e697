//! Emulated servos under arbitrary instructions.

#![cfg(target_os = "linux")]

use feeler_drives::Port;
use feeler_drives::emulator::{EmulatedServo, EmulatorConfig, LagPlant, LoadedPlant, Lockstep};
use feeler_drives::packet::instruction::{READ, REBOOT, SYNC_READ, SYNC_WRITE, WRITE};
use feeler_drives::packet::{BROADCAST, Protocol, encode};
use feeler_drives::registers::{Model, Registers};
use proptest::prelude::*;

/// Arbitrary bytes, with more zeros, ones and extremes.
fn byte() -> impl Strategy<Value = u8> {
    prop_oneof![
        Just(0),
        Just(1),
        Just(0x7F),
        Just(0x80),
        Just(0xFF),
        any::<u8>()
    ]
}

/// Addresses, with more of those that change the motion.
fn address() -> impl Strategy<Value = u8> {
    let relevant = vec![
        9, 11, 20, 28, 31, 33, 36, 38, 40, 42, 46, 48, 55, 63, 64, 98, 102, 104, 112, 116,
    ];
    prop_oneof![prop::sample::select(relevant), any::<u8>()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// No instruction makes a servo panic, exceed its stall current, or lose its finite position.
    #[test]
    fn arbitrary_instructions_keep_servos_within_their_physics(
        instructions in prop::collection::vec((0..3u8, 0..5usize, address(), prop::collection::vec(byte(), 0..8), 0.0..0.2f64), 1..40),
        protocol in prop::sample::select(&Protocol::ALL[..]),
    ) {
        let name = match protocol {
            Protocol::Dynamixel => "XL330-M288",
            Protocol::Feetech => "STS3215",
            Protocol::FeetechScs => "SCS0009",
        };
        let model = Model::named(name).expect("a model");
        let config = EmulatorConfig {
            protocol,
            baud_rate: 1_000_000,
            servos: (1..=2).map(|id| EmulatedServo::new(id, model)).collect(),
            noise: 0.3,
            seed: 1,
        };
        let plant = LoadedPlant::new(LagPlant::new(0.01, &[1.0, 2.0]), |_, motion| 0.5 * motion.angle);
        let bus = Lockstep::new(&config, Box::new(plant));
        let mut port = bus.clone();
        for (id, code, address, data, time) in instructions {
            let code = [WRITE, READ, REBOOT, SYNC_WRITE, SYNC_READ][code];
            let wide = protocol == Protocol::Dynamixel;
            let mut parameters = vec![address];
            parameters.extend(wide.then_some(0));
            if code == SYNC_WRITE || code == SYNC_READ {
                parameters.push(data.len() as u8);
                parameters.extend(wide.then_some(0));
                parameters.push(id);
            }
            parameters.extend(&data);
            let id = if code == SYNC_WRITE || code == SYNC_READ { BROADCAST } else { id };
            let mut bytes = Vec::new();
            encode(protocol, (id, code), &parameters, &mut bytes).expect("a packet");
            port.send(&bytes).expect("a connected port");
            bus.wait(time);
            for servo in bus.servos().servos() {
                let (_, stall_current) = servo.model.stall;
                prop_assert!(servo.greatest_current() <= stall_current, "{}", servo.greatest_current());
                prop_assert!(servo.most_current() <= stall_current);
                prop_assert!(servo.goal().is_finite());
                let position = servo.get(Registers::of(protocol).position);
                let wraps = protocol != Protocol::Dynamixel;
                prop_assert!(!wraps || (0..model.counts).contains(&position), "{}", position);
            }
        }
    }
}
