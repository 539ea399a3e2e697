//! `feeler calibrate FOLDER --live` with an emulated force sensor and a delayed camera: a simulated person loads two
//! elements.

use crate::program::{Ended, feeler, folder, run};
use feeler::sensor::calibration::Calibration;
use feeler::sensor::moments::ElementMoments;
use feeler_sources::NetFtEmulator;
use glam::{DVec2, DVec3};
use std::any::Any;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;

/// Width and height of the images (px).
const SIZE: (usize, usize) = (64, 40);
/// Time between images.
pub const FRAME: Duration = Duration::from_millis(20);
/// Delay of the camera in images, hence by at least this many times [`FRAME`].
const LATE: usize = 3;
/// Centres of the elements (px).
const CENTRES: [DVec2; 2] = [DVec2::new(16.0, 20.0), DVec2::new(48.0, 20.0)];
/// Number of images for which each load is held.
const HELD: usize = 14;

/// A layout of two elements.
pub const LAYOUT: &str = "version = 1\nwidth = 64\nheight = 40\ndark_level = 10\n\
    [[element]]\ncentre_px = [16.0, 20.0]\nradius_px = 13.0\n[[element]]\ncentre_px = [48.0, 20.0]\nradius_px = 13.0\n";

/// For each image, the loaded element and its force in its frame (N): three presses, then loads in all directions, each
/// held.
fn loads(elements: &[usize]) -> Vec<(usize, DVec3)> {
    let mut loads = vec![(0, DVec3::ZERO); 60];
    for _ in 0..3 {
        // Slow enough for a busy computer.
        let press =
            (0..60).map(|k| 0.7 * (std::f64::consts::PI * f64::from(k) / 60.0).sin().powi(2));
        loads.extend(press.map(|normal| (0, DVec3::Z * normal)));
        loads.extend([(0, DVec3::ZERO); 15]);
    }
    for &element in elements {
        let step = |x, y, z| [(element, DVec3::new(x, y, z)); HELD];
        for normal in [0.1, 0.3, 0.5, 0.7, 0.9] {
            loads.extend(step(0.0, 0.0, normal));
            for (x, y) in [(0.3, 0.1), (-0.3, -0.1), (0.1, 0.3), (-0.1, -0.3)] {
                loads.extend(step(x * normal / 0.5, y * normal / 0.5, normal));
            }
        }
        loads.extend(step(0.0, 0.0, 0.0));
    }
    loads
}

/// Renders both spots. The loaded one brightens by 60 % per newton of compression and moves by 2 px per newton of
/// shear.
fn picture((loaded, force): (usize, DVec3), number: usize) -> Vec<u8> {
    drawn(number, |place| {
        let spots = CENTRES.iter().enumerate().map(|(element, &centre)| {
            let own = if element == loaded {
                force
            } else {
                DVec3::ZERO
            };
            let off = place - centre - 2.0 * own.truncate();
            120.0 * (1.0 + 0.6 * own.z) * (-off.length_squared() / 18.0).exp()
        });
        spots.sum()
    })
}

/// Renders an image with the gray levels `spots`, a function of the position (px), plus a background and noise.
pub fn drawn(number: usize, spots: impl Fn(DVec2) -> f64) -> Vec<u8> {
    let level = |column: usize, row: usize| {
        let place = DVec2::new(column as f64, row as f64);
        // Noise of half a gray value, different in each image.
        let noise =
            (12.9898 * place.x + 78.233 * place.y + 37.719 * number as f64).sin() * 43758.5453;
        (spots(place) + 4.0 + noise.fract()).clamp(0.0, 255.0) as u8
    };
    let rows = (0..SIZE.1).flat_map(|row| (0..SIZE.0).map(move |column| (column, row)));
    rows.map(|(column, row)| level(column, row)).collect()
}

/// Simulated force on the loaded element in its frame (N).
type Felt = Arc<Mutex<DVec3>>;

/// Wrench that the force sensor measures, including the fingertip's weight. x of the layout's frame is the sensor's y,
/// and the z axes are opposite.
fn wrench(felt: &Felt) -> [f64; 6] {
    let DVec3 { x, y, z } = *felt.lock().unwrap();
    [y + 1.0, x, z - 3.0, 0.0, 0.0, 0.0]
}

/// Address of a force sensor, and an object that keeps the sensor alive.
type Sensor = (String, Box<dyn Any>);

fn netft(felt: Felt) -> Sensor {
    let sensor = NetFtEmulator::start(500.0, move || Some(wrench(&felt))).expect("a socket");
    (sensor.address(), Box::new(sensor))
}

