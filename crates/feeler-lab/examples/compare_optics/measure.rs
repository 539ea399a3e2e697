//! Measurements on the image of a simulated or real fingertip.

use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, Located, Polarity, ReferencePicture, locate};
use feeler::sensor::moments::ElementMoments;
use feeler_report::measures::percentile;
use glam::{DVec2, DVec3};
use nalgebra::{DMatrix, DVector};
use std::error::Error;
use std::f64::consts::TAU;

/// Length of a section of background for measuring the noise (px). The spectrum has half as many frequencies.
pub const STRETCH: usize = 16;

/// An image, and the force on the whole fingertip (N): two shear components and the component along its axis.
pub struct Loaded {
    pub picture: Picture,
    pub force: DVec3,
}

/// Properties of an image.
pub struct Look {
    pub picture: Picture,
    pub polarity: Polarity,
    pub markers: usize,
    /// Diameter (px).
    pub spot_diameter: f64,
    /// Distance between neighbours (px).
    pub spacing: f64,
    /// Median difference between the grey levels of markers and of the background around them.
    pub contrast: f64,
    /// Interquartile range of the contrasts, relative to the median.
    pub spread_of_contrasts: f64,
    /// Standard deviation of the background noise (grey levels).
    pub noise: f64,
    /// Fraction of the noise power at each frequency, from 1 / [`STRETCH`] to 1/2 per pixel. Empty without noise.
    pub spectrum: Vec<f64>,
    /// Relative change of an element's integrated gray value per newton of compression, regardless of sign.
    pub growth_per_newton: Option<f64>,
    /// Displacement of an element per newton of shear, in spacings.
    pub displacement_per_newton: Option<f64>,
}

impl Look {
    pub fn new(picture: Picture, loaded: &[Loaded]) -> Result<Self, Box<dyn Error>> {
        let reference = ReferencePicture::mean([&picture])?;
        let located = locate(&reference, &LocateConfig::default())?;
        let spots: Vec<DVec2> = located
            .elements
            .iter()
            .flat_map(|element| element.spots_px.iter().copied())
            .collect();
        let radius = 0.5 * located.spot_area_diameter_px;
        let [low, contrast, high] = quartiles(
            spots
                .iter()
                .filter_map(|&spot| contrast(&picture, spot, radius)),
        );
        let spacing = nearest(&spots);
        let (noise, spectrum) = noise(&picture, &spots, radius);
        let (growth, displacement) = response(&located, &picture, loaded)?.unzip();
        Ok(Self {
            polarity: located.polarity,
            markers: spots.len(),
            spot_diameter: 2.0 * radius,
            spacing,
            contrast,
            spread_of_contrasts: (high - low) / contrast.abs(),
            noise,
            spectrum,
            growth_per_newton: growth,
            displacement_per_newton: displacement.map(|px| px / spacing),
            picture,
        })
    }
}

/// Median distance from a spot to its nearest neighbour (px).
fn nearest(spots: &[DVec2]) -> f64 {
    let distances = spots.iter().map(|&spot| {
        let others = spots.iter().filter(|&&other| other != spot);
        others
            .map(|&other| spot.distance(other))
            .fold(f64::INFINITY, f64::min)
    });
    quartiles(distances)[1]
}

fn quartiles(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let values: Vec<f64> = values.collect();
    [25.0, 50.0, 75.0].map(|part| percentile(values.iter().copied(), part).unwrap_or(f64::NAN))
}

/// Mean grey level on a circle of 0.4 spot radii minus that on a circle of 1.5 radii. `None` if a circle leaves the
/// image.
fn contrast(picture: &Picture, spot: DVec2, radius: f64) -> Option<f64> {
    let around = |at: f64| {
        let on_circle = (0..16).map(|k| {
            gray(
                picture,
                spot + at * DVec2::from_angle(TAU * f64::from(k) / 16.0),
            )
        });
        let levels: Option<Vec<f64>> = on_circle.collect();
        levels.map(|levels| levels.iter().sum::<f64>() / 16.0)
    };
    Some(around(0.4 * radius)? - around(1.5 * radius)?)
}

fn gray(picture: &Picture, at: DVec2) -> Option<f64> {
    let (column, row) = (at.x.round(), at.y.round());
    let inside = column >= 0.0 && row >= 0.0 && column < picture.width as f64;
    let index = inside.then_some(row as usize * picture.width + column as usize)?;
    picture.pixels.get(index).map(|&level| f64::from(level))
}

