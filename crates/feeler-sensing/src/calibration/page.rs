//! HTML report of a calibration.

use feeler::sensor::calibration::{
    Calibration, CalibrationModel, ElementCalibration, ElementRecord, ForceMap, LengthUnit,
    RelativeMoments,
};
use feeler_report::pages::{CalibrationPage, ElementErrors, ElementLoads, calibration_page};
use glam::{DVec2, DVec3};

/// Number of segments of a curve.
const STEPS: usize = 60;

/// Renders the report of `calibration`, fitted to `records` from `source`, as HTML.
pub fn page(calibration: &Calibration, records: &[ElementRecord], source: &str) -> String {
    let elements = &calibration.elements;
    let name = |index: usize| format!("Element {index}");
    let errors = elements.iter().enumerate().map(|(index, element)| {
        let quality = &element.quality;
        ElementErrors {
            name: name(index),
            rms: quality.held_out.rms.to_array(),
            worst: quality.held_out.worst.to_array(),
            repeatability: quality.repeatability.map(|f| f.to_array()),
            hysteresis: quality.hysteresis.map(|f| f.to_array()),
            resolution: quality.resolution.map(|f| f.to_array()),
        }
    });
    // Metres are shown in micrometres.
    let (length_unit, scale) = match calibration.made_for.length_unit {
        LengthUnit::Metre => ("µm", 1e6),
        LengthUnit::Pixel => ("px", 1.0),
    };
    let drawn = drawn(calibration).into_iter().map(|index| ElementLoads {
        name: name(index),
        length_unit: length_unit.into(),
        ..element_loads(&elements[index], &records[index], scale)
    });
    calibration_page(&CalibrationPage {
        source: source.into(),
        model: match calibration.model() {
            CalibrationModel::Separable => "separable".into(),
            CalibrationModel::Coupled => "coupled".into(),
        },
        sha256: calibration.made_for.sha256.clone(),
        full_scale: calibration.full_scale.components().to_array(),
        elements: errors.collect(),
        drawn: drawn.collect(),
    })
}

/// Returns the elements to draw: the first of each ring, and the worst in shear and in compression.
fn drawn(calibration: &Calibration) -> Vec<usize> {
    let full_scale = calibration.full_scale;
    let worst = |of: fn(DVec3) -> f64| {
        let errors = calibration
            .elements
            .iter()
            .map(|e| of(full_scale.percent(e.quality.held_out.rms)));
        let worst = errors.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        worst.map_or(0, |(index, _)| index)
    };
    let mut first = 0;
    let mut drawn = vec![0, worst(|p| p.x.max(p.y)), worst(|p| p.z)];
    if let Some(fingertip) = &calibration.made_for.fingertip {
        for ring in &fingertip.layout.rings {
            drawn.push(first);
            first += ring.elements;
        }
    }
    drawn.retain(|&index| index < calibration.elements.len());
    drawn.sort_unstable();
    drawn.dedup();
    drawn
}

/// Returns the loads, curves and residuals of one element. Lengths are multiplied by `scale`.
fn element_loads(element: &ElementCalibration, record: &ElementRecord, scale: f64) -> ElementLoads {
    let mut loads = ElementLoads::default();
    let samples = match &record.held_out {
        none if none.is_empty() => &record.fitted,
        some => some,
    };
    for sample in samples {
        let RelativeMoments {
            growth,
            displacement,
        } = element.inputs(&sample.moments);
        let inputs = [scale * displacement.x, scale * displacement.y, growth];
        let error = 1e3 * (element.force(&sample.moments) - sample.force);
        for axis in 0..3 {
            loads.loads[axis].push((inputs[axis], sample.force[axis]));
            loads.residuals[axis].push((sample.force[axis], error[axis]));
        }
    }
    let [growth, x, y] = element.map.ranges();
    // The curves of a separable map are independent of each other.
    let shares = match element.map {
        ForceMap::Separable(_) => &[0.0][..],
        ForceMap::Coupled(_) => &[0.0, 0.5, 1.0][..],
    };
    let force = |growth, displacement| {
        element.map.force(RelativeMoments {
            growth,
            displacement,
        })
    };
    for share in shares {
        let held = share * growth[1];
        let along = |u: f64| force(held, DVec2::X * u).x;
        loads.curves[0].push(curve(x, scale, along));
        let along = |u: f64| force(held, DVec2::Y * u).y;
        loads.curves[1].push(curve(y, scale, along));
    }
    loads.curves[2].push(curve(growth, 1.0, |growth| force(growth, DVec2::ZERO).z));
    loads
}

/// Samples `force` over a range of inputs; the returned inputs are multiplied by `scale`.
fn curve([low, high]: [f64; 2], scale: f64, force: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let steps = 0..=STEPS;
    steps
        .map(|step| low + (high - low) * step as f64 / STEPS as f64)
        .map(|input| (scale * input, force(input)))
        .collect()
}
