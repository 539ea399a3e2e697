use super::*;
use proptest::prelude::*;

#[test]
fn a_gelsight_mini_fits_pictures_of_common_sizes() {
    let fit = |wanted| Fit::new((3280, 2464), wanted).expect("a fit");
    assert_eq!(fit((320, 240)).denominator(), 8);
    assert_eq!(fit((410, 308)).denominator(), 8);
    assert_eq!(fit((640, 480)).denominator(), 4);
    assert_eq!(fit((1280, 960)).denominator(), 2);
    assert_eq!(fit((3280, 2464)).denominator(), 1);
    assert!(fit((3280, 2464)).is_exact());
    assert_eq!(fit((320, 240)).scaled(8), (410, 308));
}

#[test]
fn enlarging_and_excessive_cropping_are_refused() {
    let refused = |offered, wanted, words: &str| {
        let error = Fit::new(offered, wanted).expect_err("no fit").to_string();
        assert!(error.contains(words), "{error}");
    };
    refused(
        (320, 240),
        (640, 480),
        "320x240 px are too few for images of 640x480 px",
    );
    refused((640, 470), (640, 480), "too few");
    refused(
        (1920, 1080),
        (640, 480),
        "1920x1080 px would lose 25 % of their columns to become 640x480 px; expected at most 10 %",
    );
    refused((1000, 2000), (100, 100), "lose 50 % of their rows");
    refused((640, 480), (0, 480), "too few");
}

/// Area averages by dense sampling. No sample lies on the edge of a pixel, and each pixel gets its exact share.
fn sampled(fit: &Fit, source: &[u8]) -> Vec<f64> {
    let (width, height) = fit.wanted;
    // The side that is not cropped has this many pixels per output pixel, as a fraction; the crop is a multiple of
    // half of it.
    let columns_limit = fit.offered.0 * height <= fit.offered.1 * width;
    let samples = 2 * if columns_limit {
        fit.offered.0
    } else {
        fit.offered.1
    };
    let begin = |offered: usize, wanted: usize| (offered as f64 - fit.cell * wanted as f64) / 2.0;
    let (left, top) = (begin(fit.offered.0, width), begin(fit.offered.1, height));
    let place = |start: f64, pixel: usize, sample: usize| {
        (start + fit.cell * (pixel as f64 + (sample as f64 + 0.5) / samples as f64)) as usize
    };
    let mut averages = Vec::new();
    for pixel in 0..width * height {
        let mut sum = 0.0;
        for sample in 0..samples * samples {
            let x = place(left, pixel % width, sample % samples);
            let y = place(top, pixel / width, sample / samples);
            sum += f64::from(source[y * fit.offered.0 + x]);
        }
        averages.push(sum / (samples * samples) as f64);
    }
    averages
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn area_averages_equal_dense_sampling(
        wanted in (1_usize..8, 1_usize..8),
        more in (0_usize..30, 0_usize..30),
        seed in any::<u32>(),
    ) {
        let offered = (wanted.0 + more.0, wanted.1 + more.1);
        let Ok(fit) = Fit::new(offered, wanted) else { return Ok(()) };
        let pixel = |index: usize| ((index as u32 ^ seed).wrapping_mul(2_654_435_761) >> 24) as u8;
        let source: Vec<u8> = (0..offered.0 * offered.1).map(pixel).collect();
        let mut pixels = vec![0; wanted.0 * wanted.1];
        AreaAverage::new(&fit, 1).average(&source, offered.0, &mut pixels);
        // Half a grey level of rounding, and the single-precision error in a sum of 37 x 37 products.
        let bound = 0.5 + 1e-2;
        for (pixel, sampled) in pixels.iter().zip(sampled(&fit, &source)) {
            prop_assert!((f64::from(*pixel) - sampled).abs() <= bound, "{} of {}", pixel, sampled);
        }
    }

    #[test]
    fn a_uniform_image_stays_uniform_and_a_ramp_monotonic(
        wanted in (2_usize..60, 2_usize..60),
        scale in 1.0..9.0_f64,
        grey in any::<u8>(),
    ) {
        let offered = ((wanted.0 as f64 * scale) as usize, (wanted.1 as f64 * scale) as usize);
        let Ok(fit) = Fit::new(offered, wanted) else { return Ok(()) };
        let denominator = fit.denominator();
        let (columns, rows) = fit.scaled(denominator);
        prop_assert!(columns >= wanted.0 && rows >= wanted.1);
        let mut average = AreaAverage::new(&fit, denominator);
        let mut pixels = vec![0; wanted.0 * wanted.1];
        average.average(&vec![grey; columns * rows], columns, &mut pixels);
        prop_assert!(pixels.iter().all(|&pixel| pixel == grey));
        let ramp: Vec<u8> = (0..columns * rows).map(|i| (i % columns * 255 / columns) as u8).collect();
        average.average(&ramp, columns, &mut pixels);
        for row in pixels.chunks(wanted.0) {
            prop_assert!(row.is_sorted());
            // Single precision may round the same value to a different grey level in another row.
            prop_assert!(row.iter().zip(&pixels).all(|(a, b)| a.abs_diff(*b) <= 1));
        }
    }

    #[test]
    fn columns_and_rows_have_one_scale(
        offered in (1_usize..4000, 1_usize..4000),
        wanted in (1_usize..2000, 1_usize..2000),
    ) {
        if let Ok(fit) = Fit::new(offered, wanted) {
            // The kept area lies within the image and touches two of its edges.
            let kept = (fit.cell * wanted.0 as f64, fit.cell * wanted.1 as f64);
            let over = [kept.0 - offered.0 as f64, kept.1 - offered.1 as f64];
            prop_assert!(over.iter().all(|&over| over < 1e-6));
            prop_assert!(over.iter().any(|&over| over > -1e-6));
            prop_assert!(over[0] >= -(MAX_CROP + 1e-9) * offered.0 as f64);
            prop_assert!(over[1] >= -(MAX_CROP + 1e-9) * offered.1 as f64);
        }
    }
}
