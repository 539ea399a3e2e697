//! Conversion from and to the messages of a recording.

use super::ArrayError;
use super::message::{
    CALIBRATED, CONTACT, ELEMENT_AXES, INVALID, OVERLOAD, SLIP, TactileArray, TactileChannel,
    joined, names,
};
use crate::messages::channels::{Flags, Tactile};
use crate::messages::facts::RunFacts;
use crate::messages::model::frame;
use crate::messages::names::SensingKind;
use crate::ros::{Header, Time};
use glam::{DQuat, DVec3};

/// Describes the sensor of `finger`: everything but the values of a sample, or `None` if the geometry is unknown. The
/// rate is the control rate, because feeler uses at most one sample per step. The world is simulated if the forces are
/// sensed directly or the solids around the hand are known.
pub fn of_finger(facts: &RunFacts, finger: usize) -> Option<TactileArray> {
    let model = facts.hand.get(finger)?;
    let elements = model.elements();
    let orientations = elements.map(|(element, _)| DQuat::from_mat3(&element.rotation).into());
    let is_direct = facts.sensing == SensingKind::Direct;
    let forces = TactileChannel {
        axes: ELEMENT_AXES,
        calibration: CALIBRATED,
        ..TactileChannel::of_forces()
    };
    let shear_rates = TactileChannel {
        name: names::SHEAR_RATE.into(),
        unit: "N/s".into(),
        components: 1,
        ..forces.clone()
    };
    Some(TactileArray {
        header: Header::of(frame(finger, "dome")),
        sensor: format!("finger_{finger}"),
        principle: if is_direct { "" } else { "optical" }.into(),
        simulated: is_direct || !facts.solids.is_empty(),
        rate: 1.0 / facts.control_period,
        positions: model.elements().map(|(_, tip)| tip.into()).collect(),
        orientations: orientations.collect(),
        channels: vec![forces, shear_rates],
        contact_threshold: facts.touch_force_threshold,
        slip_threshold: facts.slip_threshold,
        overload_threshold: facts.over_force_threshold,
        ..TactileArray::default()
    })
}

impl TactileArray {
    /// Sets the sample of an array from [`of_finger`]: the force on each element as in a
    /// [`TactileFrame`](feeler::sensor::forces::TactileFrame) (N; compression positive; NaN if unknown), and its shear
    /// rate (N/s). Contact follows from the thresholds. Does not allocate after the first call.
    pub fn set_sample(
        &mut self,
        stamp: Time,
        sequence: u64,
        forces: impl Iterator<Item = DVec3> + Clone,
        shear_rates: &[f64],
    ) {
        self.header.stamp = stamp;
        self.sequence = sequence;
        let thresholds = [self.contact_threshold, self.overload_threshold];
        self.contact.clear();
        let rates = shear_rates.iter().copied().chain(std::iter::repeat(0.0));
        for (force, rate) in forces.clone().zip(rates) {
            let bits = [
                (force.z > thresholds[0], CONTACT),
                (rate > self.slip_threshold, SLIP),
                (force.z > thresholds[1], OVERLOAD),
            ];
            self.contact.push(joined(&bits));
        }
        for channel in &mut self.channels {
            match channel.name.as_str() {
                names::FORCE => channel.set_forces(forces.clone()),
                names::SHEAR_RATE => {
                    channel.values.clear();
                    channel.values.extend(shear_rates);
                }
                _ => {}
            }
        }
    }
}

impl TactileChannel {
    /// Sets forces (N), given with positive compression.
    fn set_forces(&mut self, forces: impl Iterator<Item = DVec3>) {
        self.values.clear();
        self.status.clear();
        for force in forces {
            self.values.extend(flipped(force).to_array());
            self.status
                .push(if force.is_finite() { 0 } else { INVALID });
        }
    }
}

/// Sets the sample of an array from [`of_finger`] to a recorded frame and its flags. The stamp is rounded to
/// nanoseconds, or 0 if it is not a time of a run.
pub fn set_recorded(array: &mut TactileArray, tactile: &Tactile, flags: &Flags) {
    let stamp = Time::of(tactile.stamp).unwrap_or_default();
    let forces = tactile.forces.iter().map(|&force| DVec3::from(force));
    array.set_sample(stamp, tactile.sequence, forces, &flags.shear_rate);
}

/// Converts an array to a tactile frame as in a recording. Everything but sequence number, time and forces is lost;
/// invalid forces become NaN.
///
/// # Errors
/// If the array is invalid or has no forces in newtons.
pub fn to_recorded(array: &TactileArray) -> Result<Tactile, ArrayError> {
    let forces = array.forces_in_element_frames()?;
    Ok(Tactile {
        sequence: array.sequence,
        stamp: array.header.seconds(),
        forces: forces
            .into_iter()
            .map(|force| flipped(force).into())
            .collect(),
    })
}

/// Converts between a force on the element by the object and one with positive compression, in the element's axes.
fn flipped(force: DVec3) -> DVec3 {
    force.with_z(-force.z)
}
