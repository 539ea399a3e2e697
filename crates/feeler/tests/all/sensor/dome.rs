//! Consistency of the dome's projection: round trips and areas.

use feeler::sensor::fingertip::{
    CameraConfig, DomeError, DomeProjection, ElementLayout, LayoutConfig,
};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use std::f64::consts::TAU;

const DOME_RADIUS: f64 = 0.018;

fn camera() -> impl Strategy<Value = CameraConfig> {
    (
        50.0..2000.0,
        -0.5..0.95,
        [0.0..640.0, 0.0..480.0],
        [-0.1..0.1, -0.02..0.02],
    )
        .prop_map(
            |(focal_length_px, share, [x, y], radial_distortion)| CameraConfig {
                focal_length_px,
                standoff: share * DOME_RADIUS,
                centre_px: Some([x, y]),
                radial_distortion,
                ..CameraConfig::default()
            },
        )
}

/// Pixel at which a pinhole camera `standoff` behind the dome's centre, with radial distortion, sees `point`.
/// Computed from the definition, independently of the tested projection.
fn brute_force_pixel(camera: &CameraConfig, point: DVec3) -> DVec2 {
    let slope = DVec2::new(point.y, point.z) / (point.x + camera.standoff);
    let [k1, k2] = camera.radial_distortion;
    let square = slope.length_squared();
    let [x, y] = camera.centre_px.expect("a centre");
    let distorted = slope * (1.0 + k1 * square + k2 * square * square);
    DVec2::new(x, y) + camera.focal_length_px * distorted
}

proptest! {
    /// The dewarp is exact to 0.01 px for random cameras and distortions: a pixel's place in the element's plane,
    /// lifted onto the sphere along the element's normal and projected by brute force, is at that pixel.
    #[test]
    fn the_dewarp_agrees_with_a_brute_force_projection(
        camera in camera(),
        element in 0..41_usize,
        x in 0.0..640.0,
        y in 0.0..480.0,
    ) {
        let layout = ElementLayout::new(&LayoutConfig::default());
        let element = &layout.elements[element];
        let projection = DomeProjection::new(&camera, DOME_RADIUS).unwrap();
        let pixel = DVec2::new(x, y);
        if let Some(dewarped) = projection.dewarp(pixel, element) {
            let DVec2 { x, y } = dewarped.point;
            let height = (DOME_RADIUS * DOME_RADIUS - x * x - y * y).sqrt();
            let point = element.rotation * DVec3::new(x, y, height);
            let seen = brute_force_pixel(&camera, point);
            prop_assert!(seen.distance(pixel) < 0.01, "{seen} {pixel}");
        }
    }

    /// A visible point of the dome is recovered from its pixel. Points are 18 mm from the origin with a relative
    /// error of 1e-16; pixels magnify errors at most a few thousandfold.
    #[test]
    fn point_to_pixel_and_back(
        camera in camera(),
        polar in 0.0..1.4,
        azimuth in 0.0..TAU,
    ) {
        let projection = DomeProjection::new(&camera, DOME_RADIUS).unwrap();
        let tangent = DVec2::from_angle(azimuth) * f64::sin(polar);
        let point = DOME_RADIUS * DVec3::new(f64::cos(polar), tangent.x, tangent.y);
        let pixel = projection.project(point);
        if camera.radial_distortion[0] >= 0.0 && camera.radial_distortion[1] >= 0.0 && camera.standoff >= 0.0 {
            prop_assert!(pixel.is_some(), "this point is visible");
        }
        if let Some(pixel) = pixel {
            let back = projection.point_at(pixel);
            prop_assert!(back.is_some(), "{pixel} shows the dome");
            // Next to the fold of barrel distortion, the map is flat and loses half of the digits.
            let tolerance = 1e-9;
            prop_assert!((back.unwrap() - point).length() < tolerance, "{back:?} {point}");
        }
    }

    /// With any camera, the point of each pixel lies on the dome.
    #[test]
    fn pixels_see_the_dome(camera in camera(), x in 0.0..640.0, y in 0.0..480.0) {
        let projection = DomeProjection::new(&camera, DOME_RADIUS).unwrap();
        if let Some(point) = projection.point_at(DVec2::new(x, y)) {
            prop_assert!((point.length() - DOME_RADIUS).abs() < 1e-12);
            prop_assert!(point.x > -camera.standoff);
        }
    }

    /// A visible place in an element's plane, lifted onto the dome, is dewarped to itself.
    #[test]
    fn plane_to_pixel_and_back(element in 0..41_usize, x in -2e-3..2e-3, y in -2e-3..2e-3) {
        let layout = ElementLayout::new(&LayoutConfig::default());
        let projection = DomeProjection::new(&CameraConfig::default(), DOME_RADIUS).unwrap();
        let element = &layout.elements[element];
        let place = DVec2::new(x, y);
        let pixel = projection.project(projection.lift(place, element).unwrap()).unwrap();
        let dewarped = projection.dewarp(pixel, element).unwrap();
        prop_assert!((dewarped.point - place).length() < 1e-12);
        // Area of the quadrilateral between the places half a pixel to each side, computed with the inverse map:
        // small steps in the plane, and the determinant in the image.
        let step = 1e-6;
        let seen = |offset| projection.project(projection.lift(place + offset, element).unwrap()).unwrap();
        let along_x = (seen(DVec2::X * step) - seen(-DVec2::X * step)) / (2.0 * step);
        let along_y = (seen(DVec2::Y * step) - seen(-DVec2::Y * step)) / (2.0 * step);
        // A pixel covers at most 0.15 mm, over which the area of a pixel changes by less than 1 %.
        let expected = 1.0 / along_x.perp_dot(along_y).abs();
        prop_assert!((dewarped.area / expected - 1.0).abs() < 1e-2, "{} {expected}", dewarped.area);
    }
}

#[test]
fn the_image_is_not_mirrored() {
    let projection = DomeProjection::new(&CameraConfig::default(), DOME_RADIUS).unwrap();
    let centre = projection.centre();
    assert_eq!(centre, DVec2::new(319.5, 239.5));
    assert_eq!(projection.project(DVec3::X * DOME_RADIUS), Some(centre));
    let right = projection.project(DVec3::new(0.01, 0.001, 0.0)).unwrap();
    assert!(right.x > centre.x && right.y == centre.y, "{right}");
    let below = projection.project(DVec3::new(0.01, 0.0, 0.001)).unwrap();
    assert!(below.x == centre.x && below.y > centre.y, "{below}");
}

#[test]
fn impossible_geometry_is_rejected() {
    let refused = |change: fn(&mut CameraConfig)| {
        let mut camera = CameraConfig::default();
        change(&mut camera);
        DomeProjection::new(&camera, DOME_RADIUS).unwrap_err()
    };
    assert_eq!(
        refused(|c| c.standoff = 0.018),
        DomeError::PinholeOutside {
            standoff: 0.018,
            dome_radius: DOME_RADIUS
        }
    );
    assert!(matches!(
        refused(|c| c.width = 0),
        DomeError::PictureSize { .. }
    ));
    assert!(matches!(
        refused(|c| c.focal_length_px = -1.0),
        DomeError::NotPositive { .. }
    ));
    assert!(matches!(
        refused(|c| c.radial_distortion[1] = f64::NAN),
        DomeError::NotFinite { .. }
    ));
    let message = refused(|c| c.standoff = 0.02).to_string();
    assert!(
        message.contains("0.02") && message.contains("0.018"),
        "{message}"
    );
}
