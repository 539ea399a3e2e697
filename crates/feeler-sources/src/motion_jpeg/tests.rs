use super::*;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use proptest::prelude::*;

/// Columns and rows of the images of a GelSight Mini, px.
const MINI: (usize, usize) = (3280, 2464);

/// A colour image of a skin with dark markers, uneven lighting and some noise.
fn skin((width, height): (usize, usize)) -> Vec<u8> {
    let mut noise = 1_u32;
    let mut pixels = Vec::with_capacity(3 * width * height);
    for index in 0..width * height {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (x, y) = (index % width, index / width);
        let from = |place: usize| (place % 340) as i32 - 170;
        let dark = 90 * i32::from(from(x).pow(2) + from(y).pow(2) < 900);
        let light = [120 + 60 * x / width, 100 + 60 * y / height, 140];
        let pixel = |light: usize| light as i32 - dark + (noise >> 28) as i32 - 8;
        pixels.extend(light.map(|light| pixel(light).clamp(0, 255) as u8));
    }
    pixels
}

/// A frame of Motion JPEG.
fn jpeg_of((width, height): (usize, usize), pixels: &[u8], colour: ExtendedColorType) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 80)
        .write_image(pixels, width as u32, height as u32, colour)
        .expect("a JPEG file");
    bytes
}

fn decode(bytes: &[u8], wanted: (usize, usize)) -> Picture {
    let mut picture = Picture::black(0, 0);
    let fit = Fit::new(MINI, wanted).expect("a fit");
    let decoded = MotionJpeg::new(fit).decode(bytes, &mut picture);
    decoded.expect("a picture");
    assert_eq!((picture.width, picture.height), wanted);
    picture
}

#[test]
fn a_scaled_image_is_the_average_of_the_full_image() {
    let grey: Vec<u8> = skin(MINI).into_iter().step_by(3).collect();
    let bytes = jpeg_of(MINI, &grey, ExtendedColorType::L8);
    // Reference from another decoder.
    let whole = image::load_from_memory(&bytes)
        .expect("a picture")
        .into_luma8();
    for (denominator, mean_bound, bound) in [(8, 0.5, 1.0), (4, 1.0, 12.0), (2, 1.0, 24.0)] {
        let wanted = (MINI.0 / denominator, MINI.1 / denominator);
        let scaled = decode(&bytes, wanted);
        let (mut sum, mut largest) = (0.0_f64, 0.0_f64);
        for (index, &pixel) in scaled.pixels.iter().enumerate() {
            let (x, y) = (
                index % wanted.0 * denominator,
                index / wanted.0 * denominator,
            );
            let block = (0..denominator * denominator).map(|k| {
                let (x, y) = (x + k % denominator, y + k / denominator);
                f64::from(whole.as_raw()[y * MINI.0 + x])
            });
            let mean = block.sum::<f64>() / (denominator * denominator) as f64;
            let off = (mean - f64::from(pixel)).abs();
            (sum, largest) = (sum + off, largest.max(off));
        }
        // At 1/8 a pixel is the DC term of its block: its mean but for two roundings. Shorter transforms drop high
        // frequencies instead of averaging, which differs at the edges of markers (steps of 90 grey levels) but
        // hardly on average.
        let mean = sum / scaled.pixels.len() as f64;
        assert!(
            mean <= mean_bound && largest <= bound,
            "1/{denominator}: {mean} on average, {largest} at most"
        );
    }
}

