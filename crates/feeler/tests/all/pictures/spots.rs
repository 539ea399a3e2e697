//! Images of round, smooth spots.

use feeler::sensor::image::Picture;
use feeler::sensor::locate::{
    LocateConfig, LocateError, LocateWarning, Located, ReferencePicture, locate,
};
use glam::DVec2;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

/// Gray value of the background.
pub const BACKGROUND: f64 = 20.0;

/// Gaussian spots: centre (px), standard deviation (px) and height (grey levels).
pub struct Spots(pub Vec<(DVec2, f64, f64)>);

impl Spots {
    /// Creates spots of equal size and height.
    pub fn alike(centres: &[DVec2], sigma: f64) -> Self {
        Self(centres.iter().map(|&c| (c, sigma, 120.0)).collect())
    }

    /// Image of the spots, with noise of one grey level.
    pub fn picture(&self, (width, height): (usize, usize)) -> Picture {
        let mut gray = vec![BACKGROUND; width * height];
        for &(centre, sigma, contrast) in &self.0 {
            let reach = 5.0 * sigma;
            let range = |at: f64, end: usize| {
                (at - reach).max(0.0) as usize..((at + reach).max(0.0) as usize).min(end)
            };
            for row in range(centre.y, height) {
                for column in range(centre.x, width) {
                    let off = DVec2::new(column as f64, row as f64).distance_squared(centre);
                    gray[row * width + column] += contrast * (-0.5 * off / (sigma * sigma)).exp();
                }
            }
        }
        let mut rng = Pcg64::seed_from_u64(1);
        let noise = Normal::new(0.0, 1.0).expect("a distribution");
        let mut picture = Picture::black(width, height);
        for (pixel, gray) in picture.pixels.iter_mut().zip(gray) {
            *pixel = (gray + noise.sample(&mut rng)).round().clamp(0.0, 255.0) as u8;
        }
        picture
    }
}

pub fn found(picture: &Picture, config: &LocateConfig) -> Result<Located, LocateError> {
    locate(&ReferencePicture::mean([picture])?, config)
}

/// Places on a square grid of `columns` and `rows`, starting at `first`.
pub fn grid(first: DVec2, spacing: f64, columns: usize, rows: usize) -> Vec<DVec2> {
    let place = |n: usize| first + spacing * DVec2::new((n % columns) as f64, (n / columns) as f64);
    (0..columns * rows).map(place).collect()
}

const FIRST: DVec2 = DVec2::new(22.3, 19.6);
const SIZE: (usize, usize) = (145, 120);

fn pins() -> Vec<DVec2> {
    grid(FIRST, 20.0, 6, 5)
}

fn plain() -> LocateConfig {
    LocateConfig::default()
}

fn left_out(located: &Located) -> Vec<DVec2> {
    let of = |warning: &LocateWarning| match warning {
        LocateWarning::LeftOut { spots_px } => spots_px.clone(),
        _ => Vec::new(),
    };
    located.warnings.iter().flat_map(of).collect()
}

#[test]
fn pins_are_found_in_reading_order_with_touching_discs() {
    for sigma in [2.0, 3.0] {
        let located = found(&Spots::alike(&pins(), sigma).picture(SIZE), &plain()).expect("pins");
        assert_eq!(located.size, SIZE);
        assert_eq!((located.elements.len(), located.spots_per_element), (30, 1));
        assert_eq!(located.warnings, []);
        for (element, pin) in located.elements.iter().zip(pins()) {
            assert!(
                element.centre_px.distance(pin) < 0.1,
                "{} {pin}",
                element.centre_px
            );
            assert_eq!(element.spots_px, [element.centre_px]);
            assert!(
                (element.radius_px - 10.0).abs() < 0.15,
                "{}",
                element.radius_px
            );
        }
        assert!(
            (located.spacing_px - 20.0).abs() < 0.15,
            "{}",
            located.spacing_px
        );
        // The response to a Gaussian is largest at its own scale; layers differ by a factor of 1.19.
        let diameter = 2.0 * std::f64::consts::SQRT_2 * sigma;
        let ratio = located.spot_diameter_px / diameter;
        assert!((0.84..1.19).contains(&ratio), "{ratio}");
        // Four standard deviations of the noise above the background; the spots' flanks add a little.
        let dark = f64::from(located.dark_level) - BACKGROUND;
        assert!((3.0..=9.0).contains(&dark), "{dark}");
    }
}

