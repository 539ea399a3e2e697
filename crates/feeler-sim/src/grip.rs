//! What the feelers on an object do to it, and how that changes as it gives way.

use super::columnar_feeler::{Anchor, FeelerConfig, Friction, Tip, split, tip_of, within_cone};
use super::contacts::{BLOCK, Column};
use super::model::WorldModel;
use super::pose::Pose;
use super::settle::friction;
use super::state::{FingerState, ObjectState};
use super::step::undeformed;
use super::thread::FingerLoad;
use glam::DVec3;

/// How an object may give way, in its own frame.
#[derive(Clone, Copy)]
pub(super) enum Freedom {
    /// Along a direction.
    Along(DVec3),
    /// Around its z axis, sinking by so much, m/rad.
    Around(f64),
}

/// What the feelers on an object would do along one of its freedoms, holding on, where it is so that it has each fingertip where `seen`
/// says.
#[inline(always)]
pub(super) fn grip(
    model: &WorldModel,
    fingers: &[FingerState],
    own: &ObjectState,
    index: usize,
    seen: impl Fn(&FingerState) -> Pose,
    freedom: Freedom,
) -> FingerLoad {
    let object = &model.objects[index];
    let mut sum = FingerLoad {
        holds: true,
        ..FingerLoad::default()
    };
    for (finger, state) in model.fingers.iter().zip(fingers) {
        let contacts = state.contacts.on(index);
        if contacts.is_empty() {
            continue;
        }
        let seen = seen(state);
        let turned = seen.turn_since(&state.rolled[index]);
        for (share, block) in contacts.blocks() {
            let mut load: Column = [0.0; BLOCK];
            let (mut stiffness, mut spare) = (load, load);
            if let Some(spring) = &finger.springs {
                let spring = spring.as_spring();
                let friction = friction(&spring, object, own);
                for lane in 0..share.lanes.min(BLOCK) {
                    let anchor = spring.rolled(&block.anchor(lane), turned);
                    let axis = block.axis(lane);
                    let tip = tip_of(finger.dome_radius, &seen, axis, DVec3::ZERO);
                    let still = (DVec3::ZERO, model.step);
                    let grip = contact_grip(&spring, friction, &tip, &anchor, still, freedom);
                    (load[lane], stiffness[lane], spare[lane]) = grip;
                }
            } else {
                for lane in 0..share.count {
                    let element = block.element(lane);
                    let feeler = &finger.feelers[element];
                    let anchor = feeler.rolled(&block.anchor(lane), turned);
                    let tip = undeformed(finger, &state.sets, &seen, element);
                    let moved = (tip.position - block.tip_before(lane), model.step);
                    let friction = friction(feeler, object, own);
                    let grip = contact_grip(feeler, friction, &tip, &anchor, moved, freedom);
                    (load[lane], stiffness[lane], spare[lane]) = grip;
                    // What is more than a spring may grow stiffer on the way.
                    if !feeler.is_spring() {
                        spare[lane] = 0.0;
                    }
                }
            }
            for lane in 0..share.count {
                sum.load += load[lane];
                sum.stiffness += stiffness[lane];
                sum.holds &= spare[lane] > 0.0;
            }
        }
    }
    sum
}

