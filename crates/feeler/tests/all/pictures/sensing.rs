//! Readings of two rectangles of a small image.

use feeler::sensor::calibration::{
    CALIBRATION_VERSION, Calibration, CalibrationTarget, ElementCalibration, ElementQuality,
    ForceCurve, ForceMap, ForceUnit, ForceValidity, FullScale, LengthUnit, SeparableMap,
};
use feeler::sensor::fingertip::FingertipConfig;
use feeler::sensor::forces::{
    DriftConfig, ElementReading, OpticalSensor, Reference, SensingChain, SensingError,
    TactileFrame, TactileSensor,
};
use feeler::sensor::image::{
    Camera, CameraError, Exposure, Frame, Picture, WeightedPixel, check_frame_size,
};
use feeler::sensor::moments::{ElementMoments, MomentsKernel};
use glam::{DVec2, DVec3};

const SIZE: (usize, usize) = (20, 8);
const DARK: u8 = 10;

/// The left and the right half of the image, with places relative to their middles (px).
fn regions() -> Vec<Vec<WeightedPixel>> {
    let region = |first: usize| {
        let pixel = |n: usize| {
            let (column, row) = (first + n % 10, n / 10);
            WeightedPixel {
                column,
                row,
                area: 1.0,
                point: DVec2::new(column as f64 - first as f64 - 4.5, row as f64 - 3.5),
            }
        };
        (0..80).map(pixel).collect()
    };
    vec![region(0), region(10)]
}

fn sensing() -> SensingChain {
    let kernel = MomentsKernel::from_subregions(SIZE, DARK, &regions()).expect("a kernel");
    SensingChain::new(SIZE, kernel, &regions(), 0.1).expect("a sensor")
}

/// Image with gray values `left` and `right` in the outer columns of the left half, and `other` in the right half.
fn picture(left: u8, right: u8, other: u8) -> Picture {
    let mut picture = Picture::black(SIZE.0, SIZE.1);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        *pixel = match index % SIZE.0 {
            0..5 => left,
            5..10 => right,
            _ => other,
        };
    }
    picture
}

fn sensed(sensing: &mut SensingChain, picture: &Picture) -> [ElementReading; 2] {
    let mut readings = [ElementReading::default(); 2];
    sensing.sense(picture, &mut readings).expect("readings");
    readings
}

/// Linear curves: 2 N for twice the gray value, and 0.1 N and 0.2 N per pixel along x and y.
fn calibration() -> Calibration {
    let line = |slope: f64, end: f64| ForceCurve {
        range: [-end, end],
        coefficients: [slope, 0.0, 0.0],
    };
    let element = ElementCalibration {
        unloaded_gray: 80.0 * 50.0,
        unloaded_centroid: DVec2::new(0.0, 0.5),
        map: ForceMap::Separable(SeparableMap {
            normal: line(2.0, 2.0),
            shear_x: line(0.1, 5.0),
            shear_y: line(0.2, 5.0),
        }),
        quality: ElementQuality::default(),
    };
    Calibration {
        version: CALIBRATION_VERSION,
        force_unit: ForceUnit::Newton,
        full_scale: FullScale::default(),
        loads_confirmed: false,
        made_for: CalibrationTarget::layout("two halves", 2, LengthUnit::Pixel),
        elements: vec![element; 2],
    }
}

/// 40 pixels at -2.5 px and 40 at 2.5 px.
#[test]
fn gray_value_and_centroid_agree_with_the_image_halves() {
    let mut sensing = sensing();
    assert_eq!((sensing.element_count(), sensing.picture_size()), (2, SIZE));
    assert!(!sensing.is_calibrated() && sensing.reference().is_none());
    let [own, other] = sensed(&mut sensing, &picture(DARK + 10, DARK + 30, DARK));
    assert!((own.integrated_gray - 40.0 * 40.0).abs() < 1e-9, "{own:?}");
    let centroid = own.centroid.expect("a centroid");
    assert!(centroid.distance(DVec2::new(1.25, 0.0)) < 1e-6, "{own:?}");
    assert_eq!(
        (own.exposure, own.force, own.displacement),
        (Exposure::Good, None, None)
    );
    let dark = ElementReading {
        exposure: Exposure::Dark,
        ..ElementReading::default()
    };
    assert_eq!(other, dark);
    assert_eq!(sensing.moments()[0].centroid, centroid);
    assert_eq!(sensing.moments()[1], ElementMoments::default());
    assert_eq!(sensing.validity().count(), 0);
}

