//! A soft tip pressed on a plate, sheared until it slips, and twisted: feeler's side of `benches/peers/soft_tip`.
//!
//! Reads the motions from `benches/peers/soft_tip/scene.py --motions`, one JSON object per line, and prints the recorded
//! runs as JSON.
//!
//! ```text
//! python3 benches/peers/soft_tip/scene.py --motions | cargo run --release --example soft_tip -- dense > feeler.json
//! ```

#[path = "../../feeler-sim/tests/support/experiment_file.rs"]
mod experiment_file;
#[path = "../../feeler-sim/tests/support/soft_tip.rs"]
mod soft_tip;

use serde::Deserialize;
use serde_json::{Value, json};
use soft_tip::{SoftTip, dense_layout, reference_layout};
use std::error::Error;
use std::time::Instant;

/// One motion: depth and travel (m) and turn (rad) at the end of each step.
#[derive(Deserialize)]
struct Motion {
    run: String,
    /// Length of a step (s).
    step: f64,
    /// Number of steps between two samples.
    every: usize,
    path: Vec<[f64; 3]>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).unwrap_or_default();
    let layout = match name.as_str() {
        "dense" => dense_layout(),
        "reference" => reference_layout(),
        other => return Err(format!("expected dense or reference, got `{other}`").into()),
    };
    let mut records = Vec::new();
    for line in std::io::stdin().lines() {
        let motion: Motion = serde_json::from_str(&line?)?;
        let mut tip = SoftTip::new(&layout, motion.step);
        let mut rows = Vec::new();
        let mut spent = 0.0;
        for (done, &[depth, travel, turn]) in (1..).zip(&motion.path) {
            let start = Instant::now();
            tip.advance(depth, travel, turn);
            spent += start.elapsed().as_secs_f64();
            if done % motion.every == 0 {
                rows.push(row(&tip, motion.step * done as f64, [depth, travel, turn]));
            }
        }
        let duration = motion.step * motion.path.len() as f64;
        records.push(json!({
            "run": motion.run,
            "step": motion.step,
            "seconds_per_second": spent / duration,
            "rows": rows,
        }));
    }
    let elements = layout.element_count();
    println!(
        "{}",
        json!({
            "name": format!("feeler, {elements} elements"),
            "version": env!("CARGO_PKG_VERSION"),
            "records": records,
        })
    );
    Ok(())
}

fn row(tip: &SoftTip, time: f64, [depth, travel, turn]: [f64; 3]) -> Value {
    let reading = tip.read();
    json!({
        "time": time,
        "depth": depth,
        "travel": travel,
        "turn": turn,
        "load": -reading.force.z,
        "elements": -reading.elements.z,
        "shear": reading.force.x,
        "moment": reading.moment,
        "radius": reading.radius,
    })
}
