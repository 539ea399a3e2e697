//! Rubber that relaxes: each feeler as a standard linear solid (Zener's model).
//!
//! Beside a spring lies another one in series with a dashpot. Right after a quick deformation both bear, and the
//! stiffness `K` is what [`FeelerConfig`] says; in the end only the first one does, with `(1 - share) K`. So the
//! force is that of one spring of stiffness `K` whose rest moves: `F = K (d - p)` at the displacement `d` of the
//! undeformed tip from the anchor, and the *set* `p` follows it, `dp/dt = (share d - p) / time`.
//!
//! - At constant deformation the force falls as `K d (1 - share (1 - exp(-t / time)))`.
//! - At constant force the feeler creeps with the time `time / (1 - share)`, by `share / (1 - share)` of what it
//!   yielded at once.
//! - A feeler that lets go bears no force, which is a constant one: it recovers with the creep time, and one that
//!   touches again before finds itself set, shorter and bent.
//!
//! The set belongs to the rubber, so it is kept in the fingertip's frame. A slip moves the anchor under it and
//! meets the whole stiffness, and so does what turns within a step. What `normal_shear_coupling` and
//! `length_limit` add to the force does not relax: both follow from the feeler's shape, that is from `d`.
//!
//! [`FeelerConfig`]: super::columnar_feeler::FeelerConfig

use super::model::WorldModel;
use super::state::State;
use feeler::check::Checker;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A set below this is none, m: far below what a picture shows, far above where arithmetic becomes slow.
const FORGOTTEN: f64 = 1e-15;

/// How a feeler relaxes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelaxationConfig {
    /// Share of the stiffness right after a quick deformation (`normal_stiffness`, `shear_stiffness`) that
    /// relaxes away.
    pub share: f64,
    /// Relaxation time: time constant with which the force falls at constant deformation, s.
    pub time: f64,
}

impl RelaxationConfig {
    /// Requires every value of the table `key` to be in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        // Rubber that keeps nothing would flow, and take for ever to recover.
        checker.between(&format!("{key}.share"), self.share, 0.0, 0.99);
        checker.positive(&format!("{key}.time"), self.time);
    }

    /// Time constant with which the feeler creeps under constant force, and recovers when free, s.
    pub fn creep_time(&self) -> f64 {
        self.time / (1.0 - self.share)
    }

    /// The set `duration` (s) later at constant `displacement`; both m, in one frame.
    pub fn held(&self, set: DVec3, displacement: DVec3, duration: f64) -> DVec3 {
        let end = self.share * displacement;
        end + (-duration / self.time).exp() * (set - end)
    }

    /// The set (m) of a feeler that has been free for `duration`, s.
    pub fn recovered(&self, set: DVec3, duration: f64) -> DVec3 {
        let left = set * (-duration / self.creep_time()).exp();
        if left.length_squared() < FORGOTTEN * FORGOTTEN {
            return DVec3::ZERO;
        }
        left
    }
}

/// Lets all feelers relax over one step, at the deformation that the step has left them with.
///
/// So a set is half a step late on a deformation that changes, by `step / (2 time)` of the energy that a cycle
/// of load takes; within a step no stiffness depends on its length.
pub(super) fn relax(model: &WorldModel, state: &mut State) {
    if !model.relaxes {
        return;
    }
    let State {
        fingers, objects, ..
    } = state;
    for (finger, own) in model.fingers.iter().zip(fingers) {
        let to_fingertip = own.tip.rotation.transpose();
        for (element, set) in own.sets.iter_mut().enumerate() {
            let Some(relaxation) = &finger.feelers[element].relaxation else {
                continue;
            };
            let mut touching = own.contacts.iter();
            *set = match touching.find(|contact| contact.element == element) {
                Some(contact) => {
                    let anchor = objects[contact.object]
                        .pose
                        .to_world(contact.anchor.position);
                    let anchor = to_fingertip * (anchor - own.tip.position);
                    let displacement = finger.dome_radius * finger.normals[element] - anchor;
                    relaxation.held(*set, displacement, model.step)
                }
                None => relaxation.recovered(*set, model.step),
            };
        }
    }
}