#[test]
fn displacements_are_relative_to_the_mean_of_lit_references() {
    let mut sensing = sensing();
    let first = sensed(&mut sensing, &picture(30, 30, DARK));
    let second = sensed(&mut sensing, &picture(DARK + 10, DARK + 30, 60));
    let reference = Reference::from_readings([&first[..], &second[..]]);
    let [own, other] = [0, 1].map(|i| reference.centroids[i].expect("a centroid"));
    assert!(own.distance(DVec2::new(0.625, 0.0)) < 1e-6, "{own}");
    assert!(other.length() < 1e-6, "{other}");
    let never = Reference::from_readings([&first[..], &first[..]]);
    assert_eq!(never.centroids[1], None);

    sensing
        .set_reference(reference.clone())
        .expect("a reference");
    assert_eq!(sensing.reference(), Some(&reference));
    let [own, other] = sensed(&mut sensing, &picture(DARK + 30, DARK + 10, DARK));
    let moved = own.displacement.expect("a displacement");
    assert!(
        moved.distance(DVec2::new(-1.25 - 0.625, 0.0)) < 1e-6,
        "{moved}"
    );
    assert_eq!(other.displacement, None);
    let one = Reference {
        centroids: vec![None],
    };
    let error = sensing.set_reference(one).expect_err("refused");
    assert!(matches!(
        error,
        SensingError::ElementCount {
            expected: 2,
            actual: 1,
            ..
        }
    ));
}

#[test]
fn forces_require_sufficient_exposure() {
    let mut sensing = sensing()
        .with_calibration(calibration())
        .expect("a calibration");
    assert!(sensing.is_calibrated());
    // The left half has 1.5 times the unloaded gray value of 50, displaced by a third of 2.5 px. In the right half, a
    // tenth of the pixels or more are saturated.
    for (saturated, exposure) in [(8, Exposure::Good), (9, Exposure::Saturated)] {
        let mut picture = picture(DARK + 50, DARK + 100, DARK + 50);
        for n in 0..saturated {
            picture.pixels[10 + n % 2 + SIZE.0 * (n / 2)] = 255;
        }
        let readings = sensed(&mut sensing, &picture);
        let force = readings[0].force.expect("a force");
        let expected = DVec3::new(0.1 * 2.5 / 3.0, 0.2 * -0.5, 2.0 * 0.5);
        assert!(force.distance(expected) < 1e-6, "{force}");
        let displacement = readings[0].displacement.expect("a displacement");
        assert!(displacement.distance(DVec2::new(2.5 / 3.0, -0.5)) < 1e-6);
        assert_eq!(readings[1].exposure, exposure);
        assert_eq!(readings[1].force.is_some(), exposure == Exposure::Good);
        let mut forces = [DVec3::ZERO; 2];
        sensing.sense_forces(&picture, &mut forces).expect("forces");
        assert_eq!(forces[0], force);
        assert_eq!(Some(forces[1]).filter(|f| !f.is_nan()), readings[1].force);
    }
    let dark = picture(DARK + 50, DARK + 50, DARK);
    let readings = sensed(&mut sensing, &dark);
    assert_eq!(
        (readings[1].exposure, readings[1].force),
        (Exposure::Dark, None)
    );
    let validity: Vec<_> = sensing.validity().collect();
    assert_eq!(validity, [ForceValidity::Calibrated, ForceValidity::Dark]);
}

#[test]
fn calibrations_and_kernels_of_other_sizes_are_rejected() {
    let mut one = calibration();
    one.elements.pop();
    assert!(sensing().with_calibration(one).is_err());
    let picture = picture(30, 30, 30);
    let mut sensing = sensing();
    assert!(
        sensing
            .sense(&picture, &mut [ElementReading::default(); 3])
            .is_err()
    );
    assert!(
        sensing
            .sense_forces(&picture, &mut [DVec3::ZERO; 1])
            .is_err()
    );
    let kernel = MomentsKernel::from_subregions(SIZE, DARK, &regions()).expect("a kernel");
    assert!(SensingChain::new(SIZE, kernel, &regions()[..1], 0.1).is_err());
}

