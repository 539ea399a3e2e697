//! Images that are stored rotated or mirrored, with an EXIF orientation.

use feeler_sources::decode_picture;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

/// Columns and rows as stored, px.
const STORED: (usize, usize) = (3, 2);
/// Gray values as stored, row by row.
const PIXELS: [u8; 6] = [10, 20, 30, 40, 50, 60];

/// Sides on which the first stored row and the first stored column are displayed, for orientations 1 to 8 (Exif 3.0,
/// 4.6.6.1).
const SIDES: [(&str, &str); 8] = [
    ("top", "left"),
    ("top", "right"),
    ("bottom", "right"),
    ("bottom", "left"),
    ("left", "top"),
    ("right", "top"),
    ("right", "bottom"),
    ("left", "bottom"),
];

/// A PNG file with an EXIF block that contains only an orientation.
fn file(orientation: u8) -> Vec<u8> {
    let mut exif = b"II*\0\x08\0\0\0\x01\0".to_vec();
    exif.extend([0x12, 0x01, 3, 0, 1, 0, 0, 0, orientation, 0, 0, 0]);
    exif.extend([0; 4]);
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    encoder.set_exif_metadata(exif).expect("PNG has EXIF");
    let (width, height) = (STORED.0 as u32, STORED.1 as u32);
    encoder
        .write_image(&PIXELS, width, height, ExtendedColorType::L8)
        .expect("a file");
    bytes
}

#[test]
fn images_are_decoded_in_display_orientation() {
    let (columns, rows) = STORED;
    for (index, (first_row, first_column)) in SIDES.into_iter().enumerate() {
        let picture = decode_picture(&file(index as u8 + 1)).expect("an image");
        let turned = first_row == "left" || first_row == "right";
        let (width, height) = if turned {
            (rows, columns)
        } else {
            (columns, rows)
        };
        assert_eq!((picture.width, picture.height), (width, height), "{index}");
        for (at, stored) in PIXELS.into_iter().enumerate() {
            let (mut x, mut y) = (0, 0);
            let sides = [(first_row, at / columns), (first_column, at % columns)];
            for (side, from_it) in sides {
                match side {
                    "top" => y = from_it,
                    "bottom" => y = height - 1 - from_it,
                    "left" => x = from_it,
                    _ => x = width - 1 - from_it,
                }
            }
            assert_eq!(picture.pixels[y * width + x], stored, "{index}");
        }
    }
}

#[test]
fn an_invalid_orientation_is_ignored() {
    for orientation in [0, 9, 255] {
        let picture = decode_picture(&file(orientation)).expect("an image");
        assert_eq!(picture.pixels, PIXELS, "{orientation}");
    }
}
