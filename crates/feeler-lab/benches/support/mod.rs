//! Input of the benchmarks and examples of the moments kernel.

use feeler::sensor::fingertip::{DomeProjection, Fingertip, FingertipConfig, SensingElement};
use feeler::sensor::image::{Picture, WeightedPixel};
use feeler::sensor::moments::MomentsKernel;
use feeler_sim::optics::{OpticsConfig, OpticsModel, OpticsScratch, render};
use glam::{DVec2, DVec3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// The reference fingertip with `scale` times the resolution in each direction.
pub fn fingertip_config(scale: usize) -> FingertipConfig {
    let mut config = FingertipConfig::default();
    config.camera.width *= scale;
    config.camera.height *= scale;
    config.camera.focal_length_px *= scale as f64;
    config
}

/// An image of the simulated fingertip with five elements under 1 N and a little shear.
pub fn simulated_picture(config: &FingertipConfig, fingertip: &Fingertip) -> Picture {
    let model = OpticsModel::new(
        &OpticsConfig::default(),
        &fingertip.layout,
        &fingertip.projection,
    )
    .expect("the default optics fit the fingertip");
    let mut forces = vec![DVec3::ZERO; fingertip.layout.elements.len()];
    forces[..5].fill(DVec3::new(0.3, -0.2, 1.0));
    let mut picture = Picture::black(config.camera.width, config.camera.height);
    let mut scratch = OpticsScratch::new(&model);
    let mut rng = Pcg64::seed_from_u64(1);
    render(&model, &mut scratch, &forces, &mut rng, &mut picture).expect("sizes fit");
    picture
}

/// Upper left corners of squares of `side` px around the image positions of the elements' tips, shifted to lie within
/// the image.
pub fn squares(fingertip: &Fingertip, side: usize) -> Vec<(usize, usize)> {
    let projection = &fingertip.projection;
    let corner = |seen: f64, end: usize| {
        let first = (seen - side as f64 / 2.0).round().max(0.0) as usize;
        first.min(end - side)
    };
    let tips = (0..fingertip.layout.elements.len()).map(|index| fingertip.layout.tip(index));
    tips.map(|tip| {
        let seen = projection.project(tip).expect("the camera sees all tips");
        let column = corner(seen.x, projection.width());
        (column, corner(seen.y, projection.height()))
    })
    .collect()
}

/// Kernel of complete squares of `side` px, dewarped. They contain more than the pixels of an element, so squares
/// of neighbours overlap.
pub fn square_kernel(
    config: &FingertipConfig,
    fingertip: &Fingertip,
    side: usize,
) -> MomentsKernel {
    let regions: Vec<_> = squares(fingertip, side)
        .into_iter()
        .zip(&fingertip.layout.elements)
        .map(|(corner, element)| square(&fingertip.projection, element, corner, side))
        .collect();
    let size = (config.camera.width, config.camera.height);
    MomentsKernel::of_regions(size, &config.moments, &regions)
        .expect("squares are inside the picture")
}

fn square(
    projection: &DomeProjection,
    element: &SensingElement,
    (left, top): (usize, usize),
    side: usize,
) -> Vec<WeightedPixel> {
    (0..side * side)
        .map(|index| {
            let (column, row) = (left + index % side, top + index / side);
            let pixel = DVec2::new(column as f64, row as f64);
            let dewarped = projection.dewarp(pixel, element).expect("the dome is seen");
            WeightedPixel {
                column,
                row,
                area: dewarped.area,
                point: dewarped.point,
            }
        })
        .collect()
}
