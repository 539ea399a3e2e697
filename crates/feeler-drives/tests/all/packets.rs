//! The packet codec with the vendors' examples, round trips and hostile bytes.

#[path = "../../../feeler-link/tests/support/how_many.rs"]
mod how_many;

use feeler_drives::packet::instruction::*;
use feeler_drives::packet::{
    BROADCAST, Decoder, FastBlock, LONGEST, PacketError, Protocol, Sender, complete_blocks, encode,
    fast_blocks, fast_status,
};
use how_many::how_many;
use proptest::prelude::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Examples of the ROBOTIS e-Manual, "DYNAMIXEL Protocol 2.0" (<https://emanual.robotis.com/docs/en/dxl/protocol2/>),
/// by the headings of its page: sender, id, instruction, parameters, and the packet. The last two bytes are the CRC
/// examples.
const VENDORS: &[(Sender, u8, u8, &[u8], &str)] = &[
    // Ping, example 1 and 2.
    (Sender::Master, 1, PING, &[], "FFFFFD00 01 0300 01 194E"),
    (
        Sender::Master,
        BROADCAST,
        PING,
        &[],
        "FFFFFD00 FE 0300 01 3142",
    ),
    (
        Sender::Servo,
        1,
        STATUS,
        &[0, 6, 4, 0x26],
        "FFFFFD00 01 0700 55 00 060426 655D",
    ),
    (
        Sender::Servo,
        2,
        STATUS,
        &[0, 6, 4, 0x26],
        "FFFFFD00 02 0700 55 00 060426 6F6D",
    ),
    // Read: present position.
    (
        Sender::Master,
        1,
        READ,
        &[0x84, 0, 4, 0],
        "FFFFFD00 01 0700 02 84000400 1D15",
    ),
    (
        Sender::Servo,
        1,
        STATUS,
        &[0, 0xA6, 0, 0, 0],
        "FFFFFD00 01 0800 55 00 A6000000 8CC0",
    ),
    // Write: goal position.
    (
        Sender::Master,
        1,
        WRITE,
        &[0x74, 0, 0, 2, 0, 0],
        "FFFFFD00 01 0900 03 7400 00020000 CA89",
    ),
    (
        Sender::Servo,
        1,
        STATUS,
        &[0],
        "FFFFFD00 01 0400 55 00 A10C",
    ),
    // Reboot.
    (Sender::Master, 1, REBOOT, &[], "FFFFFD00 01 0300 08 2F4E"),
    // Sync read and sync write of two servos.
    (
        Sender::Master,
        BROADCAST,
        SYNC_READ,
        &[0x84, 0, 4, 0, 1, 2],
        "FFFFFD00 FE 0900 82 84000400 0102 CEFA",
    ),
    (
        Sender::Servo,
        2,
        STATUS,
        &[0, 0x1F, 8, 0, 0],
        "FFFFFD00 02 0800 55 00 1F080000 BABE",
    ),
    (
        Sender::Master,
        BROADCAST,
        SYNC_WRITE,
        &[0x74, 0, 4, 0, 1, 0x96, 0, 0, 0, 2, 0xAA, 0, 0, 0],
        "FFFFFD00 FE 1100 83 74000400 01 96000000 02 AA000000 8287",
    ),
];

fn bytes(hex: &str) -> Vec<u8> {
    let digits: Vec<u32> = hex.chars().filter_map(|c| c.to_digit(16)).collect();
    digits
        .chunks(2)
        .map(|pair| (pair[0] * 16 + pair[1]) as u8)
        .collect()
}

#[test]
fn encodes_and_decodes_the_vendors_examples() {
    let mut written = Vec::new();
    for &(sender, id, code, parameters, example) in VENDORS {
        let example = bytes(example);
        encode(Protocol::Dynamixel, (id, code), parameters, &mut written).unwrap();
        assert_eq!(written, example);
        let mut decoder = Decoder::new(Protocol::Dynamixel, sender);
        decoder.feed(&example);
        let packet = decoder.next().expect("a packet").expect("a valid packet");
        assert_eq!(
            (packet.id, packet.code, packet.parameters),
            (id, code, parameters)
        );
        assert_eq!(decoder.next(), None);
    }
}

/// The e-Manual's example of a fast sync read
/// (<https://emanual.robotis.com/docs/en/dxl/protocol2/#fast-sync-read-0x8a>): servos 3, 7 and 4 report their
/// positions.
#[test]
fn encodes_and_decodes_the_vendors_fast_sync_read() {
    let mut asked = Vec::new();
    let parameters = [0x84, 0, 4, 0, 3, 7, 4];
    encode(
        Protocol::Dynamixel,
        (BROADCAST, FAST_SYNC_READ),
        &parameters,
        &mut asked,
    )
    .unwrap();
    assert_eq!(asked, bytes("FFFFFD00 FE 0A00 8A 84000400 030704 20F2"));
    let example =
        bytes("FFFFFD00 FE 1900 55 00 03 A6000000 8408 00 07 1F080000 16CA 00 04 FF030000 D19E");
    let said: [(u8, [u8; 4]); 3] = [
        (3, [0xA6, 0, 0, 0]),
        (7, [0x1F, 8, 0, 0]),
        (4, [0xFF, 3, 0, 0]),
    ];
    let blocks = said.iter().map(|(id, data)| FastBlock {
        error: 0,
        id: *id,
        data,
    });
    let mut written = Vec::new();
    fast_status(blocks.clone(), &mut written);
    assert_eq!(written, example);

    let mut decoder = Decoder::new(Protocol::Dynamixel, Sender::Servo);
    decoder.feed(&example[..25]);
    assert_eq!(decoder.next(), None);
    assert_eq!(complete_blocks(decoder.pending(), 4), 2);
    decoder.feed(&example[25..]);
    let packet = decoder.next().expect("a packet").expect("a valid packet");
    assert_eq!((packet.id, packet.code), (BROADCAST, STATUS));
    assert!(fast_blocks(packet.parameters, 4).eq(blocks));
}

/// Examples of Feetech's "Communication Protocol User Manual" (serial bus servos), by its sections: sender, id,
/// instruction or status, parameters, and the packet. The magnetic encoder series, which includes STS, is
/// little-endian.
const FEETECHS: &[(Sender, u8, u8, &[u8], &str)] = &[
    // 1.3.1 Ping.
    (Sender::Master, 1, PING, &[], "FFFF 01 02 01 FB"),
    (Sender::Servo, 1, 0, &[], "FFFF 01 02 00 FC"),
    // 1.3.2 Read data: present position of servo 1, 0x0518.
    (Sender::Master, 1, READ, &[0x38, 2], "FFFF 01 04 02 3802 BE"),
    (Sender::Servo, 1, 0, &[0x18, 5], "FFFF 01 04 00 1805 DD"),
    // 1.3.3 Write data: id of any servo; goal position, time and speed of servo 1.
    (
        Sender::Master,
        BROADCAST,
        WRITE,
        &[5, 1],
        "FFFF FE 04 03 0501 F4",
    ),
    (
        Sender::Master,
        1,
        WRITE,
        &[0x2A, 0, 8, 0, 0, 0xE8, 3],
        "FFFF 01 09 03 2A 0008 0000 E803 D5",
    ),
    // 1.3.6 Sync write: goal position, time and speed of servos 1 to 4.
    (
        Sender::Master,
        BROADCAST,
        SYNC_WRITE,
        &[
            0x2A, 6, 1, 0, 8, 0, 0, 0xE8, 3, 2, 0, 8, 0, 0, 0xE8, 3, 3, 0, 8, 0, 0, 0xE8, 3, 4, 0,
            8, 0, 0, 0xE8, 3,
        ],
        "FFFF FE 20 83 2A 06 01 00080000E803 02 00080000E803 03 00080000E803 04 00080000E803 58",
    ),
    // 1.3.7 Sync read: 8 bytes from the present position of servos 1 and 2.
    (
        Sender::Master,
        BROADCAST,
        SYNC_READ,
        &[0x38, 8, 1, 2],
        "FFFF FE 06 82 38 08 01 02 36",
    ),
    (
        Sender::Servo,
        1,
        0,
        &[0, 8, 0, 0, 0, 0, 0x79, 0x1E],
        "FFFF 01 0A 00 0008 0000 0000 791E 55",
    ),
    (
        Sender::Servo,
        2,
        0,
        &[0xFF, 7, 0, 0, 0, 0, 0x77, 0x23],
        "FFFF 02 0A 00 FF07 0000 0000 7723 53",
    ),
];

#[test]
fn encodes_and_decodes_feetechs_examples() {
    let mut written = Vec::new();
    for &(sender, id, code, parameters, example) in FEETECHS {
        let example = bytes(example);
        encode(Protocol::Feetech, (id, code), parameters, &mut written).unwrap();
        assert_eq!(written, example);
        let mut decoder = Decoder::new(Protocol::Feetech, sender);
        decoder.feed(&example);
        let packet = decoder.next().expect("a packet").expect("a valid packet");
        assert_eq!(
            (packet.id, packet.code, packet.parameters),
            (id, code, parameters)
        );
    }
}

#[test]
fn detects_a_corrupted_byte_and_finds_the_next_packet() {
    let mut decoder = Decoder::new(Protocol::Dynamixel, Sender::Master);
    let mut changed = bytes(VENDORS[4].4);
    changed[9] ^= 0x10;
    decoder.feed(&changed);
    decoder.feed(&bytes(VENDORS[0].4));
    let error = decoder
        .next()
        .expect("an error")
        .expect_err("a corrupted packet");
    assert!(
        matches!(error, PacketError::Check { actual: 0x151D, .. }),
        "{error}"
    );
    assert!(matches!(
        decoder.next(),
        Some(Err(PacketError::Noise { .. }))
    ));
    assert_eq!(
        decoder
            .next()
            .expect("a packet")
            .expect("a valid packet")
            .code,
        PING
    );
}

#[test]
fn rejects_packets_that_are_too_long() {
    let mut written = Vec::new();
    let error = encode(Protocol::Feetech, (1, WRITE), &[0; 254], &mut written).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a packet with length 256: expected at most 255 bytes"
    );
    assert!(encode(Protocol::Dynamixel, (1, WRITE), &[0; LONGEST], &mut written).is_err());
}

