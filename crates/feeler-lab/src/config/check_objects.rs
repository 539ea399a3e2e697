//! What every value of an object must be. Files of shapes are looked at when they are read.

use super::check_sim::check_friction;
use super::checker::{Checker, MAX};
use feeler_sim::object::{FreeConfig, MotionConfig, ObjectConfig};
use feeler_sim::shape::ShapeConfig;
use feeler_sim::thread::ThreadFault;

/// Most knurls around a cylinder: finer ones than a feeler could ever feel.
const MAX_KNURLS: u32 = 10_000;

/// Most corners of a section: each becomes hundreds when it is rounded.
const MAX_CORNERS: usize = 32;

pub(super) fn check_object(key: &str, object: &ObjectConfig, checker: &mut Checker) {
    checker.vector(&format!("{key}.position"), object.position);
    checker.vector(&format!("{key}.offset"), object.offset);
    for (axis, angle) in ["x", "y", "z"].into_iter().zip(object.orientation_deg) {
        checker.between(
            &format!("{key}.orientation_deg.{axis}"),
            angle,
            -360.0,
            360.0,
        );
    }
    if let Some(friction) = object.friction {
        check_friction(&format!("{key}.friction"), friction, checker);
    }
    check_shape(&format!("{key}.shape"), &object.shape, checker);
    match &object.motion {
        MotionConfig::Fixed => {}
        MotionConfig::Hinge(hinge) => {
            let key = format!("{key}.motion.hinge");
            checker.not_negative(&format!("{key}.running_torque"), hinge.running_torque);
            checker.between(
                &format!("{key}.static_factor"),
                hinge.static_factor,
                1.0,
                10.0,
            );
        }
        MotionConfig::Thread(thread) => {
            let key = format!("{key}.motion.thread");
            checker.between(&format!("{key}.seat_angle"), thread.seat_angle, -10.0, MAX);
            if let Some(ThreadFault::CrossThreaded { angle, stiffness }) = &thread.fault {
                let key = format!("{key}.fault.cross_threaded");
                checker.between(&format!("{key}.angle"), *angle, -10.0, MAX);
                checker.positive(&format!("{key}.stiffness"), *stiffness);
            }
            let not_negative = [
                ("running_torque", thread.running_torque),
                ("seat_stiffness", thread.seat_stiffness),
                ("lead", thread.lead),
            ];
            for (field, value) in not_negative {
                checker.not_negative(&format!("{key}.{field}"), value);
            }
            checker.between(
                &format!("{key}.static_factor"),
                thread.static_factor,
                1.0,
                10.0,
            );
        }
        MotionConfig::Free(free) => check_free(key, &object.shape, free, checker),
    }
}

fn check_free(key: &str, shape: &ShapeConfig, free: &FreeConfig, checker: &mut Checker) {
    checker.require(
        &format!("{key}.shape"),
        "half_space".to_string(),
        *shape != ShapeConfig::HalfSpace,
        "a shape of finite mass, because the object is free",
    );
    let key = format!("{key}.motion.free");
    checker.positive(&format!("{key}.density"), free.density);
    checker.not_negative(&format!("{key}.friction"), free.friction);
    if let Some(mass) = free.mass {
        checker.positive(&format!("{key}.mass"), mass);
    }
    let Some(inertia) = free.inertia else { return };
    let [x, y, z] = inertia;
    let good = inertia.iter().all(|&i| i > 0.0) && x <= y + z && y <= z + x && z <= x + y;
    checker.require(
        &format!("{key}.inertia"),
        format!("{inertia:?}"),
        good,
        "three moments more than 0, none of which exceeds the sum of the other two",
    );
}

fn check_shape(key: &str, shape: &ShapeConfig, checker: &mut Checker) {
    let mut positive = |kind: &str, fields: &[(&str, f64)]| {
        for (field, value) in fields {
            checker.between(&format!("{key}.{kind}.{field}"), *value, 1e-6, 10.0);
        }
    };
    match *shape {
        ShapeConfig::Cylinder { radius, height } => {
            positive("cylinder", &[("radius", radius), ("height", height)]);
        }
        ShapeConfig::KnurledCylinder {
            radius,
            height,
            knurls,
            depth,
            ovality,
        } => {
            positive(
                "knurled_cylinder",
                &[("radius", radius), ("height", height)],
            );
            let key = format!("{key}.knurled_cylinder");
            checker.between(&format!("{key}.depth"), depth, 0.0, 0.2 * radius);
            checker.between(&format!("{key}.ovality"), ovality, -0.3, 0.3);
            checker.require(
                &format!("{key}.knurls"),
                knurls.to_string(),
                knurls <= MAX_KNURLS,
                &format!("0 to {MAX_KNURLS}"),
            );
        }
        ShapeConfig::EllipticCylinder {
            semi_axes: [x, y],
            height,
        } => {
            let fields = [("semi_axes.x", x), ("semi_axes.y", y), ("height", height)];
            positive("elliptic_cylinder", &fields);
        }
        ShapeConfig::RoundedPrism {
            ref corners,
            rounding,
            height,
        } => {
            positive(
                "rounded_prism",
                &[("rounding", rounding), ("height", height)],
            );
            checker.require(
                &format!("{key}.rounded_prism.corners"),
                format!("{} corners", corners.len()),
                (1..=MAX_CORNERS).contains(&corners.len())
                    && corners.iter().flatten().all(|c| c.abs() <= 10.0),
                &format!("1 to {MAX_CORNERS} corners, each of two numbers from -10 to 10"),
            );
        }
        ShapeConfig::Box { size: [x, y, z] } => {
            positive("box", &[("size.x", x), ("size.y", y), ("size.z", z)]);
        }
        ShapeConfig::Sphere { radius } => positive("sphere", &[("radius", radius)]),
        ShapeConfig::Capsule { radius, length } => {
            positive("capsule", &[("radius", radius), ("length", length)]);
        }
        ShapeConfig::HalfSpace => {}
        ShapeConfig::ConvexHull { scale, .. } => positive("convex_hull", &[("scale", scale)]),
        ShapeConfig::Mesh { scale, .. } => positive("mesh", &[("scale", scale)]),
    }
}
