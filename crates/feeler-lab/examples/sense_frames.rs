//! Time to sense a frame in a long sequence in memory, on one core, for comparison with `python/benches/sensing.py`.
//!
//! `cargo run --release --example sense_frames -- FRAMES.raw CALIBRATION.toml`: FRAMES.raw contains consecutive 8-bit
//! images of the calibration's fingertip. Prints the median time per frame (us) over several passes.

use feeler::sensor::calibration::Calibration;
use feeler::sensor::forces::{ElementReading, SensingChain};
use feeler::sensor::image::Picture;
use std::{error::Error, fs, hint::black_box, time::Instant};

const ROUNDS: usize = 11;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let (Some(frames), Some(calibration)) = (args.next(), args.next()) else {
        return Err("usage: sense_frames FRAMES.raw CALIBRATION.toml".into());
    };
    let frames = fs::read(frames)?;
    let calibration = Calibration::from_toml(&fs::read_to_string(calibration)?)?;
    let fingertip = calibration.made_for.fingertip.clone();
    let fingertip = fingertip.ok_or("expected a calibration of a fingertip")?;
    let mut chain = SensingChain::of_fingertip(&fingertip)?.with_calibration(calibration)?;

    let (width, height) = chain.picture_size();
    let mut readings = vec![ElementReading::default(); chain.element_count()];
    let mut times = Vec::with_capacity(ROUNDS);
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let mut rest = &frames[..];
        while let Some((pixels, next)) = rest.split_at_checked(width * height) {
            let picture = Picture {
                width,
                height,
                pixels,
            };
            chain.sense_with_prefetch(&picture, next, black_box(&mut readings))?;
            rest = next;
        }
        let count = frames.len() / (width * height);
        times.push(1e6 * start.elapsed().as_secs_f64() / count as f64);
    }
    times.sort_by(f64::total_cmp);
    println!("{:.2}", times[ROUNDS / 2]);
    Ok(())
}