#[test]
fn colours_become_their_luma_and_markers_stay_round() {
    let bytes = jpeg_of(MINI, &skin(MINI), ExtendedColorType::Rgb8);
    let picture = decode(&bytes, (640, 480));
    let dark: Vec<usize> = (0..640 * 480)
        .filter(|&index| {
            // Around the marker at column 1,870, row 1,190 of the camera's image.
            let (x, y): (usize, usize) = (index % 640, index / 640);
            x.abs_diff(365) < 20 && y.abs_diff(231) < 20 && picture.pixels[index] < 90
        })
        .collect();
    let side = |places: Vec<usize>| {
        let mean = places.iter().sum::<usize>() as f64 / places.len() as f64;
        let squares = places.iter().map(|&p| (p as f64 - mean).powi(2));
        (mean, (squares.sum::<f64>() / places.len() as f64).sqrt())
    };
    let (x, wide) = side(dark.iter().map(|index| index % 640).collect());
    let (y, high) = side(dark.iter().map(|index| index / 640).collect());
    // The standard deviation of a disc with a radius of 30 px is half the radius, at one scale of 5.125 (1/4, then
    // 820 of 820 columns and 615 of 616 rows). Pixels count as dark or not, which moves their mean by up to a fifth
    // of a pixel.
    let cell = 3280.0 / 640.0;
    let cut = (2464.0 - 480.0 * cell) / 2.0;
    assert!(
        (wide - high).abs() < 0.05 && (wide - 15.0 / cell).abs() < 0.15,
        "{wide} {high}"
    );
    assert!((x - (1870.5 / cell - 0.5)).abs() < 0.2, "{x}");
    assert!((y - ((1190.5 - cut) / cell - 0.5)).abs() < 0.2, "{y}");
}

#[test]
fn damaged_frames_and_other_sizes_are_refused() {
    let size = (64, 48);
    let colours = skin(size);
    let bytes = jpeg_of(size, &colours, ExtendedColorType::Rgb8);
    let refused = |offered, bytes: &[u8], words: &str| {
        let fit = Fit::new(offered, (32, 24)).expect("a fit");
        let mut picture = Picture::black(32, 24);
        let error = MotionJpeg::new(fit).decode(bytes, &mut picture);
        let error = error.expect_err("no picture").to_string();
        assert!(error.contains(words), "{error}");
        assert_eq!(picture, Picture::black(32, 24));
    };
    refused((128, 96), &bytes, "expected 128x96 px, got 64x48 px");
    refused(size, &bytes[..bytes.len() - 2], "truncated");
    refused(size, b"\xFF\xD8\xFF\xD9", "expected a JPEG image");
    refused(size, b"GREY", "no start mark");
    // The frame header of a progressive image.
    let start = bytes.windows(2).position(|pair| pair == [0xFF, 0xC0]);
    let mut progressive = bytes.clone();
    progressive[start.expect("a frame header") + 1] = 0xC2;
    refused(size, &progressive, "expected a sequential image");
    // Cameras pad their buffers after the image.
    let mut picture = Picture::black(0, 0);
    let fit = Fit::new(size, size).expect("a fit");
    let padded = [&bytes[..], &[0; 999]].concat();
    let decoded = MotionJpeg::new(fit).decode(&padded, &mut picture);
    decoded.expect("a picture");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_reused_decoder_gives_the_same_images_as_a_new_one(
        sizes in (16_usize..90, 16_usize..90),
        greys in prop::collection::vec(any::<u8>(), 1..40),
    ) {
        let wanted = (sizes.0.div_ceil(3), sizes.1.div_ceil(3));
        let Ok(fit) = Fit::new(sizes, wanted) else { return Ok(()) };
        let mut decoder = MotionJpeg::new(fit);
        for shift in 0..3 {
            let grey = |index: usize| greys[(index + shift) % greys.len()];
            let pixels: Vec<u8> = (0..sizes.0 * sizes.1).map(grey).collect();
            let bytes = jpeg_of(sizes, &pixels, ExtendedColorType::L8);
            let [mut kept, mut fresh] = [(); 2].map(|()| Picture::black(0, 0));
            // A damaged frame in between has no effect.
            let _ = decoder.decode(&bytes[..bytes.len() / 2], &mut kept);
            prop_assert!(decoder.decode(&bytes, &mut kept).is_ok());
            prop_assert!(MotionJpeg::new(fit).decode(&bytes, &mut fresh).is_ok());
            prop_assert_eq!(&kept, &fresh);
        }
    }
}