/// Like [`netft`], but as a ROS 2 topic.
#[cfg(feature = "ros2")]
fn topic(felt: Felt) -> Sensor {
    use feeler_record::ros::{Time, WrenchStamped};
    use feeler_ros2::{Node, NodeConfig, NodeName, Qos};
    let endpoint = crate::ports::unused_endpoint();
    let mut node = Node::open(NodeConfig {
        name: NodeName::new(5, "/", "force_sensor").expect("a name"),
        connect: Vec::new(),
        listen: vec![endpoint.clone()],
    })
    .expect("a node");
    let published = node.publish::<WrenchStamped>("/ft/wrench", Qos::SENSOR_DATA);
    let mut published = published.expect("a topic");
    let lives = Arc::new(());
    let life = Arc::downgrade(&lives);
    spawn(move || {
        let _node = node;
        let mut message = WrenchStamped::default();
        while life.strong_count() > 0 {
            let [x, y, z, ..] = wrench(&felt);
            message.wrench.force = DVec3::new(x, y, z).into();
            message.header.stamp = Time::of(1.0).expect("a time");
            published.publish(&message).expect("a message");
            sleep(Duration::from_millis(2));
        }
    });
    (
        format!("ros2:/ft/wrench?connect={endpoint}&domain=5"),
        Box::new(lives),
    )
}

/// Starts the program, which reads images from standard input, with the force sensor at `address` and `more` arguments.
pub fn program(folder: &Path, address: &str, more: &[&str]) -> Child {
    let arguments = [
        "calibrate",
        "bench",
        "--live=-",
        "--rate=50",
        "--layout=layout.toml",
        "--force-sensor",
        address,
        "--force-axes=y,x,-z",
        "--full-scale-normal=1",
        "--full-scale-shear=0.6",
        "-o=live.toml",
    ];
    let mut command = feeler(folder, &arguments);
    command
        .args(more)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command.spawn().expect("the program")
}

/// Starts the program and plays `loads` to it with a delayed camera. The sensor must outlive the program.
fn start(
    folder: &Path,
    loads: Vec<(usize, DVec3)>,
    sensor: fn(Felt) -> Sensor,
) -> (Child, JoinHandle<()>, Sensor) {
    let now = Felt::default();
    let sensor = sensor(Arc::clone(&now));
    let address = sensor.0.clone();
    let mut child = program(folder, &address, &[]);
    let mut camera = child.stdin.take().expect("its input");
    let player = spawn(move || {
        for number in 0..loads.len() {
            *now.lock().unwrap() = loads[number].1;
            let seen = loads[number.saturating_sub(LATE)];
            // The program may have all data that it needs.
            if camera.write_all(&picture(seen, number)).is_err() {
                return;
            }
            sleep(FRAME);
        }
    });
    (child, player, sensor)
}

fn end((child, player, sensor): (Child, JoinHandle<()>, Sensor)) -> Ended {
    player.join().unwrap();
    let ended = Ended::of(child.wait_with_output().expect("its end"));
    drop(sensor);
    ended
}

#[test]
fn live_loads_make_a_calibration() {
    let folder = folder("calibrate-live");
    fs::write(folder.join("layout.toml"), LAYOUT).unwrap();
    // The camera ends when one element is done; the measured loads are kept.
    let ended = end(start(&folder, loads(&[0]), netft));
    assert_eq!(ended.status, Some(2), "{ended:?}");
    for words in [
        "the camera stream has ended",
        "1 of 2 elements need more",
        "bench/LOADS.csv",
    ] {
        assert!(ended.stderr.contains(words), "no {words:?} in {ended:?}");
    }
    assert!(!folder.join("live.toml").exists());
    // A partly written row is measured again.
    let csv = folder.join("bench/LOADS.csv");
    let table = fs::read_to_string(&csv).unwrap();
    fs::write(&csv, format!("{table}00999.png,1,0.2")).unwrap();

    // The same command continues with the other element, and then ends.
    let ended = end(start(&folder, loads(&[1]), netft));
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let resumed = fs::read_to_string(&csv).unwrap();
    assert!(resumed.starts_with(&table) && resumed.len() > table.len());
    let late = ended
        .stderr
        .lines()
        .find_map(|line| line.strip_prefix("camera latency: "));
    let late = late
        .and_then(|rest| rest.split_once(' '))
        .expect("a delay")
        .0;
    // The simulated delay is 60 ms. On a busy computer, images and forces arrive later, each by a different time, so
    // that only a delay of more than one frame interval can be asserted. Unit tests check the delay with given times.
    assert!(late.parse::<f64>().unwrap() > 20.0, "{late} ms");

    // The result equals the calibration of the stored loads, and predicts the forces of rendered images.
    let again = [
        "calibrate",
        "bench/LOADS.csv",
        "--layout=layout.toml",
        "-o=again.toml",
    ];
    let scales = ["--full-scale-normal=1", "--full-scale-shear=0.6"];
    run(&folder, &[&again[..], &scales].concat()).done();
    let text = fs::read_to_string(folder.join("live.toml")).unwrap();
    assert_eq!(text, fs::read_to_string(folder.join("again.toml")).unwrap());
    assert!(folder.join("live.html").exists());
    assert_tells_forces(&folder, &text);
}

