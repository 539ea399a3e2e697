//! Serial protocols of skins: whole, damaged and hostile streams.

use feeler::sensor::skin::{SerialConfig, SkinDecoder, SkinProtocol};
use glam::DVec3;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Hostile bytes per decoder.
const HOSTILE: usize = 10_000_000;
/// Frames after damage within which a decoder is in step again.
const FRAMES: usize = 3;

/// Each protocol with the taxels of a built-in layout.
fn skins() -> [(SerialConfig, usize); 3] {
    let taxels = [5, 384, 31];
    let skins = SkinProtocol::ALL.into_iter().zip(taxels);
    let skins: Vec<_> = skins
        .map(|(protocol, taxels)| (SerialConfig::new(protocol), taxels))
        .collect();
    skins.try_into().expect("three skins")
}

/// Readings that all protocols represent exactly. Those of FlexiTac often contain the marker, at changing places.
fn readings(config: &SerialConfig, taxels: usize, random: &mut Pcg64) -> Vec<DVec3> {
    let value = |random: &mut Pcg64| match config.protocol {
        SkinProtocol::Magnetometers => {
            DVec3::from_array([(); 3].map(|()| f64::from(random.random_range(-9e3_f32..9e3))))
        }
        SkinProtocol::Flexitac => {
            let byte = match random.random_range(0..6) {
                0 => 0xAA,
                1 => 0x55,
                _ => random.random::<u8>(),
            };
            DVec3::new(0.0, 0.0, byte.into())
        }
        SkinProtocol::Paxini => {
            let [x, y]: [i8; 2] = random.random();
            DVec3::new(x.into(), y.into(), random.random::<u8>().into())
        }
    };
    (0..taxels).map(|_| value(random)).collect()
}

/// Decodes a whole stream that arrives in pieces of up to `piece` bytes.
fn decode(decoder: &mut SkinDecoder, bytes: &[u8], piece: usize) -> Vec<Vec<DVec3>> {
    let mut values = vec![DVec3::NAN; decoder.taxels()];
    let mut frames = Vec::new();
    for piece in bytes.chunks(piece) {
        decoder.feed(piece);
        while decoder.next_frame(&mut values).is_some() {
            frames.push(values.clone());
        }
    }
    frames
}

/// A frame as the firmware of AnySkin sends it, written byte by byte.
#[test]
fn a_frame_of_magnetometers_is_decoded() {
    let numbers = [24.5_f32, 1.5, -2.0, 300.25, 25.0, 0.0, 0.0, 0.0];
    let mut bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    assert_eq!(bytes[..4], [0x00, 0x00, 0xC4, 0x41]);
    bytes.extend(b"\r\n");
    let config = SerialConfig::new(SkinProtocol::Magnetometers);
    let mut decoder = SkinDecoder::new(&config, 2);
    let frames = decode(&mut decoder, &bytes, 1);
    assert_eq!(frames[0][0], DVec3::new(1.5, -2.0, 300.25));
    // A chip without any field has not measured.
    assert!(frames[0][1].is_nan());
    assert_eq!((frames.len(), decoder.skipped_bytes()), (1, 0));
}

/// Frames as the firmware of FlexiTac sends them. Each is returned as soon as the next begins.
#[test]
fn frames_of_flexitac_are_decoded() {
    let config = SerialConfig::new(SkinProtocol::Flexitac);
    let mut decoder = SkinDecoder::new(&config, 3);
    // At first, two frames must follow.
    let bytes = [0xAA, 0x55, 1, 2, 255, 0xAA, 0x55, 4, 5, 6, 0xAA, 0x55];
    assert_eq!(decode(&mut decoder, &bytes, 5).len(), 0);
    let frames = decode(&mut decoder, &[7, 8, 9, 0xAA, 0x55], 5);
    let z = |frame: &[DVec3]| frame.iter().map(|value| value.z).collect::<Vec<_>>();
    assert_eq!(
        frames.iter().map(|f| z(f)).collect::<Vec<_>>(),
        [[1., 2., 255.], [4., 5., 6.], [7., 8., 9.]]
    );
    // Then, the marker of the next one is sufficient.
    assert_eq!(decode(&mut decoder, &[10, 11, 12, 0xAA], 5).len(), 0);
    let frames = decode(&mut decoder, &[0x55], 5);
    assert_eq!(z(&frames[0]), [10., 11., 12.]);
}

