//! Permitted number of saturated pixels of an element.

use feeler::sensor::image::{Picture, SATURATED, SaturationCheck, WeightedPixel};
use glam::DVec2;

#[test]
fn saturation_beyond_the_permitted_fraction_is_reported() {
    // Fractions that are exactly representable.
    for (max_saturated, part) in [(0.0, (0, 1)), (0.0625, (1, 16)), (0.25, (1, 4))] {
        for pixels in 1..=70 {
            let region = (0..pixels).map(|column| WeightedPixel {
                column,
                row: 0,
                area: 1.0,
                point: DVec2::ZERO,
            });
            let check = SaturationCheck::new(70, &[region.collect()], max_saturated);
            let mut picture = Picture::black(70, 1);
            for saturated in 0..=pixels {
                let (numerator, denominator) = part;
                let too_many = saturated * denominator > pixels * numerator;
                assert_eq!(
                    check.saturated(&picture, 0),
                    too_many,
                    "{saturated} of {pixels} saturated with a limit of {max_saturated}"
                );
                if saturated < pixels {
                    picture.pixels[saturated] = SATURATED;
                }
            }
        }
    }
}