#[test]
fn the_radius_of_sub_regions_is_configurable() {
    let config = LocateConfig {
        region_radius: 0.8,
        ..plain()
    };
    let located = found(&Spots::alike(&pins(), 2.0).picture(SIZE), &config).expect("pins");
    assert!((located.elements[7].radius_px - 16.0).abs() < 0.25);
}

/// Many small spots are stronger together than a few large ones unless the large diameter is configured.
#[test]
fn the_size_of_spots_is_configurable() {
    let mut spots = Spots::alike(&pins(), 1.5);
    for place in grid(FIRST + DVec2::splat(140.0), 45.0, 4, 4) {
        spots.0.push((place, 9.0, 120.0));
    }
    let config = LocateConfig {
        spot_diameter_px: Some(25.0),
        ..plain()
    };
    let located = found(&spots.picture((330, 330)), &config).expect("spots");
    assert_eq!(located.elements.len(), 16);
    let ratio = located.spot_diameter_px / (2.0 * std::f64::consts::SQRT_2 * 9.0);
    assert!((0.84..1.19).contains(&ratio), "{ratio}");
}

#[test]
fn faint_specks_and_specks_next_to_a_pin_are_ignored() {
    let mut spots = Spots::alike(&pins(), 2.0);
    // A tenth as bright, between four pins, and half as bright, at a third of the spacing from a pin.
    spots.0.push((pins()[7] + DVec2::splat(10.0), 2.0, 12.0));
    spots.0.push((pins()[14] + DVec2::new(7.5, 0.0), 1.5, 60.0));
    let located = found(&spots.picture(SIZE), &plain()).expect("pins");
    assert_eq!(located.elements.len(), 30);
    for (element, pin) in located.elements.iter().zip(pins()) {
        assert!(element.centre_px.distance(pin) < 0.5, "{pin}");
    }
}

#[test]
fn isolated_spots_are_left_out_with_a_warning() {
    let mut spots = Spots::alike(&pins(), 2.0);
    let stray = DVec2::new(190.0, 60.0);
    spots.0.push((stray, 2.0, 120.0));
    let located = found(&spots.picture((220, 120)), &plain()).expect("pins");
    assert_eq!(located.elements.len(), 30);
    let left_out = left_out(&located);
    assert_eq!(left_out.len(), 1);
    assert!(left_out[0].distance(stray) < 0.1, "{left_out:?}");
    // With fewer than twenty spots, none is left out.
    let few = grid(FIRST, 20.0, 4, 4);
    let mut spots = Spots::alike(&few, 2.0);
    spots.0.push((stray, 2.0, 120.0));
    let located = found(&spots.picture((220, 120)), &plain()).expect("pins");
    assert_eq!(located.elements.len(), 17);
}

/// On a dense lattice, a spot at the rim with few neighbours and another size is a reflection.
#[test]
fn reflections_at_the_rim_of_a_lattice_are_left_out() {
    let row = |r: usize| {
        let shift = 10.0 * (r % 2) as f64;
        grid(FIRST + DVec2::new(shift, 17.32 * r as f64), 20.0, 8, 1)
    };
    let pins: Vec<DVec2> = (0..8).flat_map(row).collect();
    let reflection = FIRST + DVec2::new(70.0, -17.32 + 155.9);
    for (sigma, contrast, elements) in [(2.0, 120.0, 65), (2.0, 60.0, 64), (3.2, 120.0, 64)] {
        let mut spots = Spots::alike(&pins, 2.0);
        spots
            .0
            .push((reflection + DVec2::new(0.0, 8.0), sigma, contrast));
        let located = found(&spots.picture((210, 190)), &plain()).expect("pins");
        assert_eq!(located.elements.len(), elements, "{sigma} px, {contrast}");
        assert_eq!(left_out(&located).len(), 65 - elements);
    }
}

