//! Images of a fingertip other than the calibrated one are rejected at the start.

use feeler::sensor::calibration::{
    CALIBRATION_VERSION, Calibration, CalibrationTarget, CoupledMap, ElementCalibration,
    ElementQuality, ForceMap, ForceUnit, FullScale,
};
use feeler::sensor::fingertip::FingertipConfig;
use feeler::sensor::forces::{Mismatch, SensingChain, TactileFrame};
use feeler::sensor::image::Picture;

const ELEMENTS: usize = 41;

/// The reference fingertip with a small image.
fn fingertip() -> FingertipConfig {
    let mut fingertip = FingertipConfig::default();
    let camera = &mut fingertip.camera;
    (camera.width, camera.height, camera.focal_length_px) = (160, 120, 48.75);
    fingertip
}

/// Image with gray value `gray`, and `other` in the rightmost `columns` columns.
fn picture(gray: u8, columns: usize, other: u8) -> Picture {
    let mut picture = Picture::black(160, 120);
    let width = picture.width;
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        *pixel = if index % width >= width - columns {
            other
        } else {
            gray
        };
    }
    picture
}

/// Senses `picture` and checks it as the first image.
fn check(sensing: &mut SensingChain, picture: &Picture) -> Result<(), Mismatch> {
    let mut frame = TactileFrame::unloaded(ELEMENTS);
    let sensed = sensing.sense_forces(picture, &mut frame.forces);
    sensed.expect("forces");
    sensing.check_first(picture)
}

/// Calibrated without load in an image of gray value 60, and with loads up to three times as bright.
fn sensing() -> SensingChain {
    let fingertip = fingertip();
    let mut sensing = SensingChain::of_fingertip(&fingertip).expect("a fingertip");
    assert_eq!(
        check(&mut sensing, &picture(180, 0, 0)),
        Ok(()),
        "not calibrated"
    );
    assert_eq!(check(&mut sensing, &picture(60, 0, 0)), Ok(()));
    let elements = sensing.moments().iter().map(|moments| ElementCalibration {
        unloaded_gray: moments.integrated_gray,
        unloaded_centroid: moments.centroid,
        map: ForceMap::Coupled(CoupledMap {
            growth_range: [0.0, 2.0],
            x_range: [-7e-4, 7e-4],
            y_range: [-7e-4, 7e-4],
            normal: vec![1.0, 0.0],
            shear_x: vec![1.0, 0.0],
            shear_y: vec![1.0, 0.0],
        }),
        quality: ElementQuality::default(),
    });
    let calibration = Calibration {
        version: CALIBRATION_VERSION,
        force_unit: ForceUnit::Newton,
        full_scale: FullScale::default(),
        loads_confirmed: false,
        made_for: CalibrationTarget::fingertip(&fingertip).expect("a hash"),
        elements: elements.collect(),
    };
    let sensing = sensing.with_calibration(calibration);
    sensing.expect("as many elements")
}

#[test]
fn images_of_another_fingertip_are_rejected() {
    let refused = Mismatch {
        off: ELEMENTS,
        lit: ELEMENTS,
    };
    let mut sensing = sensing();
    let other = picture(90, 0, 0);
    assert_eq!(check(&mut sensing, &other), Err(refused.clone()));
    // The check is repeated if sensing continues regardless.
    assert_eq!(check(&mut sensing, &other), Err(refused.clone()));
    let words = refused.to_string();
    assert!(
        words.contains("41 of 41") && words.contains("another fingertip"),
        "{words}"
    );
}

#[test]
fn initial_contact_and_small_drift_are_accepted() {
    for first in [
        picture(60, 0, 0),
        picture(60, 60, 120),
        picture(60, 70, 255),
        picture(62, 0, 0),
    ] {
        let mut sensing = sensing();
        assert_eq!(check(&mut sensing, &first), Ok(()));
        // Changes after the first image are contact.
        assert_eq!(check(&mut sensing, &picture(180, 0, 0)), Ok(()));
    }
}

#[test]
fn dark_and_saturated_images_are_not_judged() {
    for nothing in [picture(0, 0, 0), picture(255, 0, 0), picture(90, 120, 0)] {
        let mut sensing = sensing();
        assert_eq!(check(&mut sensing, &nothing), Ok(()));
        assert!(check(&mut sensing, &picture(90, 0, 0)).is_err());
    }
}
