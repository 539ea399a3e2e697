//! Layouts of elements at given places.

use feeler::sensor::fingertip::{
    CameraConfig, DomeGeometry, DomeProjection, ElementLayout, LayoutConfig, LayoutError,
    LocatedLayout, SensingElement,
};
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{Located, LocatedElement, Polarity};
use feeler::sensor::moments::ElementMoments;
use glam::{DVec2, DVec3};

const DOME_RADIUS: f64 = 0.018;

fn located(size: (usize, usize), elements: Vec<LocatedElement>) -> Located {
    Located {
        size,
        elements,
        spacing_px: 30.0,
        spot_diameter_px: 5.0,
        spot_area_diameter_px: 5.0,
        spots_per_element: 1,
        polarity: Polarity::Bright,
        two_level: false,
        dark_level: 20,
        warnings: Vec::new(),
    }
}

fn element(centre_px: DVec2, radius_px: f64, spots_px: Vec<DVec2>) -> LocatedElement {
    LocatedElement {
        centre_px,
        radius_px,
        spots_px,
        ground_level: 20,
    }
}

/// Two discs of radius 6 px in an image of 60x40 px.
fn flat() -> Located {
    let at = |x, y| element(DVec2::new(x, y), 6.0, vec![DVec2::new(x, y)]);
    located((60, 40), vec![at(20.251_237, 15.5), at(40.0, 25.0)])
}

#[test]
fn without_a_dome_moments_are_in_pixels_relative_to_the_centres() {
    let layout = LocatedLayout::new(&flat());
    // Rounded to a ten-thousandth of a pixel.
    assert_eq!(layout.elements[0].centre_px, DVec2::new(20.2512, 15.5));
    assert_eq!((layout.elements[0].radius_px, layout.dark_level), (6.0, 20));
    let mut picture = Picture::black(60, 40);
    picture.pixels.fill(30);
    let bright = (42, 28);
    picture.pixels[bright.1 * 60 + bright.0] = 220;
    let kernel = layout.kernel().expect("a kernel");
    let mut moments = [ElementMoments::default(); 2];
    kernel.measure(&picture, &mut moments).expect("moments");
    let pixels = layout.weighted_pixels().expect("pixels");
    for (moments, pixels) in moments.iter().zip(&pixels) {
        let inside = pixels
            .iter()
            .filter(|p| (p.column, p.row) == bright)
            .count();
        let gray = 10.0 * pixels.len() as f64 + 190.0 * inside as f64;
        assert!(
            (moments.integrated_gray / gray - 1.0).abs() < 3e-5,
            "{moments:?}"
        );
        // A disc of radius 6 px has an area of 113 px².
        assert!(
            (pixels.len() as f64 - 113.0).abs() < 6.0,
            "{}",
            pixels.len()
        );
        assert!(
            pixels
                .iter()
                .all(|p| p.area == 1.0 && p.point.length() <= 6.0)
        );
    }
    // 190 levels at (2, 3), next to 10 levels at each of 113 places around (0, 0).
    let share = 190.0 / moments[1].integrated_gray;
    let expected = share * DVec2::new(2.0, 3.0);
    assert!(
        moments[1].centroid.distance(expected) < 1e-3,
        "{:?}",
        moments[1]
    );
}

/// Projected tips of the reference layout, in shuffled order, each with two spots around it.
fn on_dome() -> (Located, DomeGeometry, ElementLayout) {
    let layout = ElementLayout::new(&LayoutConfig::default());
    let camera = CameraConfig::default();
    let projection = DomeProjection::new(&camera, DOME_RADIUS).expect("a dome");
    let count = layout.elements.len();
    let elements = (0..count).map(|n| {
        let tip = layout.tip(n * 7 % count);
        let beside = 0.001 * tip.normalize().any_orthonormal_vector();
        let seen = |at: DVec3| {
            projection
                .project(DOME_RADIUS * at.normalize())
                .expect("seen")
        };
        let spots = vec![seen(tip + beside), seen(tip - beside)];
        element((spots[0] + spots[1]) / 2.0, 10.0, spots)
    });
    let found = located((camera.width, camera.height), elements.collect());
    let dome = DomeGeometry {
        radius: DOME_RADIUS,
        camera,
    };
    (found, dome, layout)
}

#[test]
fn elements_on_a_dome_are_sorted_into_rings_and_point_outward() {
    let (found, dome, expected) = on_dome();
    let projection = DomeProjection::new(&dome.camera, dome.radius).expect("a dome");
    let layout = LocatedLayout::on_dome(&found, dome).expect("a layout");
    assert_eq!(layout.elements.len(), expected.elements.len());
    for (n, (place, expected_element)) in layout.elements.iter().zip(&expected.elements).enumerate()
    {
        assert_eq!(
            place.ring,
            Some(expected_element.ring),
            "element {n}: {place:?}"
        );
        let direction = place.direction.expect("a direction");
        // The middle of two symmetrical spots, up to rounding.
        assert!(
            direction.distance(expected_element.normal()) < 1e-9,
            "element {n}: {place:?}"
        );
        let seen = projection.project(expected.tip(n)).expect("seen");
        assert!(
            place.centre_px.distance(seen) < 1e-4,
            "element {n}: {place:?}"
        );
    }
    // In metres: discs of radius 10 px, scaled by the dewarp's area.
    let areas = layout.weighted_pixels().expect("pixels");
    let apex: f64 = areas[0].iter().map(|p| p.area).sum();
    let scale = (DOME_RADIUS + 0.010) / 195.0;
    let area = std::f64::consts::PI * (10.0 * scale).powi(2);
    assert!(
        (apex / area - 1.0).abs() < 0.03,
        "{apex} m² instead of {area} m²"
    );
}

