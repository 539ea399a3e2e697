//! Accuracy of slip detection while a cap is screwed on, compared with ground truth: in the strokes in which the cap
//! turns with the fingers, and in the strokes in which it is closed.
//!
//! ```text
//! cargo run --release --example slip_on_a_cap
//! ```

use feeler::control::law::missing_shear::MissingShearConfig;
use feeler::control::{FeelerShape, FingerReadings, Phase, SlipDetector};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Pictures, Session};
use feeler_lab::grasps::Confusion;
use std::error::Error;
use std::ops::Range;

/// Slip detectors, in the order of the counts.
pub const DETECTORS: [&str; 3] = [
    "shear rate (the paper's SLIP)",
    "missing shear, fixed objects",
    "missing shear, movable objects",
];
/// True slip distance of a tip between two frames from which it counts as slip (m).
const WAY: f64 = 20e-6;

/// One finger with its detectors.
struct Finger {
    detectors: [SlipDetector; 2],
    /// `true` if each element was pressed with more than F1 in the previous frame.
    pressed: Vec<bool>,
    /// Total slip distance of each feeler until the previous frame (m).
    way: Vec<f64>,
}

impl Finger {
    fn new(touch_force: f64, elements: usize) -> Self {
        let feeler = FeelerShape::default();
        Self {
            detectors: [
                SlipDetector::new(feeler, elements),
                SlipDetector::for_movable_object(feeler, touch_force, elements),
            ],
            pressed: vec![false; elements],
            way: vec![0.0; elements],
        }
    }

    /// Returns whether each detector reports slip in the latest frame.
    fn say(&mut self, sense: &FingerReadings<'_>, touch_force: f64) -> [bool; 3] {
        let threshold = MissingShearConfig::default().threshold;
        let (forces, pressed) = (&sense.touch.frame.forces, &self.pressed);
        let missing = self.detectors.each_mut().map(|detector| {
            let mut elements = detector.detect(sense).iter().zip(forces).zip(pressed);
            elements.any(|((&missing, force), pressed)| {
                *pressed && force.z > touch_force && missing > threshold
            })
        });
        [sense.flags().slip, missing[0], missing[1]]
    }

    /// Returns `true` if a pressed element slipped since the previous frame.
    fn slipped(&self, way: &[f64]) -> bool {
        let mut ways = way.iter().zip(&self.way).zip(&self.pressed);
        ways.any(|((now, before), pressed)| *pressed && now - before > WAY)
    }
}

/// Closes the cap under `law` once for each of `seeds`, with forces from `sensing`. Returns the confusion matrices of
/// the detectors in frames of fingers in MOVE: of strokes 1 and 2, and of 3 and 4.
///
/// # Errors
/// If a run fails.
pub fn score(
    law: &str,
    sensing: &str,
    seeds: Range<u64>,
) -> Result<[[Confusion; 3]; 2], Box<dyn Error>> {
    let mut counts = [[Confusion::default(); 3]; 2];
    for seed in seeds {
        let settings = [("control.law", law), ("sensing", sensing)];
        let settings = settings.map(|(key, value)| format!("{key}={value}"));
        let settings = [&settings[..], &[format!("seed={seed}")]].concat();
        run(&Experiment::load("cap-closing", &settings)?, &mut counts)?;
    }
    Ok(counts)
}

fn run(experiment: &Experiment, counts: &mut [[Confusion; 3]; 2]) -> Result<(), Box<dyn Error>> {
    let touch_force = experiment.config.control.touch_force;
    let mut session = Session::rendering(experiment, Pictures::Sensed)?;
    let fingers = session.layouts().iter().map(|l| l.elements.len());
    let mut fingers: Vec<_> = fingers.map(|n| Finger::new(touch_force, n)).collect();
    while !session.finished() {
        let world = session.rig().world().state().clone();
        session.step()?;
        let felt = session.control_loop();
        let controller = felt.controller();
        let half = usize::from(controller.task().stroke() > 2);
        let senses = felt.hand_sense().fingers().zip(&world.fingers);
        for (finger, (sense, truth)) in fingers.iter_mut().zip(senses) {
            let way = truth.slipped.clone();
            let (said, truth) = (finger.say(&sense, touch_force), finger.slipped(&way));
            if controller.phase() == Phase::Move {
                for (count, said) in counts[half].iter_mut().zip(said) {
                    count.add(truth, said);
                }
            }
            finger.way = way;
            let forces = sense.touch.frame.forces.iter();
            finger.pressed = forces.map(|force| force.z > touch_force).collect();
        }
    }
    Ok(())
}

pub fn main() -> Result<(), Box<dyn Error>> {
    for (law, sensing) in [
        ("tri-axial", "direct"),
        ("tri-axial-missing-shear", "direct"),
        ("tri-axial", "image"),
    ] {
        let counts = score(law, sensing, 0..20)?;
        for (strokes, counts) in ["1 and 2", "3 and 4"].iter().zip(counts) {
            let slips = counts[0].noticed + counts[0].missed;
            let slipping = 100.0 * (slips as f64 / counts[0].count() as f64);
            println!("{law}, {sensing}, strokes {strokes}: {slipping:.1} % of frames with a slip");
            for (detector, count) in DETECTORS.iter().zip(counts) {
                let (precision, recall) = (100.0 * count.precision(), 100.0 * count.recall());
                println!("  {detector:<38} precision {precision:5.1} %  recall {recall:5.1} %");
            }
        }
    }
    Ok(())
}