/// What one feeler does to an object along one of its freedoms, holding on: load, by how much that falls as the object gives way (exact for
/// a spring that holds on, else about), and how much more shear it could bear (as a difference of squares, N^2). `moved` is by how much
/// its tip has moved, m, and in which time, s.
#[inline(always)]
fn contact_grip(
    feeler: &FeelerConfig,
    friction: Friction,
    tip: &Tip,
    anchor: &Anchor,
    (moved, duration): (DVec3, f64),
    freedom: Freedom,
) -> (f64, f64, f64) {
    let mut force = feeler.elastic_force(tip, anchor.position);
    let point = feeler.contact_point(anchor);
    let stretch = tip.position - anchor.position - tip.set;
    // Velocity of the contact point, and by how much load and force fall; all per rate of the freedom. The finger stands still.
    let (way, mut force_falls, load_falls) = match freedom {
        Freedom::Along(way) => (way, feeler.stiffness_times(tip.axis, way), 0.0),
        Freedom::Around(sinking) => {
            // As the object sees it, tip and axis turn, and the tip rolls; so the arm of the force changes, too.
            let tip_moves = z_cross(point + stretch) - sinking * DVec3::Z;
            let axis_turns = z_cross(tip.axis);
            let turns = axis_turns.dot(stretch) * tip.axis + tip.axis.dot(stretch) * axis_turns;
            let stiffer = feeler.normal_stiffness - feeler.shear_stiffness;
            let force_falls = feeler.stiffness_times(tip.axis, tip_moves) + stiffer * turns;
            let arm_grows = feeler.tip_radius * anchor.normal.with_z(0.0);
            (z_cross(point), force_falls, -arm_grows.dot(force))
        }
    };
    if feeler.is_damped() {
        let velocity = moved / duration;
        force = within_cone(force, anchor.normal, friction);
        force += feeler.damping_times(tip.axis, velocity);
        force_falls += feeler.damping_times(tip.axis, way) / duration;
    }
    let (normal_force, shear) = split(force, anchor.normal);
    let most = friction.static_friction * normal_force.max(0.0);
    let spare = most * most - shear.length_squared();
    let force = within_cone(force, anchor.normal, friction);
    let stiffness = (way.dot(force_falls) + load_falls).max(0.0);
    (way.dot(force), stiffness, spare)
}

/// The unit vector along z times `vector`.
#[inline(always)]
fn z_cross(vector: DVec3) -> DVec3 {
    DVec3::new(-vector.y, vector.x, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::Screw;
    use glam::DMat3;

    /// Load and stiffness of a feeler that leans on the side of what turns, after that has turned by `angle`, rad, sinking by 0.5 mm/rad.
    fn load_after(angle: f64) -> (f64, f64, f64) {
        let feeler = FeelerConfig::default();
        let sinking = 0.5e-3;
        let fingertip = Pose {
            position: DVec3::new(0.033, 0.002, 0.001),
            rotation: DMat3::from_rotation_y(-2.9) * DMat3::from_rotation_x(0.2),
        };
        let (sine, cosine) = angle.sin_cos();
        let screw = Screw {
            sine,
            cosine,
            advance: -sinking * angle,
        };
        let seen = screw.seen_after(&fingertip);
        let axis = DVec3::new(0.98, 0.1, -0.17).normalize();
        let tip = |seen| tip_of(0.019, seen, axis, DVec3::ZERO);
        // Pressed in by 0.8 mm, and pushed aside by 0.5.
        let normal = DVec3::new(0.96, 0.28, 0.0);
        let aside = DVec3::new(-0.07, 0.24, 0.43);
        let anchor = Anchor {
            position: tip(&fingertip).position + 1e-3 * (0.8 * normal + aside),
            normal,
        };
        let anchor = feeler.rolled(&anchor, seen.turn_since(&fingertip.rotation));
        let still = (DVec3::ZERO, 1e-3);
        let friction = Friction {
            static_friction: 5.0,
            ..feeler.friction()
        };
        let freedom = Freedom::Around(sinking);
        contact_grip(&feeler, friction, &tip(&seen), &anchor, still, freedom)
    }

    #[test]
    fn the_stiffness_about_the_axis_is_how_the_load_falls() {
        let (load, stiffness, spare) = load_after(0.0);
        assert!(load.abs() > 1e-4 && spare > 0.0, "{load} N m, {spare}");
        // Of central differences the error is some h^2, and rounding 1e-16 / h of the load.
        let h = 1e-5;
        let falls = (load_after(-h).0 - load_after(h).0) / (2.0 * h);
        assert!(
            (falls - stiffness).abs() < 1e-6 * stiffness,
            "{falls} N m/rad, not {stiffness}"
        );
    }
}
