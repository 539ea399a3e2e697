//! Decoding of one Motion JPEG frame of 3280x2464 px, the format of a GelSight Mini.

use feeler::sensor::image::Picture;
use feeler_sources::{Fit, MotionJpeg, decode_picture};
use image::codecs::jpeg::JpegEncoder;
use std::hint::black_box;

fn main() {
    divan::main();
}

const SIZE: (usize, usize) = (3280, 2464);

/// A skin with dark markers, uneven lighting and some noise: about 0.8 MB.
fn frame() -> Vec<u8> {
    let mut noise = 1_u32;
    let image = image::RgbImage::from_fn(SIZE.0 as u32, SIZE.1 as u32, |x, y| {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let from = |place: u32| (place % 340) as i32 - 170;
        let dark = 90 * i32::from(from(x).pow(2) + from(y).pow(2) < 900);
        let light = [120 + 60 * x / 3280, 100 + 60 * y / 2464, 140];
        let pixel = |light: u32| light as i32 - dark + (noise >> 28) as i32 - 8;
        image::Rgb(light.map(|light| pixel(light).clamp(0, 255) as u8))
    });
    let mut bytes = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut bytes, 80);
    image.write_with_encoder(encoder).expect("a JPEG file");
    bytes
}

/// Grey at 1/8, 1/4, 1/2 and full size, and at sizes in between.
#[divan::bench(args = [(410, 308), (320, 240), (820, 616), (640, 480), (1640, 1232), SIZE])]
fn grey(bencher: divan::Bencher, wanted: (usize, usize)) {
    let bytes = frame();
    let mut decoder = MotionJpeg::new(Fit::new(SIZE, wanted).expect("a fit"));
    let mut picture = Picture::black(wanted.0, wanted.1);
    bencher.bench_local(|| {
        let decoded = decoder.decode(black_box(&bytes), &mut picture);
        decoded.expect("a picture");
    });
}

/// Colour at 1/8 and full size, with the same library.
#[divan::bench(args = [8, 1])]
fn colour(bencher: divan::Bencher, denominator: u16) {
    let bytes = frame();
    bencher.bench_local(|| {
        let mut decoder = rusty_jpeg::decode::Decoder::new(black_box(&bytes[..]));
        decoder.set_single_threaded(true);
        let (width, height) = (SIZE.0 as u16 / denominator, SIZE.1 as u16 / denominator);
        decoder.scale(width, height).expect("a scale");
        decoder.decode().expect("a picture")
    });
}

/// Decoding as an image file: colour at full size, then grey.
#[divan::bench]
fn as_a_picture_file(bencher: divan::Bencher) {
    let bytes = frame();
    bencher.bench_local(|| decode_picture(black_box(&bytes)).expect("a picture"));
}
