//! How long it takes from a picture to moments and to forces: medians over many frames.
//!
//! `cargo run --release --example moments_speed`

#[path = "../benches/support/mod.rs"]
mod support;

use feeler::sensor::{
    fingertip::Fingertip,
    frame::Picture,
    moments::{ElementMoments, Instructions, MomentsKernel},
};
use std::{hint::black_box, time::Instant};
use support::{fingertip_config, simulated_picture, square_kernel};

/// Frames that a median is taken over.
const FRAMES: usize = 20_001;

fn main() {
    for scale in [1, 2] {
        let config = fingertip_config(scale);
        let fingertip = Fingertip::new(&config).expect("the reference fingertip makes sense");
        let picture = simulated_picture(&config, &fingertip);
        let squares = square_kernel(&config, &fingertip, 60 * scale);
        for instructions in Instructions::available() {
            let own = fingertip.kernel.clone().with_instructions(instructions);
            let squares = squares.clone().with_instructions(instructions);
            println!(
                "{}x{} {instructions:?}: own sub-regions {:.2} us, squares of {} px {:.2} us",
                picture.width,
                picture.height,
                median(&own, &picture),
                60 * scale,
                median(&squares, &picture),
            );
        }
    }
}

/// Median time to take the moments of `picture`, us.
fn median(kernel: &MomentsKernel, picture: &Picture) -> f64 {
    let mut moments = vec![ElementMoments::default(); kernel.element_count()];
    let mut times: Vec<_> = (0..FRAMES)
        .map(|_| {
            let start = Instant::now();
            let result = kernel.measure(black_box(picture), black_box(&mut moments));
            let time = start.elapsed();
            result.expect("sizes fit");
            time.as_secs_f64() * 1e6
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[FRAMES / 2]
}
