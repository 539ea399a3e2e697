//! A synthetic fingertip whose spots brighten and move by a known law.

use feeler::sensor::fingertip::{
    CalibrationTarget, ElementPlace, LAYOUT_VERSION, LengthUnit, LocatedLayout,
};
use feeler::sensor::forces::{ElementReading, SensingChain};
use feeler::sensor::image::{Picture, Polarity};
use feeler::sensor::wrench::moments::usable;
use feeler::sensor::wrench::{MeasuredWrench, WrenchSample};
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Number of spots along a side of the image.
const SIDE: usize = 4;
/// Distance between spots, px.
const SPACING: usize = 20;
/// Number of spots.
pub const ELEMENTS: usize = SIDE * SIDE;

/// The layout of the spots.
pub fn layout() -> LocatedLayout {
    let place = |index: usize| ElementPlace {
        centre_px: centre(index),
        radius_px: 9.0,
        direction: None,
        ring: None,
        ground_level: None,
    };
    LocatedLayout {
        version: LAYOUT_VERSION,
        width: SIDE * SPACING,
        height: SIDE * SPACING,
        polarity: Polarity::Bright,
        two_level: false,
        dark_level: 5,
        spot_diameter_px: None,
        dome: None,
        elements: (0..ELEMENTS).map(place).collect(),
    }
}

fn centre(index: usize) -> DVec2 {
    let along = |place: usize| (place as f64 + 0.5) * SPACING as f64;
    DVec2::new(along(index % SIDE), along(index / SIDE))
}

/// Sensing of the spots.
pub fn chain() -> SensingChain {
    let layout = layout();
    let regions = layout.weighted_pixels().expect("regions");
    let size = (layout.width, layout.height);
    SensingChain::new(size, layout.kernel().expect("a kernel"), &regions, 0.01).expect("a chain")
}

/// Target of a calibration of the spots.
pub fn made_for() -> CalibrationTarget {
    CalibrationTarget::layout(
        &layout().to_toml().expect("text"),
        ELEMENTS,
        LengthUnit::Pixel,
    )
}

/// Image under a force on the fingertip (N), with a lamp of brightness `lamp`.
///
/// Spot i brightens by `a_i . f` with fixed a_i of up to 5 % per newton, and moves by 0.3 px per newton of shear.
/// Each pixel has noise of 2 grey levels.
pub fn picture(force: DVec3, lamp: f64, random: &mut Pcg64) -> Picture {
    let side = SIDE * SPACING;
    let mut pixels = vec![0_u8; side * side];
    for (place, pixel) in pixels.iter_mut().enumerate() {
        let at = DVec2::new((place % side) as f64 + 0.5, (place / side) as f64 + 0.5);
        let index = (at.y as usize / SPACING) * SIDE + at.x as usize / SPACING;
        let growth = 1.0 + sensitivity(index).dot(force);
        let from_centre = at - centre(index) - 0.3 * force.truncate();
        let spot = (-from_centre.length_squared() / 18.0).exp();
        let level = 120.0 * lamp * growth * spot + random.random_range(-3.5..3.5);
        *pixel = level.clamp(0.0, 255.0) as u8;
    }
    Picture {
        width: side,
        height: side,
        pixels,
    }
}

fn sensitivity(index: usize) -> DVec3 {
    let mut random = Pcg64::seed_from_u64(index as u64);
    DVec3::from_array([(); 3].map(|()| random.random_range(-0.05..0.05)))
}

/// Readings of all spots in an image.
pub fn read(chain: &mut SensingChain, picture: &Picture) -> Vec<ElementReading> {
    let mut readings = vec![ElementReading::default(); ELEMENTS];
    chain.sense(picture, &mut readings).expect("readings");
    readings
}

/// Creates a sample from an image's readings.
pub fn sample(
    readings: &[ElementReading],
    recording: usize,
    wrench: MeasuredWrench,
) -> WrenchSample {
    WrenchSample {
        recording,
        seen: readings.iter().map(usable).collect(),
        wrench,
    }
}

/// Creates `count` images under slowly varying forces, like those of rubbing: consecutive images are similar. Each
/// has a measured force with the noise of a good sensor, 0.01 N.
pub fn samples(count: usize, recording: usize, lamp: f64, seed: u64) -> Vec<WrenchSample> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut chain = chain();
    let phase = random.random_range(0.0..6.0);
    let samples = (0..count).map(|index| {
        let time = index as f64 * 0.3 + phase;
        let force = DVec3::new(
            1.5 * (0.7 * time).sin(),
            1.5 * (1.1 * time + 1.0).sin(),
            -1.5 + 1.5 * (0.31 * time).sin(),
        );
        let readings = read(&mut chain, &picture(force, lamp, &mut random));
        let [x, y, z] = force
            .to_array()
            .map(|f| Some(f + random.random_range(-0.01..0.01)));
        sample(
            &readings,
            recording,
            [x, y, z, None, None, None, None, None],
        )
    });
    samples.collect()
}