#[cfg(feature = "ros2")]
#[test]
fn forces_are_read_from_a_ros_2_topic() {
    let folder = folder("calibrate-live-ros2");
    fs::write(folder.join("layout.toml"), LAYOUT).unwrap();
    let ended = end(start(&folder, loads(&[0, 1]), topic));
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert_tells_forces(
        &folder,
        &fs::read_to_string(folder.join("live.toml")).unwrap(),
    );
}

/// Asserts that the calibration in `text` predicts the forces of new images.
fn assert_tells_forces(folder: &Path, text: &str) {
    let calibration = Calibration::from_toml(text).unwrap();
    for element in 0..2 {
        let truth = DVec3::new(0.2, -0.1, 0.5);
        let error = (told(folder, &calibration, element, truth) - truth).abs();
        // Gray values are integers, which causes errors of about 0.2 % of G and hundredths of a pixel, both of 0.5 N.
        // An image that is assigned one period late belongs to another load only next to a change, in one of 14 images.
        assert!(error.max_element() < 0.05, "element {element}: {error}");
    }
}

/// Force that `calibration` predicts for a new image (N).
fn told(folder: &Path, calibration: &Calibration, element: usize, force: DVec3) -> DVec3 {
    let layout = feeler_lab::sensor::SensorGeometry::read_layout(&folder.join("layout.toml"));
    let geometry = layout.expect("the layout");
    let picture = feeler::sensor::image::Picture {
        width: SIZE.0,
        height: SIZE.1,
        pixels: picture((element, force), 77),
    };
    let mut moments = [ElementMoments::default(); 2];
    geometry.kernel.measure(&picture, &mut moments).unwrap();
    calibration.elements[element].force(&moments[element])
}

#[test]
fn invalid_input_is_refused_with_an_explanation() {
    let folder = folder("calibrate-live-refused");
    fs::write(folder.join("layout.toml"), LAYOUT).unwrap();
    let refused = |arguments: &[&str], words: &[&str]| {
        let common = ["calibrate", "bench", "--layout=layout.toml", "-o=live.toml"];
        run(&folder, &[&common[..], arguments].concat()).refused(words);
    };
    let sensor = "--force-sensor=netft://127.0.0.1:9?cpf=1&cpt=1";
    refused(&["--live=-"], &["--force-sensor"]);
    refused(
        &["--live=-", "--force-sensor=netft://a?cpt=1"],
        &["cpf is missing", "Configurations"],
    );
    refused(&["--exposure=0.01"], &["--exposure", "--live"]);
    refused(
        &["--live=-", sensor, "--trigger=software"],
        &["--trigger requires a camera"],
    );
    refused(&["--wrench", "--full-scale-normal=1"], &["--live"]);
    refused(
        &["--live=-", "--force-sensor=/dev/ttyUSB0"],
        &["not a netft:// address", "ros2:/TOPIC"],
    );
    refused(
        &["--live=-", "--force-sensor=ros2:wrench"],
        &["\"wrench\" is not a topic", "ros2:/TOPIC"],
    );
    refused(&["--live=-", sensor, "--force-axes=x,y"], &["too few axes"]);
    refused(
        &["--live=picture.png", sensor],
        &["picture.png", "/dev/videoN"],
    );
    refused(&[sensor], &["--live"]);
    // A folder with unrelated files.
    fs::create_dir_all(folder.join("bench")).unwrap();
    fs::remove_file(folder.join("bench/LOADS.csv")).unwrap_or_default();
    fs::write(folder.join("bench/thesis.tex"), "").unwrap();
    refused(&["--live=-", sensor], &["bench", "not empty", "LOADS.csv"]);
    // Existing results are refused before any work.
    fs::write(folder.join("live.toml"), "").unwrap();
    refused(&["--live=-", sensor], &["live.toml", "exists already"]);
}
