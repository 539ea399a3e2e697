//! Content of the page `identify.html` about a probing run.

use super::contact::Contact;
use super::estimate::Fits;
use super::identified::{Estimate, Identified};
use feeler::control::task::probe::Step;
use feeler_report::pages::{EstimateRow, FingerProbes, IdentifyPage};

/// Builds the page of `identified` with plots of `fits`.
pub fn page(identified: &Identified, fits: &Fits) -> IdentifyPage {
    let circle = &fits.circle;
    IdentifyPage {
        experiment: identified.experiment.clone(),
        seed: identified.seed,
        warnings: identified.warnings.clone(),
        rows: rows(identified),
        fingers: (0..identified.finger.len())
            .map(|finger| probes(identified, fits, finger))
            .collect(),
        circle: [circle.x.value, circle.y.value, circle.radius.value],
    }
}

fn rows(identified: &Identified) -> Vec<EstimateRow> {
    let object = &identified.object;
    let mut rows = vec![
        row("pivot, x", "object".into(), (&object.pivot_x, 1e3, "mm")),
        row("pivot, y", "object".into(), (&object.pivot_y, 1e3, "mm")),
        row("radius", "object".into(), (&object.radius, 1e3, "mm")),
    ];
    for (index, finger) in identified.finger.iter().enumerate() {
        let of = || format!("finger {index}");
        rows.extend([
            row("force noise", of(), (&finger.force_noise, 1e3, "mN")),
            row(
                "stiffness along",
                of(),
                (&finger.normal_stiffness, 1.0, "N/m"),
            ),
            row(
                "stiffness across",
                of(),
                (&finger.shear_stiffness, 1.0, "N/m"),
            ),
            row("hysteresis", of(), (&finger.hysteresis, 1e2, "%")),
            row("static friction", of(), (&finger.static_friction, 1.0, "")),
            row(
                "kinetic friction",
                of(),
                (&finger.kinetic_friction, 1.0, ""),
            ),
            row("servo lag", of(), (&finger.servo_lag, 1e3, "ms")),
            row("dead time", of(), (&finger.dead_time, 1e3, "ms")),
        ]);
    }
    rows
}

fn row(
    quantity: &'static str,
    of: String,
    (estimate, factor, unit): (&Estimate, f64, &'static str),
) -> EstimateRow {
    EstimateRow {
        quantity,
        of,
        unit,
        value: [estimate.value, estimate.low, estimate.high].map(|value| factor * value),
        method: estimate.method.clone(),
    }
}

fn probes(identified: &Identified, fits: &Fits, index: usize) -> FingerProbes {
    let (finger, fit) = (&identified.finger[index], &fits.fingers[index]);
    let force = |contact: &&Contact| -> f64 {
        contact
            .samples
            .iter()
            .map(|sample| sample.force.z)
            .fold(0.0, f64::max)
    };
    let contact = fit
        .contacts
        .iter()
        .max_by(|a, b| force(a).total_cmp(&force(b)));
    let samples = contact.map_or(&[][..], |contact| &contact.samples);
    let sheared = |step: Step| matches!(step, Step::Shear | Step::ShearBack);
    // Plot the component with the larger shear.
    let most = |axis: usize| -> f64 {
        let own = samples.iter().filter(|sample| sheared(sample.step));
        let (low, high) = own.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), sample| {
            (low.min(sample.moved[axis]), high.max(sample.moved[axis]))
        });
        high - low
    };
    let axis = usize::from(most(1) > most(0));
    let pressed = samples.iter().filter(|sample| !sheared(sample.step));
    let shear = samples.iter().filter(|sample| sheared(sample.step));
    let slides = fit.slides.iter();
    let tips = fits.circle.points.iter().filter(|(own, _)| *own == index);
    FingerProbes {
        depth: pressed
            .map(|sample| (sample.moved.z, sample.force.z))
            .collect(),
        shear: shear
            .map(|sample| (sample.moved[axis], -sample.force[axis]))
            .collect(),
        stiffness: [finger.normal_stiffness.value, finger.shear_stiffness.value],
        slides: slides
            .map(|slide| {
                slide
                    .time
                    .iter()
                    .copied()
                    .zip(slide.ratio.iter().copied())
                    .collect()
            })
            .collect(),
        friction: [finger.static_friction.value, finger.kinetic_friction.value],
        tips: tips.map(|(_, tip)| (tip.x, tip.y)).collect(),
    }
}