/// Random bytes, with an increased frequency of the bytes of headers and stuffing.
fn byte() -> impl Strategy<Value = u8> {
    prop_oneof![3 => Just(0xFF), 2 => Just(0xFD), 1 => Just(0), 3 => any::<u8>()]
}

fn protocol() -> impl Strategy<Value = (Protocol, Sender)> {
    let sender = prop_oneof![Just(Sender::Master), Just(Sender::Servo)];
    (prop::sample::select(&Protocol::ALL[..]), sender)
}

proptest! {
    /// Encoded packets are decoded, whole or in pieces.
    #[test]
    fn packets_round_trip(
        (protocol, sender) in protocol(),
        packets in prop::collection::vec((0u8..=252, any::<u8>(), prop::collection::vec(byte(), 0..60)), 1..5),
        piece in 1usize..40,
    ) {
        let mut stream = Vec::new();
        let mut written = Vec::new();
        for (id, code, parameters) in &packets {
            encode(protocol, (*id, *code), parameters, &mut written).unwrap();
            stream.extend(&written);
        }
        let mut decoder = Decoder::new(protocol, sender);
        let mut read = Vec::new();
        for piece in stream.chunks(piece) {
            prop_assert_eq!(decoder.feed(piece), piece.len());
            while let Some(packet) = decoder.next() {
                let packet = packet.unwrap();
                read.push((packet.id, packet.code, packet.parameters.to_vec()));
            }
        }
        prop_assert_eq!(read, packets);
        prop_assert!(decoder.pending().is_empty());
    }

    /// A Dynamixel packet contains no second header.
    #[test]
    fn stuffing_hides_every_header(parameters in prop::collection::vec(byte(), 0..200)) {
        let mut written = Vec::new();
        encode(Protocol::Dynamixel, (1, WRITE), &parameters, &mut written).unwrap();
        let inside = &written[7..written.len() - 2];
        prop_assert!(!inside.windows(4).any(|four| four == [0xFF, 0xFF, 0xFD, 0x00]));
    }

    /// Every bit flip is detected: the packet is not decoded.
    #[test]
    fn detects_a_flipped_bit((protocol, sender) in protocol(), parameters in prop::collection::vec(byte(), 0..40), flip in any::<prop::sample::Index>()) {
        let mut written = Vec::new();
        encode(protocol, (1, READ), &parameters, &mut written).unwrap();
        let bit = flip.index(written.len() * 8);
        written[bit / 8] ^= 1 << (bit % 8);
        let mut decoder = Decoder::new(protocol, sender);
        decoder.feed(&written);
        while let Some(packet) = decoder.next() {
            let whole = packet.is_ok_and(|packet| packet.parameters == parameters && packet.id == 1);
            prop_assert!(!whole);
        }
    }
}

