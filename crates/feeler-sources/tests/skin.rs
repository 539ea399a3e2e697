//! Live skins, read from emulated ones.

#![cfg(target_os = "linux")]

use feeler::sensor::forces::{TactileFrame, TactileSensor};
use feeler::sensor::taxel::{BuiltInTaxels, TaxelLayout};
use feeler_sources::skin::{SkinEmulator, SkinEvent, SkinNews, SkinSensor, probe_port};
use std::path::{Path, PathBuf};

fn layout(name: &str) -> TaxelLayout {
    BuiltInTaxels::named(name).unwrap().layout().unwrap()
}

fn link(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A sensor and the frame that it fills.
struct Skin {
    sensor: SkinSensor,
    frame: TactileFrame,
    news: Vec<SkinNews>,
}

impl Skin {
    fn open(emulator: &SkinEmulator, layout: &TaxelLayout) -> Self {
        let sensor = SkinSensor::open(emulator.path(), layout).unwrap();
        let frame = TactileFrame::unloaded(sensor.element_count());
        Self {
            sensor,
            frame,
            news: Vec::new(),
        }
    }

    /// Reads until `is_met` holds for the forces. The runner's time limit applies.
    fn read_until(&mut self, is_met: impl Fn(&TactileFrame) -> bool) {
        let mut before = self.frame.stamp;
        loop {
            self.sensor.read(&mut self.frame).unwrap();
            assert!(self.frame.stamp >= before, "stamps decrease");
            before = self.frame.stamp;
            self.news.extend(self.sensor.take_news());
            if is_met(&self.frame) {
                return;
            }
        }
    }

    fn read_until_valid(&mut self) {
        self.read_until(|frame| frame.first_invalid().is_none());
    }

    fn read_until_invalid(&mut self) {
        self.read_until(|frame| frame.forces.iter().all(|force| force.is_nan()));
    }
}

const SKINS: [&str; 5] = ["anyskin", "reskin", "eflesh", "flexitac", "paxini-s1813e"];

#[test]
fn a_press_on_every_skin_is_measured() {
    for name in SKINS {
        let layout = layout(name);
        let emulator = SkinEmulator::start(&layout, 200.0, None).unwrap();
        let mut skin = Skin::open(&emulator, &layout);
        // While the zero is measured, there are no forces.
        skin.sensor.read(&mut skin.frame).unwrap();
        assert!(skin.frame.first_invalid() == Some(0), "{name}");
        skin.read_until_valid();
        let noise = |frame: &TactileFrame| frame.forces.iter().all(|force| force.length() < 5.0);
        assert!(noise(&skin.frame), "{name}: {:?}", skin.frame.forces);
        emulator.inject(SkinEvent::Press(60.0));
        // PaXini's 60 counts are 6 N.
        let expected = if name.starts_with("paxini") {
            6.0
        } else {
            60.0
        };
        let largest = |frame: &TactileFrame| frame.forces.iter().map(|f| f.z).fold(0.0, f64::max);
        skin.read_until(|frame| (largest(frame) - expected).abs() < 0.05 * expected);
        emulator.inject(SkinEvent::Press(0.0));
        skin.read_until(noise);
        let counters = skin.sensor.counters();
        assert_eq!(
            (counters.losses(), counters.reconnections()),
            (0, 0),
            "{name}: {counters}"
        );
        assert!(counters.rate().unwrap() > 1.0, "{name}: {counters}");
    }
}

#[test]
fn the_zero_is_measured_again_on_request() {
    let layout = layout("anyskin");
    let emulator = SkinEmulator::start(&layout, 200.0, None).unwrap();
    let mut skin = Skin::open(&emulator, &layout);
    skin.read_until_valid();
    emulator.inject(SkinEvent::Field([0.0, 0.0, 50.0]));
    let z = |frame: &TactileFrame| frame.forces[4].z;
    skin.read_until(|frame| z(frame) > 40.0);
    skin.sensor.zero();
    skin.read_until_invalid();
    skin.read_until_valid();
    assert!(z(&skin.frame).abs() < 5.0, "{:?}", skin.frame);
}

#[test]
fn silence_and_unplugging_make_readings_invalid_until_the_skin_is_back() {
    for name in ["anyskin", "paxini-s1813e"] {
        let layout = layout(name);
        let link = link(&format!("unplugged-{name}"));
        let emulator = SkinEmulator::start(&layout, 200.0, Some(&link)).unwrap();
        let mut skin = Skin::open(&emulator, &layout);
        skin.read_until_valid();
        emulator.inject(SkinEvent::Silent(0.5));
        skin.read_until_invalid();
        skin.read_until_valid();
        assert_eq!(skin.news, [SkinNews::Silent], "{name}");
        emulator.inject(SkinEvent::Unplug(0.5));
        skin.read_until_invalid();
        skin.read_until_valid();
        let [_, SkinNews::Disconnected(reason), SkinNews::Reconnected, ..] = &skin.news[..] else {
            panic!("{name}: {:?}", skin.news);
        };
        assert!(!reason.is_empty());
        assert_eq!(skin.sensor.counters().reconnections(), 1, "{name}");
        // The zero is kept: a press is measured at once.
        emulator.inject(SkinEvent::Press(60.0));
        skin.read_until(|frame| frame.forces.iter().any(|force| force.z > 5.0));
    }
}

/// The system gives the port's number to the next program that opens a pseudo-terminal.
#[test]
fn the_link_is_removed_while_the_skin_is_unplugged() {
    let layout = layout("anyskin");
    let link = link("unplugged-link");
    let emulator = SkinEmulator::start(&layout, 200.0, Some(&link)).unwrap();
    let mut skin = Skin::open(&emulator, &layout);
    skin.read_until_valid();
    assert!(link.is_symlink());
    emulator.inject(SkinEvent::Unplug(3600.0));
    skin.read_until_invalid();
    assert!(!link.is_symlink());
}

#[test]
fn lost_and_changed_bytes_are_counted_and_forces_continue() {
    for name in SKINS {
        let layout = layout(name);
        let emulator = SkinEmulator::start(&layout, 500.0, None).unwrap();
        let mut skin = Skin::open(&emulator, &layout);
        skin.read_until_valid();
        emulator.inject(SkinEvent::LoseBytes(0.001));
        let counters = skin.sensor.counters();
        skin.read_until(|_| {
            counters.losses() >= 5 || counters.missing_readings() > 0 && name.starts_with("paxini")
        });
        emulator.inject(SkinEvent::LoseBytes(0.0));
        emulator.inject(SkinEvent::FlipBytes(0.001));
        let frames = counters.frames();
        skin.read_until(|_| counters.frames() > frames + 50);
        emulator.inject(SkinEvent::FlipBytes(0.0));
        skin.read_until_valid();
    }
}

#[test]
fn connected_skins_are_recognized() {
    for (name, taxels) in [
        ("anyskin", Some(5)),
        ("flexitac", Some(384)),
        ("paxini-s1813e", None),
    ] {
        let layout = layout(name);
        let emulator = SkinEmulator::start(&layout, 50.0, None).unwrap();
        let found = probe_port(emulator.path()).unwrap().expect(name);
        assert_eq!(
            (&Some(found.serial), found.taxels),
            (&layout.serial, taxels),
            "{name}"
        );
    }
    let silent = feeler_serial::PseudoTerminal::open().unwrap();
    assert_eq!(probe_port(silent.path()).unwrap(), None);
    assert!(probe_port("/dev/not-there").is_err());
}

#[test]
fn errors_name_the_remedy() {
    let refused =
        |path: &str, layout: &TaxelLayout| SkinSensor::open(path, layout).unwrap_err().to_string();
    let error = refused("/dev/not-there", &layout("anyskin"));
    assert!(
        error.contains("serial:/dev/not-there") && error.contains("feeler skins"),
        "{error}"
    );
    let error = refused("/dev/not-there", &layout("uskin-4x4"));
    assert!(
        error.contains("[serial]") && error.contains("magnetometers"),
        "{error}"
    );
}
