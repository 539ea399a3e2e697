//! Injected faults of the rig: drives, encoders, friction, masses and external forces.

use super::fault::{FaultConfig, FaultKind};
use crate::world::model::WorldModel;
use crate::world::state::{FingerState, State};
use glam::DVec3;

/// Applies faults of the rig to its state in every step. Ignores faults of tactile sensors.
pub struct RigFaults {
    faults: Vec<(FaultConfig, Part)>,
    /// Backlash of a joint without a fault (rad).
    backlash: f64,
}

/// Faulty part, by its indices in the state. Indices that do not exist are ignored.
enum Part {
    Stall(usize, usize),
    Backlash(usize, usize, f64),
    /// Encoder with a wrong gain: finger, joint, gain (0 if frozen), and the measured angle at the start of the fault
    /// (rad), about which the gain acts; `None` until the fault starts.
    Gain(usize, usize, f64, Option<f64>),
    /// Encoder of a joint with an offset (rad).
    Jump(usize, usize, f64),
    Friction(Vec<usize>, f64),
    Mass(usize, MassChange),
    /// External force on an object: its maximum (N, in W), and the ramp by which it rises.
    Pull(usize, DVec3, Ramp),
}

/// Linear change from 0 to 1.
struct Ramp {
    /// Start of the change (s).
    from: f64,
    /// Duration of the change (s).
    over: f64,
}

/// Linear change of a mass.
struct MassChange {
    ramp: Ramp,
    /// Mass before the change (kg).
    before: f64,
    /// Mass after the change (kg).
    after: f64,
}

impl Ramp {
    fn at(&self, time: f64) -> f64 {
        match self.over > 0.0 {
            true => ((time - self.from) / self.over).clamp(0.0, 1.0),
            false => 1.0,
        }
    }
}

impl MassChange {
    fn at(&self, time: f64) -> f64 {
        self.before + self.ramp.at(time) * (self.after - self.before)
    }
}

impl RigFaults {
    /// Selects the `faults` that affect the rig of `model`.
    pub fn new(faults: &[FaultConfig], model: &WorldModel) -> Self {
        let part = |fault: &FaultConfig| match fault.kind {
            FaultKind::ServoStall { finger, joint } => Some(Part::Stall(finger, joint)),
            FaultKind::Backlash {
                finger,
                joint,
                angle,
            } => Some(Part::Backlash(finger, joint, angle)),
            FaultKind::JointFreeze { finger, joint } => Some(Part::Gain(finger, joint, 0.0, None)),
            FaultKind::JointGain {
                finger,
                joint,
                gain,
            } => Some(Part::Gain(finger, joint, gain, None)),
            FaultKind::JointJump {
                finger,
                joint,
                angle,
            } => Some(Part::Jump(finger, joint, angle)),
            FaultKind::FrictionDrop { ref object, factor } => {
                let objects = match object {
                    Some(name) => model.object(name).into_iter().collect(),
                    None => (0..model.objects.len()).collect(),
                };
                Some(Part::Friction(objects, factor))
            }
            FaultKind::MassChange {
                ref object,
                mass,
                over,
            } => {
                let index = model.object(object)?;
                let change = MassChange {
                    ramp: Ramp {
                        from: fault.from,
                        over,
                    },
                    before: model.objects[index].mass()?,
                    after: mass,
                };
                Some(Part::Mass(index, change))
            }
            FaultKind::Pull {
                ref object,
                force,
                over,
            } => {
                let from = fault.from;
                let ramp = Ramp { from, over };
                Some(Part::Pull(model.object(object)?, force.into(), ramp))
            }
            _ => None,
        };
        let faults = faults.iter();
        Self {
            faults: faults.filter_map(|f| Some((f.clone(), part(f)?))).collect(),
            backlash: model.servo.backlash,
        }
    }

    /// Applies faults that are active at the state's time, and removes the others.
    pub fn apply(&mut self, state: &mut State) {
        for (_, part) in &self.faults {
            part.mend(state, self.backlash);
        }
        for (fault, part) in &mut self.faults {
            match (fault.active(state.time), part) {
                (true, part) => part.spoil(state),
                (false, Part::Gain(.., shown)) => *shown = None,
                (false, _) => {}
            }
        }
    }
}

impl Part {
    /// Removes the fault. `backlash` is the backlash of a joint without a fault (rad).
    fn mend(&self, state: &mut State, backlash: f64) {
        match self {
            &Self::Stall(finger, joint) => stall(state.fingers.get_mut(finger), joint, false),
            &Self::Backlash(finger, joint, _) => {
                widen(state.fingers.get_mut(finger), joint, |_| backlash);
            }
            &Self::Gain(finger, joint, ..) | &Self::Jump(finger, joint, _) => {
                read_wrong(state.fingers.get_mut(finger), joint, |_| (1.0, 0.0));
            }
            Self::Friction(objects, _) => {
                for &object in objects {
                    state.objects[object].friction_factor = 1.0;
                }
            }
            Self::Mass(object, change) => state.objects[*object].mass = change.before,
            Self::Pull(object, ..) => state.objects[*object].pull = DVec3::ZERO,
        }
    }

    /// Applies the fault to a state without it. Several faults of the same part accumulate.
    fn spoil(&mut self, state: &mut State) {
        match self {
            &mut Self::Stall(finger, joint) => stall(state.fingers.get_mut(finger), joint, true),
            &mut Self::Backlash(finger, joint, angle) => {
                widen(state.fingers.get_mut(finger), joint, |band| band + angle);
            }
            Self::Gain(finger, joint, factor, broke_at) => {
                read_wrong(
                    state.fingers.get_mut(*finger),
                    *joint,
                    |(gain, offset, at)| {
                        let broke_at = *broke_at.get_or_insert(gain * at + offset);
                        (
                            *factor * gain,
                            *factor * offset + (1.0 - *factor) * broke_at,
                        )
                    },
                );
            }
            &mut Self::Jump(finger, joint, angle) => {
                read_wrong(state.fingers.get_mut(finger), joint, |(gain, offset, _)| {
                    (gain, offset + angle)
                });
            }
            Self::Friction(objects, factor) => {
                for &mut object in objects {
                    state.objects[object].friction_factor *= *factor;
                }
            }
            Self::Mass(object, change) => state.objects[*object].mass = change.at(state.time),
            Self::Pull(object, force, ramp) => {
                state.objects[*object].pull += ramp.at(state.time) * *force;
            }
        }
    }
}

fn stall(finger: Option<&mut FingerState>, joint: usize, stalled: bool) {
    if let Some(finger) = finger.filter(|finger| joint < finger.joints.count()) {
        finger.joints.stalled[joint] = stalled;
    }
}

/// Sets gain and offset (rad) of a joint's encoder to `to` of the present gain, offset and joint angle (rad).
fn read_wrong(
    finger: Option<&mut FingerState>,
    joint: usize,
    to: impl FnOnce((f64, f64, f64)) -> (f64, f64),
) {
    if let Some(finger) = finger.filter(|finger| joint < finger.joints.count()) {
        let (angle, encoders) = (finger.joints.position[joint], &mut finger.joints.encoders);
        let now = (encoders.gain[joint], encoders.offset[joint], angle);
        (encoders.gain[joint], encoders.offset[joint]) = to(now);
    }
}

fn widen(finger: Option<&mut FingerState>, joint: usize, to: impl Fn(f64) -> f64) {
    if let Some(finger) = finger.filter(|finger| joint < finger.joints.count()) {
        let band = &mut finger.joints.backlash[joint];
        *band = to(*band);
    }
}
