//! Contact law of one feeler on a flat face: stick, slip and hold.

use crate::bodies::scene::fixed;
use feeler_sim::contact::{Anchor, FeelerConfig, Overload, Tip};
use feeler_sim::objects::Object;
use feeler_sim::shapes::shape::ShapeConfig;
use glam::DVec3;
use std::path::Path;

pub const FEELER: FeelerConfig = FeelerConfig {
    normal_stiffness: 1150.0,
    shear_stiffness: 460.0,
    tip_radius: 0.0015,
    static_friction: 1.0,
    kinetic_friction: 0.65,
    stribeck_speed: 0.0,
    normal_damping: 0.0,
    shear_damping: 0.0,
    normal_shear_coupling: 0.0,
    length_limit: None,
    relaxation: None,
};
/// Compression of the feeler (m).
const DEPTH: f64 = 0.0004;
const SPEED: f64 = 0.010;
/// Rounding error of a few operations on forces of about 1 N.
const ROUNDING: f64 = 1e-12;

/// A fixed upright cylinder about the origin.
pub fn cylinder(radius: f64, height: f64) -> Object {
    of_shape(ShapeConfig::Cylinder { radius, height })
}

/// The flat top of a disc of 1 m radius, which is effectively infinite for motions of millimetres.
fn flat() -> Object {
    cylinder(1.0, 0.02)
}

/// Anchor of a free feeler's new contact, or `None` if it does not touch.
pub fn hold(feeler: &FeelerConfig, object: &Object, tip: &Tip) -> Option<Anchor> {
    let surface = object.nearest(tip.position)?;
    (surface.distance < feeler.tip_radius).then(|| feeler.anchor(&surface))
}

/// Anchor and force after slip has settled under a steady or sudden overload.
pub fn settle(
    feeler: &FeelerConfig,
    object: &Object,
    tip: &Tip,
    anchor: Anchor,
    overload: Overload,
) -> Option<(Anchor, DVec3)> {
    feeler.settle(object, feeler.friction(), tip, anchor, overload)
}

/// A feeler that points straight down, is compressed by [`DEPTH`] and is at `x` along the face.
fn tip(x: f64) -> Tip {
    Tip {
        position: DVec3::new(x, 0.0, 0.01 + FEELER.tip_radius - DEPTH),
        axis: DVec3::NEG_Z,
        set: DVec3::ZERO,
    }
}

fn pressed(object: &Object) -> Anchor {
    hold(&FEELER, object, &tip(0.0)).expect("contact")
}

#[test]
fn a_pressed_feeler_pushes_with_its_normal_stiffness_and_no_shear() {
    let object = flat();
    let (_, force) = settle(
        &FEELER,
        &object,
        &tip(0.0),
        pressed(&object),
        Overload::Sudden,
    )
    .expect("contact");
    let expected = -FEELER.normal_stiffness * DEPTH * DVec3::Z;
    assert!((force - expected).length() < ROUNDING, "{force}");
}

#[test]
fn a_dragged_feeler_follows_the_stick_slip_sawtooth_at_any_step_size() {
    let object = flat();
    let normal_force = FEELER.normal_stiffness * DEPTH;
    let most = FEELER.static_friction * normal_force;
    let drop = most - FEELER.kinetic_friction * normal_force;
    // Closed form: the shear force rises at k_t v; at the static limit it drops to the kinetic
    // one, so its period is (mu_s - mu_k) F_n / (k_t v), 35 ms here.
    let sawtooth = |x: f64| {
        let stuck = FEELER.shear_stiffness * x;
        if stuck <= most {
            stuck
        } else {
            most - drop + (stuck - most) % drop
        }
    };
    for step in [0.001, 0.0003, 0.0071] {
        let mut anchor = pressed(&object);
        let (mut slips, mut before) = (0, 0.0);
        while before < 2.0 {
            let x = before + SPEED * step;
            let (next, force) =
                settle(&FEELER, &object, &tip(x), anchor, Overload::Steady).expect("contact");
            assert!((force.z + normal_force).abs() < ROUNDING && force.y == 0.0);
            // A slip ends within 1e-9 of the normal force, and the next begins there.
            slips += u32::from(next != anchor);
            let tolerance = 1e-9 * normal_force * f64::from(slips + 1);
            let expected = sawtooth(x);
            let off = (force.x - expected).abs();
            assert!(
                off.min(drop - off) < tolerance,
                "{} N, not {expected} N",
                force.x
            );
            (anchor, before) = (next, x);
            if slips == 60 {
                break;
            }
        }
        assert_eq!(slips, 60);
    }
}

#[test]
fn a_suddenly_overloaded_feeler_drops_to_the_kinetic_limit() {
    let object = flat();
    let normal_force = FEELER.normal_stiffness * DEPTH;
    let x = 1.3 * FEELER.static_friction * normal_force / FEELER.shear_stiffness;
    let (_, force) = settle(
        &FEELER,
        &object,
        &tip(x),
        pressed(&object),
        Overload::Sudden,
    )
    .expect("contact");
    let expected = FEELER.kinetic_friction * normal_force;
    assert!((force.x - expected).abs() < 1e-9 * normal_force, "{force}");
}

