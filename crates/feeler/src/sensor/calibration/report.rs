//! Formats the accuracy of a calibration as text.

use super::element::{CalibrationModel, ElementCalibration};
use super::model::Calibration;
use glam::DVec3;
use std::fmt;

/// Displays the errors of a calibration on held-out loads: one line per ring, or per element if the calibration has
/// no rings.
#[derive(Debug, Clone, Copy)]
pub struct CalibrationReport<'a> {
    /// Calibration to report on.
    pub calibration: &'a Calibration,
    /// If `true`, prints a line for each element in addition.
    pub verbose: bool,
}

/// Accuracy over one or several elements, N, along x, y, z of `E_i`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Root mean square on held-out loads.
    pub rms: DVec3,
    /// Largest absolute error on held-out loads.
    pub worst: DVec3,
    /// Largest standard deviation of readings under the same load; zero if unknown.
    pub repeatability: DVec3,
    /// Largest difference between readings at rising and at falling load; zero if unknown.
    pub hysteresis: DVec3,
    /// Three standard deviations of the reading without load: the smallest detectable force; zero if unknown.
    pub resolution: DVec3,
}

impl Errors {
    /// Combines the accuracy of `elements`: the root of the mean square for `rms`, and the maximum for all others.
    pub fn over(elements: &[ElementCalibration]) -> Self {
        let mut errors = Self::default();
        for ElementCalibration { quality, .. } in elements {
            let held_out = quality.held_out;
            errors.rms += held_out.rms * held_out.rms;
            errors.worst = errors.worst.max(held_out.worst);
            for (largest, value) in [
                (&mut errors.repeatability, quality.repeatability),
                (&mut errors.hysteresis, quality.hysteresis),
                (&mut errors.resolution, quality.resolution),
            ] {
                *largest = largest.max(value.unwrap_or_default());
            }
        }
        errors.rms = (errors.rms / elements.len().max(1) as f64).map(f64::sqrt);
        errors
    }
}

impl<'a> CalibrationReport<'a> {
    /// Creates a report on `calibration` with one line per ring.
    pub fn new(calibration: &'a Calibration) -> Self {
        Self {
            calibration,
            verbose: false,
        }
    }

    /// Accuracy over the elements of each ring; empty if the calibration has no rings.
    pub fn rings(&self) -> Vec<Errors> {
        let mut rest = &self.calibration.elements[..];
        let fingertip = self.calibration.made_for.fingertip.as_ref();
        let rings = fingertip.map_or(&[][..], |fingertip| &fingertip.layout.rings);
        rings
            .iter()
            .map(|ring| {
                let (own, others) = rest.split_at(ring.elements.min(rest.len()));
                rest = others;
                Errors::over(own)
            })
            .collect()
    }

    fn line(&self, f: &mut fmt::Formatter<'_>, name: &str, errors: Errors) -> fmt::Result {
        write!(f, "{name:<12}")?;
        let full_scale = self.calibration.full_scale;
        let percent = [errors.rms, errors.worst].map(|force| full_scale.percent(force).to_array());
        let newtons = [errors.rms, errors.worst].map(|force| force.to_array());
        for axis in 0..3 {
            for kind in 0..2 {
                let (newtons, percent) = (newtons[kind][axis], percent[kind][axis]);
                write!(f, " {newtons:7.4} ({percent:5.2} %)")?;
            }
            write!(f, " ")?;
        }
        writeln!(f)
    }
}

impl fmt::Display for CalibrationReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let calibration = self.calibration;
        let (full_scale, elements) = (calibration.full_scale, &calibration.elements);
        let model = match calibration.model() {
            CalibrationModel::Separable => "separable",
            CalibrationModel::Coupled => "coupled",
        };
        writeln!(
            f,
            "{model}: held-out errors, rms and worst, N (share of full scale: {} N in x and y, {} N in z)",
            full_scale.shear, full_scale.normal
        )?;
        writeln!(f, "{:<12} {:<36}{:<36}z", "", "x", "y")?;
        let rings = self.rings();
        if self.verbose || rings.is_empty() {
            for (index, element) in elements.iter().enumerate() {
                let errors = Errors::over(std::slice::from_ref(element));
                self.line(f, &format!("element {index}"), errors)?;
            }
        }
        for (index, errors) in rings.into_iter().enumerate() {
            self.line(f, &format!("ring {index}"), errors)?;
        }
        let all = Errors::over(elements);
        for (name, of, force) in [
            ("repeatability", "standard deviation", all.repeatability),
            ("hysteresis", "rising against falling load", all.hysteresis),
            (
                "resolution",
                "three standard deviations without load",
                all.resolution,
            ),
        ] {
            if force != DVec3::ZERO {
                let DVec3 { x, y, z } = 1e3 * force;
                writeln!(
                    f,
                    "{name} ({of}), largest: {x:.1}, {y:.1}, {z:.1} mN in x, y, z"
                )?;
            }
        }
        Ok(())
    }
}
