//! Validity of a wrench calibration under loads that it was not made with.

use super::fibres::located;
use feeler::sensor::wrench::{WrenchAxis, WrenchCalibration, WrenchEstimator, WrenchSample, fit};
use feeler_lab::sensor::{ForcesFile, SensorGeometry};

/// Error above which a prediction is far off, in RMS errors stated by the calibration.
const FAR_OFF: f64 = 3.0;
/// Number of consecutive parts into which a recording is divided.
const PARTS: usize = 5;

/// Counts of images.
#[derive(Debug, Default)]
struct Counted {
    pictures: usize,
    valid: usize,
    far_off: usize,
    wrongly_valid: usize,
}

impl Counted {
    /// Counts the predictions of a calibration for `samples`.
    fn add(&mut self, calibration: &WrenchCalibration, samples: &[WrenchSample]) {
        let mut estimator = WrenchEstimator::new(calibration.clone()).unwrap();
        for sample in samples {
            let estimate = estimator.estimate_with(|input| input.clone_from(&sample.seen));
            let is_far_off = |axis: WrenchAxis| {
                let stated = calibration.quality.iter().find(|q| q.axis == axis);
                let measured = sample.wrench[axis.index()].zip(estimate.component(axis));
                let off = measured.map_or(0.0, |(measured, told)| (told - measured).abs());
                stated.is_some_and(|stated| off > FAR_OFF * stated.blocks.rmse)
            };
            let far_off = WrenchAxis::ALL.into_iter().any(is_far_off);
            self.pictures += 1;
            self.valid += usize::from(estimate.valid);
            self.far_off += usize::from(far_off);
            self.wrongly_valid += usize::from(far_off && estimate.valid);
        }
    }
}

/// Calibrated on each recording alone, at most one in twenty of the far-off images of the others may be valid.
/// Calibrated on all recordings but one, one in ten: if another recording has the same load, the images are similar,
/// and the drift between the two is in neither. Of parts that were left out of all recordings, at least nine in ten
/// must be valid.
#[test]
fn far_off_predictions_under_another_load_are_invalid() {
    let Some((data, folder)) = located("far_off_predictions_under_another_load_are_invalid") else {
        return;
    };
    let sensor = SensorGeometry::read_layout(&folder.join("layout.toml")).unwrap();
    let forces = ForcesFile::read(&data.join("FORCES.csv")).unwrap();
    let names = forces.recordings();
    let samples = forces.sense(&sensor, || ()).unwrap().samples;
    let of = |recording: usize| {
        let own = samples
            .iter()
            .filter(|sample| sample.recording == recording);
        own.cloned().collect::<Vec<_>>()
    };
    let learn = |samples: &[WrenchSample]| {
        let fitted = fit(sensor.made_for.clone(), names, samples, false);
        fitted.map(|fitted| fitted.calibration)
    };
    let (mut others, mut left_out, mut own) =
        (Counted::default(), Counted::default(), Counted::default());
    for recording in 0..names.len() {
        let rest: Vec<_> = (0..names.len()).filter(|&r| r != recording).collect();
        let rest: Vec<_> = rest.into_iter().flat_map(of).collect();
        // A recording that is too short for a calibration is skipped.
        if let Ok(calibration) = learn(&of(recording)) {
            others.add(&calibration, &rest);
            println!("{} alone, others: {others:?} so far", names[recording]);
        }
        left_out.add(&learn(&rest).unwrap(), &of(recording));
        println!("{} left out: {left_out:?} so far", names[recording]);
    }
    for part in 0..PARTS {
        let (mut known, mut held_out) = (Vec::new(), Vec::new());
        for recording in 0..names.len() {
            let own = of(recording);
            for (place, sample) in own.iter().enumerate() {
                let held = PARTS * place / own.len() == part;
                if held { &mut held_out } else { &mut known }.push(sample.clone());
            }
        }
        own.add(&learn(&known).unwrap(), &held_out);
    }
    println!("parts left out: {own:?}");
    assert!(20 * others.wrongly_valid <= others.far_off, "{others:?}");
    assert!(
        10 * left_out.wrongly_valid <= left_out.far_off,
        "{left_out:?}"
    );
    assert!(10 * own.valid >= 9 * own.pictures, "{own:?}");
    assert!(20 * own.wrongly_valid <= own.pictures, "{own:?}");
}