/// Standard deviation and relative spectrum of the background noise, from sections of rows without spots, after
/// removal of mean and slope.
fn noise(picture: &Picture, spots: &[DVec2], radius: f64) -> (f64, Vec<f64>) {
    let mut power = [0.0; STRETCH / 2];
    let mut stretches = 0.0;
    for row in 0..picture.height {
        for start in (0..picture.width.saturating_sub(STRETCH)).step_by(STRETCH) {
            let clear = |spot: &DVec2| {
                let across =
                    (spot.x - (start as f64 + STRETCH as f64 / 2.0)).abs() - STRETCH as f64 / 2.0;
                DVec2::new(across.max(0.0), spot.y - row as f64).length() > 2.0 * radius
            };
            if !spots.iter().all(clear) {
                continue;
            }
            let own = &picture.pixels[row * picture.width + start..][..STRETCH];
            for (power, own) in power.iter_mut().zip(periodogram(own)) {
                *power += own;
            }
            stretches += 1.0;
        }
    }
    let all: f64 = power.iter().sum();
    match all > 0.0 {
        true => (
            (all / stretches).sqrt(),
            power.iter().map(|own| own / all).collect(),
        ),
        false => (0.0, Vec::new()),
    }
}

/// Power at each frequency above 0 of the gray values after removal of mean and slope. The sum is the variance.
fn periodogram(levels: &[u8]) -> impl Iterator<Item = f64> + use<> {
    let n = levels.len() as f64;
    let place = |k: usize| k as f64 - (n - 1.0) / 2.0;
    let mean = levels.iter().map(|&level| f64::from(level)).sum::<f64>() / n;
    let along: f64 = (0..levels.len()).map(|k| place(k).powi(2)).sum();
    let slope = levels
        .iter()
        .enumerate()
        .map(|(k, &level)| place(k) * f64::from(level))
        .sum::<f64>()
        / along;
    let rest: Vec<f64> = levels
        .iter()
        .enumerate()
        .map(|(k, &level)| f64::from(level) - mean - slope * place(k))
        .collect();
    (1..=rest.len() / 2).map(move |frequency| {
        let turn = |k: usize| DVec2::from_angle(TAU * (frequency * k) as f64 / n);
        let sum = rest
            .iter()
            .enumerate()
            .fold(DVec2::ZERO, |sum, (k, &level)| sum + level * turn(k));
        let twice = if 2 * frequency == rest.len() {
            1.0
        } else {
            2.0
        };
        twice * sum.length_squared() / (n * n)
    })
}

/// Relative change of brightness per newton of compression, and displacement per newton of shear (px): root mean
/// square over all elements of the coefficients of a linear regression over all images. `None` if there are fewer than
/// 10 images.
fn response(
    located: &Located,
    untouched: &Picture,
    loaded: &[Loaded],
) -> Result<Option<(f64, f64)>, Box<dyn Error>> {
    if loaded.len() < 10 {
        return Ok(None);
    }
    let kernel = LocatedLayout::new(located).kernel()?;
    let measure = |picture: &Picture| -> Result<Vec<ElementMoments>, Box<dyn Error>> {
        let mut moments = vec![ElementMoments::default(); kernel.element_count()];
        kernel.measure(picture, &mut moments)?;
        Ok(moments)
    };
    let before = measure(untouched)?;
    let after = loaded.iter().map(|loaded| measure(&loaded.picture));
    let after: Vec<_> = after.collect::<Result<_, _>>()?;
    let forces = DMatrix::from_fn(loaded.len(), 4, |row, column| match column {
        3 => 1.0,
        axis => loaded[row].force[axis],
    });
    let forces = forces.svd(true, true);
    let slope = |changes: DVector<f64>| {
        let fit = forces.solve(&changes, 1e-12)?;
        Ok::<_, &str>(DVec3::new(fit[0], fit[1], fit[2]))
    };
    let (mut growth, mut displacement) = (0.0, 0.0);
    for (element, before) in before.iter().enumerate() {
        let change = |of: &dyn Fn(&ElementMoments) -> f64| {
            DVector::from_fn(after.len(), |row, _| of(&after[row][element]))
        };
        let grown = slope(change(&|now| {
            now.integrated_gray / before.integrated_gray - 1.0
        }))?;
        growth += grown.z.powi(2);
        for axis in 0..2 {
            let moved = slope(change(&|now| (now.centroid - before.centroid)[axis]))?;
            // The direction of the displacement depends on the mounting of the camera, so average over both directions.
            displacement += 0.5 * moved.truncate().length_squared();
        }
    }
    let mean = |sum: f64| (sum / before.len() as f64).sqrt();
    Ok(Some((mean(growth), mean(displacement))))
}