/// Feeds hostile bytes, partly corrupted packets, to each decoder; `FEELER_FUZZ_BUS` sets their number.
#[test]
fn hostile_bytes_do_not_stop_the_decoder() {
    let count = how_many("FEELER_FUZZ_BUS", 200_000);
    for protocol in Protocol::ALL {
        for sender in [Sender::Master, Sender::Servo] {
            let packets = hostile(protocol, sender, count);
            assert!(packets > 0, "no packet of {protocol:?} survived");
        }
    }
}

fn hostile(protocol: Protocol, sender: Sender, count: usize) -> usize {
    let mut random = Pcg64::seed_from_u64(7);
    let mut decoder = Decoder::new(protocol, sender);
    let (mut fed, mut packets) = (0, 0);
    let mut piece = Vec::new();
    while fed < count {
        let mut parameters = [0; 24];
        random.fill_bytes(&mut parameters);
        encode(
            protocol,
            (random.random(), random.random()),
            &parameters,
            &mut piece,
        )
        .unwrap();
        for byte in &mut piece {
            match random.random_range(0..200) {
                0 => *byte = random.random(),
                1 => *byte = 0xFF,
                _ => {}
            }
        }
        piece.truncate(random.random_range(0..=2 * piece.len()).min(piece.len()));
        let mut rest = &piece[..];
        while !rest.is_empty() {
            let taken = decoder.feed(rest);
            rest = &rest[taken..];
            while let Some(packet) = decoder.next() {
                let Ok(packet) = packet else { continue };
                packets += 1;
                assert!(fast_blocks(packet.parameters, 8).all(|block| block.data.len() == 8));
            }
            assert!(complete_blocks(decoder.pending(), 8) <= LONGEST);
        }
        fed += piece.len();
    }
    packets
}
