//! Preview of located elements, drawn over the image.

use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::locate::{ReferencePicture, sub_regions};
use glam::DVec2;
use image::{Rgb, RgbImage};

const OUTLINE: Rgb<u8> = Rgb([0, 190, 90]);
const CENTRE: Rgb<u8> = Rgb([255, 60, 40]);
const INDEX: Rgb<u8> = Rgb([90, 170, 255]);

/// Maximum side of the preview (px), unless the image itself is larger.
const SIDE: usize = 2400;

/// Digits of 3 × 5 pixels; each octal digit is a row, from the top.
const DIGITS: [u32; 10] = [
    0o75557, 0o26227, 0o71747, 0o71717, 0o55711, 0o74717, 0o74757, 0o71111, 0o75757, 0o75717,
];

/// Returns the image with the outlines of the sub-regions, and the centres and indices of the elements. The image is
/// enlarged by an integer factor, so that the indices fit into the smallest sub-regions.
pub fn preview(reference: &ReferencePicture, layout: &LocatedLayout) -> RgbImage {
    let (width, height) = (reference.width, reference.height);
    let radii = layout.elements.iter().map(|e| e.radius_px);
    let smallest = radii.fold(f64::INFINITY, f64::min).max(1.0);
    let most = (SIDE / width.max(height)).max(1);
    let scale = ((20.0 / smallest).ceil() as usize).clamp(1, most);
    let mut drawn = RgbImage::from_fn((width * scale) as u32, (height * scale) as u32, |x, y| {
        let index = y as usize / scale * width + x as usize / scale;
        let gray = reference.gray.get(index).copied().unwrap_or(0.0) as u8;
        Rgb([gray; 3])
    });
    draw_outlines(&mut drawn, layout, scale);
    for (index, element) in layout.elements.iter().enumerate() {
        let at = (element.centre_px + 0.5) * scale as f64;
        for step in -3..=3 {
            put(&mut drawn, at, (step, 0), CENTRE);
            put(&mut drawn, at, (0, step), CENTRE);
        }
        write_number(&mut drawn, at + DVec2::new(3.0, 3.0), index);
    }
    drawn
}

/// Draws the border of each sub-region on the sub-region's own pixels.
fn draw_outlines(drawn: &mut RgbImage, layout: &LocatedLayout, scale: usize) {
    let (width, height) = (layout.width * scale, layout.height * scale);
    let discs: Vec<(DVec2, f64)> = layout
        .elements
        .iter()
        .map(|e| {
            (
                (e.centre_px + 0.5) * scale as f64 - 0.5,
                e.radius_px * scale as f64,
            )
        })
        .collect();
    // Computed at the preview's resolution, where outlines are smoother than the image's pixels.
    let mut owner = vec![usize::MAX; width * height];
    for (element, region) in sub_regions((width, height), &discs).iter().enumerate() {
        for &(column, row) in region {
            owner[row * width + column] = element;
        }
    }
    for row in 1..height.saturating_sub(1) {
        for column in 1..width.saturating_sub(1) {
            let index = row * width + column;
            let own = owner[index];
            let beside = [index - 1, index + 1, index - width, index + width];
            if own != usize::MAX && beside.iter().any(|&i| owner[i] != own) {
                drawn.put_pixel(column as u32, row as u32, OUTLINE);
            }
        }
    }
}

fn write_number(drawn: &mut RgbImage, at: DVec2, number: usize) {
    for (place, digit) in number.to_string().bytes().enumerate() {
        let rows = DIGITS[usize::from(digit - b'0') % DIGITS.len()];
        for bit in 0..15 {
            if rows >> (14 - bit) & 1 == 1 {
                let offset = (place as i32 * 4 + bit % 3, bit / 3);
                put(drawn, at, offset, INDEX);
            }
        }
    }
}

fn put(drawn: &mut RgbImage, at: DVec2, (dx, dy): (i32, i32), colour: Rgb<u8>) {
    let (x, y) = (at.x as i32 + dx, at.y as i32 + dy);
    if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y))
        && x < drawn.width()
        && y < drawn.height()
    {
        drawn.put_pixel(x, y, colour);
    }
}
