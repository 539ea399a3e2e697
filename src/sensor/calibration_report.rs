//! How far a calibration is off, as text.

use super::calibration::Calibration;
use glam::DVec3;
use std::fmt;

/// The errors of a calibration on held-out loads, as text: a line for each element and each ring.
#[derive(Debug, Clone, Copy)]
pub struct CalibrationReport<'a> {
    /// What to report on.
    pub calibration: &'a Calibration,
    /// Full scale of the compression, N.
    pub normal_full_scale: f64,
    /// Full scale of the shear force, N.
    pub shear_full_scale: f64,
}

impl<'a> CalibrationReport<'a> {
    /// Reports against full scales of 2 N compression and 1 N shear.
    pub fn new(calibration: &'a Calibration) -> Self {
        Self {
            calibration,
            normal_full_scale: 2.0,
            shear_full_scale: 1.0,
        }
    }

    /// Root mean square and worst error over the elements of each ring, N, along x, y, z of `E_i`.
    pub fn rings(&self) -> Vec<(DVec3, DVec3)> {
        let mut elements = self.calibration.elements.iter();
        let rings = &self.calibration.fingertip.layout.rings;
        rings
            .iter()
            .map(|ring| {
                let (mut squares, mut worst) = (DVec3::ZERO, DVec3::ZERO);
                for element in elements.by_ref().take(ring.elements) {
                    squares += element.held_out.rms * element.held_out.rms;
                    worst = worst.max(element.held_out.worst);
                }
                let mean = squares / ring.elements.max(1) as f64;
                (mean.map(f64::sqrt), worst)
            })
            .collect()
    }

    fn line(
        &self,
        f: &mut fmt::Formatter<'_>,
        name: &str,
        rms: DVec3,
        worst: DVec3,
    ) -> fmt::Result {
        write!(f, "{name:<12}")?;
        let scales = [
            self.shear_full_scale,
            self.shear_full_scale,
            self.normal_full_scale,
        ];
        for ((rms, worst), scale) in rms.to_array().iter().zip(worst.to_array()).zip(scales) {
            let (rms_percent, worst_percent) = (100.0 * rms / scale, 100.0 * worst / scale);
            write!(
                f,
                "  {rms:.4} ({rms_percent:4.1} %) {worst:.4} ({worst_percent:4.1} %)"
            )?;
        }
        writeln!(f)
    }
}

impl fmt::Display for CalibrationReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "Held-out errors, rms and worst, N (share of full scale: {} N in x and y, {} N in z)",
            self.shear_full_scale, self.normal_full_scale
        )?;
        writeln!(f, "{:<12}  {:<33}{:<33}z", "", "x", "y")?;
        for (index, element) in self.calibration.elements.iter().enumerate() {
            let held_out = &element.held_out;
            self.line(f, &format!("element {index}"), held_out.rms, held_out.worst)?;
        }
        for (index, (rms, worst)) in self.rings().into_iter().enumerate() {
            self.line(f, &format!("ring {index}"), rms, worst)?;
        }
        Ok(())
    }
}