#[test]
fn a_paxini_module_reports_an_error_as_missing_values() {
    let config = SerialConfig::new(SkinProtocol::Paxini);
    let mut bytes = Vec::new();
    config.encode(&[DVec3::new(-128.0, 127.0, 255.0)], &mut bytes);
    let mut decoder = SkinDecoder::new(&config, 1);
    let frames = decode(&mut decoder, &bytes, 3);
    assert_eq!(frames, [[DVec3::new(-128.0, 127.0, 255.0)]]);
    // Byte 13 is the status; the last one makes the sum 0.
    bytes[13] += 1;
    *bytes.last_mut().unwrap() -= 1;
    let frames = decode(&mut decoder, &bytes, 3);
    assert!(frames[0][0].is_nan());
}

/// A FlexiTac at rest shows the same image again and again. If this contains a marker, two beginnings are possible, and
/// the decoder waits until the image changes.
#[test]
fn a_marker_in_a_still_image_is_not_taken_for_a_beginning() {
    let config = SerialConfig::new(SkinProtocol::Flexitac);
    let image = |last: u8| [0xAA, 0x55, 1, 2, 0xAA, 0x55, 3, last];
    let mut decoder = SkinDecoder::new(&config, 6);
    let still: Vec<u8> = (0..20).flat_map(|_| image(4)).skip(3).collect();
    assert_eq!(decode(&mut decoder, &still, 7).len(), 0);
    let moved: Vec<u8> = (0..20)
        .flat_map(|n| {
            [
                0xAA,
                0x55,
                1,
                2,
                0xAA,
                if n % 2 == 0 { 0x54 } else { 0x55 },
                3,
                4,
            ]
        })
        .collect();
    let frames = decode(&mut decoder, &moved, 7);
    assert!(frames.len() > 15, "{}", frames.len());
    let begins_well = |frame: &Vec<DVec3>| frame[0].z == 1.0 && frame[5].z == 4.0;
    assert!(frames.iter().all(begins_well), "{frames:?}");
}

/// Damage of a stream.
#[derive(Debug, Clone)]
enum Damage {
    /// Bytes are lost.
    Lose(usize),
    /// Bytes are inserted.
    Insert(Vec<u8>),
    /// A byte is changed.
    Flip(u8),
}

impl Damage {
    fn any(random: &mut Pcg64) -> Self {
        let count = random.random_range(1..300);
        match random.random_range(0..3) {
            0 => Self::Lose(count),
            1 => Self::Insert((0..count).map(|_| random.random::<u8>()).collect()),
            _ => Self::Flip(random.random_range(1..=255)),
        }
    }

    /// Damages `bytes` from `at` on. Returns the end of the damage, as an index in the whole stream.
    fn apply(&self, bytes: &mut Vec<u8>, at: usize) -> usize {
        match self {
            Self::Lose(count) => drop(bytes.drain(at..at + count)),
            Self::Insert(inserted) => drop(bytes.splice(at..at, inserted.iter().copied())),
            Self::Flip(bits) => bytes[at] ^= bits,
        }
        at + if let Self::Lose(count) = self {
            *count
        } else {
            0
        }
    }
}