#[test]
fn lines_and_broad_light_are_not_spots() {
    let mut picture = Spots::alike(&pins(), 2.0).picture((145, 190));
    // A bright bar three pixels wide, and a disc of 40 px with a spot on it.
    for column in 10..135 {
        for row in 128..131 {
            picture.pixels[row * 145 + column] = 200;
        }
    }
    for row in 140..186 {
        for column in 50..96 {
            let place = DVec2::new(column as f64 - 72.0, row as f64 - 163.0);
            if place.length() < 20.0 {
                let bump = 30.0 * (-0.5 * place.length_squared() / 4.0).exp();
                picture.pixels[row * 145 + column] = (150.0 + bump) as u8;
            }
        }
    }
    let located = found(&picture, &plain()).expect("pins");
    assert_eq!(located.elements.len(), 30);
}

#[test]
fn discs_beyond_the_image_are_reported_as_cut_off() {
    let beyond = |first: DVec2, size: (usize, usize)| {
        let pins = grid(first, 20.0, 6, 5);
        let located = found(&Spots::alike(&pins, 2.0).picture(size), &plain()).expect("pins");
        let cut = located.warnings.iter().find_map(|w| match w {
            LocateWarning::CutOff { elements } => Some(elements.clone()),
            _ => None,
        });
        cut.unwrap_or_default()
    };
    // A radius of ten pixels around the outermost centres, offset by half a pixel.
    assert_eq!(beyond(DVec2::new(10.5, 10.5), (122, 102)), [0; 0]);
    assert_eq!(
        beyond(DVec2::new(8.5, 10.5), (120, 102)),
        [0, 6, 12, 18, 24]
    );
    assert_eq!(
        beyond(DVec2::new(10.5, 8.5), (122, 100)),
        [0, 1, 2, 3, 4, 5]
    );
    assert_eq!(
        beyond(DVec2::new(10.5, 10.5), (119, 102)),
        [5, 11, 17, 23, 29]
    );
    assert_eq!(
        beyond(DVec2::new(10.5, 10.5), (122, 99)),
        [24, 25, 26, 27, 28, 29]
    );
}

#[test]
fn black_and_white_images_are_thresholded_in_the_middle_with_a_warning() {
    let mut picture = Spots::alike(&pins(), 3.0).picture(SIZE);
    for pixel in &mut picture.pixels {
        *pixel = if *pixel > 80 { 255 } else { 0 };
    }
    let located = found(&picture, &plain()).expect("pins");
    assert_eq!(located.elements.len(), 30);
    assert_eq!(located.dark_level, 127);
    assert_eq!(located.warnings, [LocateWarning::TwoLevels]);
    picture.pixels[0] = 1;
    let located = found(&picture, &plain()).expect("pins");
    assert!(!located.warnings.contains(&LocateWarning::TwoLevels));
}

/// In some pins all pixels are saturated; in others, only the middle is.
#[test]
fn saturated_pins_are_named() {
    let mut spots = Spots::alike(&pins(), 2.5);
    for pin in [3, 17] {
        spots.0[pin].2 = 1500.0;
        spots.0[pin].1 = 2.0;
    }
    let located = found(&spots.picture(SIZE), &plain()).expect("pins");
    let saturated = located.warnings.iter().find_map(|w| match w {
        LocateWarning::Saturated { elements } => Some(elements.clone()),
        _ => None,
    });
    assert_eq!(saturated, Some(vec![3, 17]));
}

#[test]
fn too_many_spots_are_rejected_as_texture() {
    let many = grid(DVec2::splat(8.2), 7.0, 66, 66);
    let picture = Spots::alike(&many, 1.2).picture((480, 480));
    let error = found(&picture, &plain()).expect_err("refused");
    assert!(
        matches!(error, LocateError::TooManySpots { actual } if actual > 4096),
        "{error}"
    );
}

#[test]
fn an_image_without_spots_is_described_in_the_error() {
    let error = found(&Spots(Vec::new()).picture(SIZE), &plain()).expect_err("refused");
    let LocateError::NoElement {
        darkest,
        brightest,
        noise,
    } = error
    else {
        panic!("{error}")
    };
    // Noise of one level in 17,400 pixels: four standard deviations in either direction.
    assert!((15.0..=17.0).contains(&darkest) && (23.0..=25.0).contains(&brightest));
    // Whole grey levels quantize the estimate in steps of 0.66.
    assert!((noise - 1.0).abs() < 0.66, "{noise}");
}
