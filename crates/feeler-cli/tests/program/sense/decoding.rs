//! Decoding images from arbitrary bytes never panics, and never returns a partial image as a complete one.

use feeler_sources::decode_picture;
use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use proptest::prelude::*;
use std::io::Cursor;
use std::sync::LazyLock;

/// Number of files: three images in six formats.
const COUNT: usize = 18;

/// Small images in each format.
static FILES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let gray = GrayImage::from_fn(33, 17, |x, y| Luma([(x * 7 + y * 13) as u8]));
    let gray = DynamicImage::from(gray);
    let colour = DynamicImage::from(gray.to_rgb8());
    let wide = DynamicImage::from(gray.to_luma16());
    let formats = [
        ImageFormat::Png,
        ImageFormat::Jpeg,
        ImageFormat::Pnm,
        ImageFormat::Tiff,
        ImageFormat::Bmp,
        ImageFormat::WebP,
    ];
    let mut files = Vec::new();
    for format in formats {
        for picture in [&gray, &colour, &wide] {
            let mut file = Cursor::new(Vec::new());
            if picture.write_to(&mut file, format).is_ok() {
                files.push(file.into_inner());
            }
        }
    }
    assert_eq!(files.len(), COUNT);
    files
});

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400), file in 0..COUNT, keep in 0_usize..60) {
        // The bytes alone, and after the start of an image.
        let _ = decode_picture(&bytes);
        let head = &FILES[file];
        let _ = decode_picture(&[&head[..keep.min(head.len())], &bytes].concat());
    }

    #[test]
    fn damaged_bytes(
        file in 0..COUNT,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = FILES[file].clone();
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(picture) = decode_picture(&bytes) {
            prop_assert_eq!(picture.pixels.len(), picture.width * picture.height);
        }
    }

    #[test]
    fn truncated_file_is_an_error_or_complete(file in 0..COUNT, at in any::<prop::sample::Index>()) {
        let bytes = &FILES[file];
        let whole = decode_picture(bytes).expect("a picture");
        if let Ok(cut) = decode_picture(&bytes[..at.index(bytes.len())]) {
            prop_assert_eq!(cut, whole);
        }
    }
}

/// Decodes damaged Motion JPEG frames. `FEELER_FUZZ_JPEG` sets their number.
#[cfg(all(feature = "camera", target_os = "linux"))]
#[test]
fn damaged_motion_jpeg() {
    use feeler::sensor::image::Picture;
    use feeler_sources::{Fit, MotionJpeg};
    use rand::{RngExt, SeedableRng};
    let frames: Vec<&Vec<u8>> = FILES
        .iter()
        .filter(|f| f.starts_with(b"\xFF\xD8"))
        .collect();
    let mut random = rand_pcg::Pcg64::seed_from_u64(1);
    let mut decoders = [(33, 17), (16, 8), (4, 2)].map(|wanted| {
        let fit = Fit::new((33, 17), wanted).expect("a fit");
        (wanted, MotionJpeg::new(fit))
    });
    for _ in 0..crate::how_many::how_many("FEELER_FUZZ_JPEG", 5000) {
        let mut bytes = frames[random.random_range(0..frames.len())].clone();
        for _ in 0..random.random_range(0..6) {
            let at = random.random_range(0..bytes.len());
            bytes[at] = random.random();
        }
        let ((width, height), decoder) = &mut decoders[random.random_range(0..3)];
        let mut picture = Picture::black(*width, *height);
        let _ = decoder.decode(&bytes, &mut picture);
        assert_eq!(picture.pixels.len(), *width * *height);
    }
}