/// After damage at any place, all frames from the third whole one on are decoded, and no frame is made up: lost and
/// inserted bytes cause no wrong values, except by a coincidence of sums. A changed byte may change values of
/// that frame only.
#[test]
fn damage_costs_at_most_three_frames() {
    for (config, taxels) in skins() {
        let mut random = Pcg64::seed_from_u64(3);
        let is_flexitac = config.protocol == SkinProtocol::Flexitac;
        let is_paxini = config.protocol == SkinProtocol::Paxini;
        let mut made_up = 0;
        for case in 0..1000 {
            let damage = Damage::any(&mut random);
            let length = config.frame_bytes(taxels);
            if matches!(damage, Damage::Lose(count) if count % length == 0) {
                // Not detectable without a checksum: the next frame continues where this one ended.
                continue;
            }
            let mut sent: Vec<_> = (0..12)
                .map(|_| readings(&config, taxels, &mut random))
                .collect();
            if is_flexitac {
                // Without the second byte of a marker, which would be a coincidence at the place of one.
                let values = sent.iter_mut().flatten();
                values.for_each(|value| value.z = if value.z == 85.0 { 86.0 } else { value.z });
            }
            let mut bytes = Vec::new();
            sent.iter()
                .for_each(|values| config.encode(values, &mut bytes));
            let at = random.random_range(2 * length..5 * length);
            let end = damage.apply(&mut bytes, at);
            let (first, last) = (at / length, end / length);
            let mut decoder = SkinDecoder::new(&config, taxels);
            let frames = decode(&mut decoder, &bytes, random.random_range(1..2000));
            let shown = format!("{:?}, case {case}: {damage:?} at {at}", config.protocol);
            // The last frame of FlexiTac is not confirmed by another.
            let expected = &sent[last + FRAMES..sent.len() - usize::from(is_flexitac)];
            let tail = &frames[frames.len().saturating_sub(expected.len())..];
            assert!(tail == expected, "{shown}: {} frames", frames.len());
            for frame in &frames {
                let differences =
                    |values: &[DVec3]| values.iter().zip(frame).filter(|(a, b)| a != b).count();
                let may_differ =
                    matches!(damage, Damage::Flip(_)) && differences(&sent[first]) <= 1;
                if may_differ || sent.contains(frame) {
                    continue;
                }
                made_up += 1;
                assert!(is_paxini, "{shown}: a frame was made up");
            }
            // Before the damage, nothing is lost; of FlexiTac, a damaged marker also costs the frame before.
            let before = first - usize::from(is_flexitac);
            assert!(frames[..before] == sent[..before], "{shown}");
        }
        // A wrong packet has the right sum of 8 bits in 1 of 256 cases.
        assert!(made_up <= 12, "{made_up} of 1000");
    }
}

proptest! {
    /// The division into reads has no effect.
    #[test]
    fn pieces_have_no_effect(bytes in prop::collection::vec(any::<u8>(), 0..3000), piece in 1_usize..100) {
        for (config, taxels) in skins() {
            let mut stream = bytes.clone();
            config.encode(&vec![DVec3::ONE; taxels], &mut stream);
            config.encode(&vec![DVec3::ONE; taxels], &mut stream);
            let mut a = SkinDecoder::new(&config, taxels);
            let mut b = SkinDecoder::new(&config, taxels);
            let whole = decode(&mut a, &stream, stream.len());
            prop_assert!(whole == decode(&mut b, &stream, piece));
            prop_assert_eq!(a.skipped_bytes(), b.skipped_bytes());
        }
    }
}

/// Appends hostile bytes: noise, parts of frames, markers and ends, and bytes that are repeated.
fn hostile(config: &SerialConfig, taxels: usize, random: &mut Pcg64, bytes: &mut Vec<u8>) {
    let begin = bytes.len();
    match random.random_range(0..6) {
        0 => bytes.extend((0..random.random_range(1..600)).map(|_| random.random::<u8>())),
        1 => bytes.extend([0xAA, 0x55].repeat(random.random_range(1..300))),
        2 => bytes.extend(b"\r\n".repeat(random.random_range(1..300))),
        3 => bytes.extend(vec![random.random::<u8>(); random.random_range(1..600)]),
        _ => config.encode(&readings(config, taxels, random), bytes),
    }
    if random.random() {
        bytes.truncate(random.random_range(begin..=bytes.len()));
    }
    for _ in 0..random.random_range(0..4) {
        if bytes.len() > begin {
            let at = random.random_range(begin..bytes.len());
            bytes[at] = random.random();
        }
    }
}

