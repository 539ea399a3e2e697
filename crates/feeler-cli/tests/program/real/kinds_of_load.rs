//! Whether a wrench calibration knows what it was not made for.

use super::fibres::located;
use feeler::sensor::wrench::{WrenchAxis, WrenchCalibration, WrenchEstimator, WrenchSample, fit};
use feeler_lab::sensor::{ForcesFile, SensorGeometry};

/// A prediction is far off from here on, in root mean square errors that the calibration states.
const FAR_OFF: f64 = 3.0;
/// Parts that a recording is cut into, one after the other in time.
const PARTS: usize = 5;

/// Pictures that were counted.
#[derive(Debug, Default)]
struct Counted {
    pictures: usize,
    valid: usize,
    far_off: usize,
    wrongly_valid: usize,
}

impl Counted {
    /// Looks at `samples` by a calibration.
    fn add(&mut self, calibration: &WrenchCalibration, samples: &[WrenchSample]) {
        let mut estimator = WrenchEstimator::new(calibration.clone()).unwrap();
        for sample in samples {
            let estimate = estimator.of_seen(sample.seen.iter().copied());
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

/// Calibrated on each recording alone, at most one in twenty of the pictures of the others that are far off is taken for valid. Calibrated on
/// all but one, one in ten: where another one is of the same load, pictures are alike, and drift between the two is in none of them. Of parts
/// that were left out of all recordings, at least nine in ten are valid.
#[test]
fn what_is_far_off_under_another_load_is_not_valid() {
    let Some((data, folder)) = located("what_is_far_off_under_another_load_is_not_valid") else {
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
        // One that is too short to learn from is not calibrated on.
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
