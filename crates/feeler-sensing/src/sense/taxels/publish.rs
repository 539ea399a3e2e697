//! Publishes the forces of a taxel array for the hand program.

use super::super::SenseOptions;
use feeler::sensor::fingertip::{CalibrationTarget, ElementLayout, SensingElement};
use feeler::sensor::forces::TactileFrame;
use feeler::sensor::taxel::{TaxelLayout, TaxelUnit};
use feeler_console::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::rigs::linked::expected;
use feeler_link::programs::{SensorConfig, SensorProgram};
use feeler_link::security::Right;
use glam::DVec3;
use std::time::Instant;

/// The sensor program of one finger whose fingertip is a taxel array.
pub struct Publisher {
    program: SensorProgram,
    /// Frame of each taxel, and frame of the experiment's element with the same number.
    frames: Vec<(SensingElement, SensingElement)>,
}

impl Publisher {
    /// Creates the publisher for the experiment and finger in `options`.
    pub fn new(
        options: &SenseOptions,
        layout: &TaxelLayout,
        warn: Box<dyn FnMut(&str) + Send>,
    ) -> Result<Self, CommandError> {
        let settings = options.settings.clone();
        let experiment = Experiment::load(options.experiment(), &settings)?;
        let finger = options.finger.unwrap_or(0);
        let fingertip = experiment.fingertip(Some(finger))?;
        let elements = ElementLayout::new(&fingertip.layout).elements;
        check(layout, elements.len())?;
        let config = SensorConfig {
            finger,
            elements: elements.len(),
            picture_size: (fingertip.camera.width, fingertip.camera.height),
            thresholds: experiment.config.control.thresholds(),
            fingertip: CalibrationTarget::fingertip(fingertip)?.sha256,
            expected: expected(&experiment)?,
        };
        let rig = options.rig_name(&experiment);
        let link = options.link.with_right(&[Right::Sense(finger)])?;
        let mut program = SensorProgram::new(&config, link.connect(&rig)?)?;
        program.set_warn(warn);
        let taxels = layout.elements().map(|(element, _)| element);
        Ok(Self {
            program,
            frames: taxels.zip(elements).collect(),
        })
    }

    /// Publishes `frame`, whose row was received at `at`.
    pub fn publish(&mut self, frame: &TactileFrame, at: Instant) -> Result<(), CommandError> {
        let own = self.frames.iter().zip(&frame.forces);
        let forces = own.map(|((taxel, element), &force)| {
            let valid = Some(force).filter(|force| !force.is_nan());
            valid.map(|force| in_frame_of(element, taxel, force))
        });
        let taken = (frame.sequence, frame.stamp, at);
        Ok(self.program.publish(taken, forces)?)
    }

    /// Warns about programs that are rejected.
    pub fn check_peers(&mut self) {
        self.program.check_peers();
    }
}

/// Rejects layouts that the hand cannot use.
fn check(layout: &TaxelLayout, elements: usize) -> Result<(), CommandError> {
    let taxels = layout.taxels.len();
    if taxels != elements {
        return Err(format!(
            "--publish: {taxels} taxels, but the experiment's fingertip has {elements} elements; expected equal numbers"
        )
        .into());
    }
    if layout.force_unit() == TaxelUnit::Counts {
        let message =
            "--publish: the hand's thresholds are in newtons; add counts_per_newton to the layout";
        return Err(message.into());
    }
    if layout.columns.sequence.is_some() {
        return Err("--publish: expected a single sequence of rows; remove the sequence column from the layout or the options".into());
    }
    Ok(())
}

/// Transforms the `force` on a taxel to the frame of an experiment's element. The vector remains the same.
fn in_frame_of(element: &SensingElement, taxel: &SensingElement, force: DVec3) -> DVec3 {
    let own = element.rotation.transpose() * taxel.force_on_fingertip(force);
    own.with_z(-own.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The force on the fingertip is the same in both frames.
    #[test]
    fn a_force_keeps_its_direction() {
        let taxel = SensingElement::facing(DVec3::X);
        let element = SensingElement::facing(DVec3::new(0.8, 0.6, 0.0));
        let force = DVec3::new(0.1, -0.2, 1.0);
        let turned = in_frame_of(&element, &taxel, force);
        let pushes = taxel.force_on_fingertip(force);
        assert!((element.force_on_fingertip(turned) - pushes).length() < 1e-12);
        assert!((in_frame_of(&taxel, &taxel, force) - force).length() < 1e-12);
    }
}