#[test]
fn elements_outside_the_dome_are_rejected() {
    let (found, mut dome, _) = on_dome();
    dome.camera.standoff = -0.017;
    dome.camera.focal_length_px = 3.0;
    dome.camera.radial_distortion = [-0.5, 0.0];
    let error = LocatedLayout::on_dome(&found, dome).expect_err("refused");
    assert!(matches!(error, LayoutError::OffDome { .. }), "{error}");
}

fn text() -> String {
    let (found, dome, _) = on_dome();
    LocatedLayout::on_dome(&found, dome)
        .expect("a layout")
        .to_toml()
        .expect("text")
}

#[test]
fn layouts_survive_a_round_trip_and_have_distinct_hashes() {
    let layout = LocatedLayout::from_toml(&text()).expect("a layout");
    assert_eq!(layout.to_toml().expect("text"), text());
    let hash = layout.hash().expect("a hash");
    assert_eq!(hash, feeler::sensor::fingertip::sha256(&text()));
    let mut other = layout.clone();
    other.dark_level += 1;
    assert_ne!(other.hash().expect("a hash"), hash);
}

#[test]
fn invalid_values_are_rejected() {
    type Change = fn(&mut LocatedLayout);
    let cases: [(Change, &str); 19] = [
        (|l| l.version = 2, "version 1, got 2"),
        (|l| l.width = 0, "width, height"),
        (|l| l.height = 0, "width, height"),
        (|l| l.width = (1 << 14) + 1, "width, height"),
        (|l| l.height = (1 << 14) + 1, "width, height"),
        (
            |l| (l.width, l.height) = (1 << 14, (1 << 12) + 1),
            "width, height",
        ),
        (|l| l.elements.clear(), "1 to 4096 elements"),
        (
            |l| l.elements[3].centre_px.x = 640.0,
            "element 3: centre_px",
        ),
        (
            |l| l.elements[3].centre_px.y = 480.0,
            "element 3: centre_px",
        ),
        (|l| l.elements[3].centre_px.x = -0.1, "element 3: centre_px"),
        (
            |l| l.elements[3].centre_px.y = f64::NAN,
            "element 3: centre_px",
        ),
        (|l| l.elements[3].radius_px = 0.0, "element 3: radius_px"),
        (|l| l.elements[3].radius_px = 640.1, "element 3: radius_px"),
        (
            |l| l.elements[3].radius_px = f64::NAN,
            "element 3: radius_px",
        ),
        (
            |l| l.elements[3].direction = Some(DVec3::NAN),
            "a unit vector",
        ),
        (
            |l| l.elements[3].direction = Some(DVec3::X * 1.000_002),
            "a unit vector",
        ),
        (
            |l| l.elements[3].direction = Some(DVec3::X * 0.999_998),
            "a unit vector",
        ),
        (|l| l.elements[3].direction = None, "required with a dome"),
        (|l| (l.width, l.height) = (641, 480), "dome.camera"),
    ];
    for (change, words) in cases {
        let mut layout = LocatedLayout::from_toml(&text()).expect("a layout");
        change(&mut layout);
        let text = layout.to_toml().expect("text");
        let message = LocatedLayout::from_toml(&text)
            .expect_err("refused")
            .to_string();
        assert!(message.contains(words), "{words}: {message}");
    }
    // The maximum size is accepted.
    let mut layout = LocatedLayout::from_toml(&text()).expect("a layout");
    layout.dome = None;
    (layout.width, layout.height) = (1 << 14, 1 << 12);
    layout.elements[3].radius_px = f64::from(1 << 14);
    layout.elements[3].direction = Some(DVec3::X * 1.000_000_5);
    let text = layout.to_toml().expect("text");
    assert!(LocatedLayout::from_toml(&text).is_ok());
    let many = vec![layout.elements[0].clone(); 4097];
    layout.elements = many;
    let error = LocatedLayout::from_toml(&layout.to_toml().expect("text"));
    assert!(matches!(
        error,
        Err(LayoutError::ElementCount { actual: 4097 })
    ));
}

/// At polar angles just below and above one degree, and beyond 90 degrees, the frame is right-handed and its z axis
/// is the direction.
#[test]
fn an_element_faces_its_direction() {
    for (polar_deg, about_apex) in [
        (0.0, true),
        (0.9, true),
        (1.1, false),
        (70.0, false),
        (179.5, false),
    ] {
        for azimuth in [0.3, 2.0, -2.5] {
            let (sin, cos) = f64::to_radians(polar_deg).sin_cos();
            let around = DVec2::from_angle(azimuth);
            let direction = DVec3::new(cos, sin * around.x, sin * around.y);
            let element = SensingElement::facing(direction);
            let [x, y, z] = [
                element.rotation.x_axis,
                element.rotation.y_axis,
                element.rotation.z_axis,
            ];
            assert!(z.distance(direction) < 1e-12 && x.cross(y).distance(z) < 1e-12);
            assert!(x.is_normalized() && y.is_normalized());
            // Around the apex, x is along y of `T`; elsewhere it is along the meridian, away from the apex.
            let meridian = DVec3::new(-sin, cos * around.x, cos * around.y);
            let expected = if about_apex { DVec3::Y } else { meridian };
            // A degree of tilt.
            assert!(x.distance(expected) < 0.018, "{polar_deg} {azimuth}: {x}");
        }
    }
    assert_eq!(LayoutConfig::default().element_count(), 41);
}