/// The light of all elements dims by a tenth, which causes no force if the correction is active.
#[test]
fn drift_is_corrected_if_configured() {
    let read = |sensing: SensingChain| {
        let mut sensing = sensing
            .with_calibration(calibration())
            .expect("a calibration");
        sensing = sensing.with_drift_correction(DriftConfig::default());
        let mut force = DVec3::ZERO;
        for _ in 0..200 {
            let readings = sensed(&mut sensing, &picture(DARK + 45, DARK + 45, DARK + 45));
            force = readings[0].force.expect("a force");
        }
        force.z
    };
    assert!(read(sensing()).abs() < 1e-3);
    let mut plain = sensing()
        .with_calibration(calibration())
        .expect("a calibration");
    let readings = sensed(&mut plain, &picture(DARK + 45, DARK + 45, DARK + 45));
    assert!((readings[0].force.expect("a force").z + 0.2).abs() < 1e-6);
}

/// A camera whose images get brighter.
struct Brightening(u64);

impl Camera for Brightening {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        check_frame_size((640, 480), frame)?;
        self.0 += 1;
        frame.picture.pixels.fill(100 + 10 * self.0 as u8);
        (frame.sequence, frame.stamp) = (self.0, 0.5 * self.0 as f64);
        Ok(())
    }
}

#[test]
fn an_optical_sensor_computes_forces_from_its_cameras_images() {
    let config = FingertipConfig::default();
    let mut calibration = calibration();
    calibration.made_for = CalibrationTarget::fingertip(&config).expect("a fingertip");
    let mut element = calibration.elements[0].clone();
    // Gray value 100 is 76 above the dark level of 24, over a disc of radius 2.6 mm.
    element.unloaded_gray = 76.0 * std::f64::consts::PI * 2.6e-3_f64.powi(2);
    element.unloaded_centroid = DVec2::ZERO;
    calibration.elements = vec![element; 41];
    // Boxed, as if the camera were chosen at run time.
    let camera: Box<dyn Camera> = Box::new(Brightening(0));
    let mut sensor = OpticalSensor::new(camera, &config, calibration.clone()).expect("a sensor");
    let mut frame = TactileFrame::unloaded(41);
    assert_eq!(sensor.element_count(), 41);
    for n in 1..4 {
        sensor.read(&mut frame).expect("a reading");
        assert_eq!((frame.sequence, frame.stamp), (n, 0.5 * n as f64));
        let expected = 2.0 * (10.0 * n as f64) / 76.0;
        for force in &frame.forces {
            // The areas of the discs, and therefore G, are accurate to 1.2 %.
            assert!((force.z - expected).abs() < 2.0 * 0.012 * 1.5, "{force}");
        }
        assert!(frame.is_valid(40) && !frame.is_valid(41));
        assert_eq!(frame.first_invalid(), None);
        assert_eq!(sensor.moments().len(), 41);
        assert!(sensor.validity().all(|v| v == ForceValidity::Calibrated));
        assert_eq!(sensor.validity().count(), 41);
        assert_eq!(sensor.frame().picture.pixels[0], 100 + 10 * n as u8);
        assert_eq!(TactileSensor::frame(&sensor).expect("a frame").sequence, n);
    }
    frame.forces[7] = feeler::sensor::forces::NO_FORCE;
    assert_eq!((frame.first_invalid(), frame.is_valid(7)), (Some(7), false));
    assert!(sensor.read(&mut TactileFrame::unloaded(40)).is_err());
    calibration.elements.pop();
    let error = OpticalSensor::new(Brightening(0), &config, calibration).map(|_| ());
    assert!(error.is_err());
}

#[test]
fn frames_of_another_size_are_rejected() {
    assert!(check_frame_size((4, 3), &Frame::black(4, 3)).is_ok());
    for size in [(3, 4), (4, 4), (5, 3)] {
        assert!(check_frame_size(size, &Frame::black(4, 3)).is_err());
    }
    let mut short = Frame::black(4, 3);
    short.picture.pixels.pop();
    assert!(check_frame_size((4, 3), &short).is_err());
}