/// Ten million hostile bytes cause no panic, no implausible value and no growing buffer, and do not stop the decoder.
#[test]
fn hostile_bytes_cause_no_panic() {
    for (config, taxels) in skins() {
        let mut random = Pcg64::seed_from_u64(7);
        let mut decoder = SkinDecoder::new(&config, taxels);
        let (mut fed, mut frames) = (0, 0_u64);
        while fed < HOSTILE {
            let mut bytes = Vec::new();
            hostile(&config, taxels, &mut random, &mut bytes);
            fed += bytes.len();
            for frame in decode(&mut decoder, &bytes, 512) {
                frames += 1;
                assert!(
                    frame
                        .iter()
                        .all(|value| value.is_nan() || value.abs().max_element() <= 4e5)
                );
            }
            if random.random_ratio(1, 1000) {
                decoder.restart();
            }
        }
        assert_eq!(decoder.stream_bytes(), fed as u64);
        let framed = frames * config.frame_bytes(taxels) as u64;
        assert!(decoder.skipped_bytes() + framed <= fed as u64);
        assert!(decoder.losses() > 100 && frames > 100, "{decoder:?}");
        let values = vec![DVec3::splat(5.0); taxels];
        let mut bytes = Vec::new();
        (0..9).for_each(|_| config.encode(&values, &mut bytes));
        let frames = decode(&mut decoder, &bytes, 512);
        let z = |frame: &Vec<DVec3>| frame.iter().map(|v| v.z).collect::<Vec<_>>();
        assert!(frames.len() >= 5, "{:?}: {}", config.protocol, frames.len());
        assert_eq!(z(frames.last().unwrap()), vec![5.0; taxels]);
    }
}

/// Share of single changed bits that a decoder does not detect. Only PaXini's packets have a checksum.
#[test]
fn changed_bits_are_detected_as_documented() {
    let undetected = skins().map(|(config, taxels)| {
        let mut random = Pcg64::seed_from_u64(11);
        let (mut missed, trials) = (0, 2000);
        for _ in 0..trials {
            let sent: Vec<_> = (0..10)
                .map(|_| readings(&config, taxels, &mut random))
                .collect();
            let mut bytes = Vec::new();
            sent.iter()
                .for_each(|values| config.encode(values, &mut bytes));
            let length = config.frame_bytes(taxels);
            bytes[5 * length + random.random_range(0..length)] ^= 1 << random.random_range(0..8);
            let mut decoder = SkinDecoder::new(&config, taxels);
            let frames = decode(&mut decoder, &bytes, bytes.len());
            missed += u32::from(frames.iter().any(|frame| !sent.contains(frame)));
        }
        f64::from(missed) / f64::from(trials)
    });
    println!("undetected changed bits: magnetometers, FlexiTac, PaXini: {undetected:?}");
    assert!((0.3..0.8).contains(&undetected[0]), "{undetected:?}");
    assert!(undetected[1] > 0.9, "{undetected:?}");
    assert_eq!(undetected[2], 0.0);
}

#[test]
fn settings_are_checked() {
    use feeler::sensor::taxel::{BuiltInTaxels, TaxelLayout};
    let text = BuiltInTaxels::named("anyskin").unwrap().text;
    let refused = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        let text = text.replace(from, to);
        TaxelLayout::from_toml(&text).unwrap_err().to_string()
    };
    let rate = refused("baud_rate = 115200", "baud_rate = 300");
    assert!(
        rate.contains("serial.baud_rate") && rate.contains("1200"),
        "{rate}"
    );
    let protocol = refused("\"magnetometers\"", "\"morse\"");
    assert!(
        protocol.contains("morse") && protocol.contains("flexitac"),
        "{protocol}"
    );
    let grid = refused(
        "taxel = [",
        "grid = { rows = 2, columns = 2, pitch = 0.01 }\ntaxel = [",
    );
    assert!(grid.contains("either taxels or a grid"), "{grid}");
    let without = text.split("taxel = [").next().unwrap();
    for (grid, words) in [
        ("rows = 0, columns = 2, pitch = 0.01", "1 to 512 taxels"),
        ("rows = 100, columns = 100, pitch = 0.01", "1 to 512 taxels"),
        (
            "rows = 4294967295, columns = 4294967295, pitch = 0.01",
            "1 to 512 taxels",
        ),
        ("rows = 2, columns = 2, pitch = nan", "grid.pitch"),
        ("rows = 2, columns = 2", "pitch"),
        ("rows = 16, columns = 8, pitch = 0.01", "at most 64"),
    ] {
        let error = TaxelLayout::from_toml(&format!("{without}grid = {{ {grid} }}\n"));
        let error = error.unwrap_err().to_string();
        assert!(error.contains(words), "{grid}: {error}");
    }
}