#[test]
fn a_feeler_at_rest_holds_its_shear_without_creep() {
    let object = flat();
    // Just below the static limit.
    let x =
        0.999 * FEELER.static_friction * FEELER.normal_stiffness * DEPTH / FEELER.shear_stiffness;
    let (mut anchor, start) = settle(
        &FEELER,
        &object,
        &tip(x),
        pressed(&object),
        Overload::Sudden,
    )
    .expect("contact");
    for _ in 0..10_000 {
        let (next, force) =
            settle(&FEELER, &object, &tip(x), anchor, Overload::Sudden).expect("contact");
        assert_eq!((next, force), (anchor, start));
        anchor = next;
    }
}

#[test]
fn a_lifted_feeler_separates_and_never_pulls() {
    let object = flat();
    let mut anchor = Some(pressed(&object));
    for n in 0..=10 {
        let lift = 0.0001 * f64::from(n);
        let mut tip = tip(0.0);
        tip.position.z += lift;
        let settled =
            anchor.and_then(|anchor| settle(&FEELER, &object, &tip, anchor, Overload::Sudden));
        let force = settled.map_or(0.0, |(_, force)| force.z);
        let expected = -FEELER.normal_stiffness * (DEPTH - lift).max(0.0);
        assert!((force - expected).abs() < ROUNDING, "{force} N at {lift} m");
        anchor = settled.map(|(anchor, _)| anchor);
    }
    assert_eq!(anchor, None);
    assert_eq!(
        hold(
            &FEELER,
            &object,
            &Tip {
                position: DVec3::Z,
                ..tip(0.0)
            }
        ),
        None
    );
}

fn of_shape(shape: ShapeConfig) -> Object {
    Object::new("object", &fixed(shape), 0.0, Path::new("")).expect("an object")
}

/// Shear in excess of the kinetic limit after sudden slips, relative to the normal force.
///
/// The tips press on the side of an object of about 14 mm radius from all around and are displaced by up to 2 mm, which
/// overloads most of them. An entry is `None` if the tip sticks or separates.
fn left_over(object: &Object) -> Vec<Option<f64>> {
    let feeler = FeelerConfig::default();
    let mut left = Vec::new();
    for step in 0..3_000 {
        let turn = f64::from(step) * 0.618;
        let (sine, cosine) = turn.sin_cos();
        let outward = DVec3::new(cosine, sine, 0.0);
        let around = DVec3::new(-sine, cosine, 0.0);
        let pressed = Tip {
            position: (0.0155 - 1e-4 * f64::from(step % 7)) * outward,
            axis: (-outward + 0.3 * DVec3::Z).normalize(),
            set: DVec3::ZERO,
        };
        let anchor = hold(&feeler, object, &pressed).expect("contact");
        let way = 1e-3 * (0.4 + 1.6 * f64::from(step % 89) / 89.0);
        let aside = (around + f64::from(step % 5 - 2) * DVec3::Z).normalize();
        let pushed = Tip {
            position: pressed.position + way * aside,
            ..pressed
        };
        let settled = settle(&feeler, object, &pushed, anchor, Overload::Sudden);
        left.push(settled.and_then(|(after, force)| {
            let normal_force = -force.dot(after.normal);
            let shear = (force + normal_force * after.normal).length();
            (after != anchor).then_some(shear / normal_force - feeler.kinetic_friction)
        }));
    }
    left
}

#[test]
fn a_slip_ends_at_the_kinetic_limit_on_smooth_and_grooved_surfaces() {
    let knurled = |knurls, depth, ovality| ShapeConfig::KnurledCylinder {
        radius: 0.014,
        height: 0.03,
        knurls,
        depth,
        ovality,
    };
    let round = ShapeConfig::Cylinder {
        radius: 0.014,
        height: 0.03,
    };
    for shape in [
        round,
        ShapeConfig::Sphere { radius: 0.014 },
        knurled(0, 0.0, 0.03),
    ] {
        let slips: Vec<_> = left_over(&of_shape(shape)).into_iter().flatten().collect();
        assert!(slips.len() > 300);
        // A slip ends within 1e-9 of the normal force.
        assert!(slips.iter().all(|left| left.abs() < 2e-9));
    }
    // A tip is wider than these grooves and jumps from crest to crest. The iterations neglect the curvature of a crest:
    // after sixteen, up to 0.5 % of the normal force remains, which the next balance iteration removes.
    for knurls in [60, 120] {
        let slips = left_over(&of_shape(knurled(knurls, 0.0003, 0.0)));
        let slips: Vec<_> = slips.into_iter().flatten().collect();
        assert!(slips.len() > 300);
        assert!(slips.iter().all(|&left| left < 0.01));
    }
}
