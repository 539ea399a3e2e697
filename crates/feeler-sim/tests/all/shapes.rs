//! Shapes of objects, compared with brute force, the geometry library and finite differences.

use feeler_sim::shapes::{KnurledCylinder, shape};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::path::Path;

const RADIUS: f64 = 0.014;
const HEIGHT: f64 = 0.020;

#[derive(Debug, Clone, Copy)]
struct Shape {
    knurls: u32,
    depth: f64,
    ovality: f64,
}

impl Shape {
    fn build(self) -> KnurledCylinder {
        KnurledCylinder::new(RADIUS, HEIGHT, self.knurls, self.depth, self.ovality)
    }

    fn curve(self, angle: f64) -> DVec2 {
        let wave = (f64::from(self.knurls) * angle).cos() - 1.0;
        let oval = 1.0 + self.ovality * (2.0 * angle).cos();
        (RADIUS * oval + self.depth / 2.0 * wave) * DVec2::from_angle(angle)
    }

    /// Signed distance from the curve in the plane, negative inside: the best of dense samples, refined by
    /// golden-section search.
    fn distance_in_plane(self, point: DVec2) -> f64 {
        let count = 200 * self.knurls.max(20);
        let step = TAU / f64::from(count);
        let at = |angle: f64| self.curve(angle).distance(point);
        let samples: Vec<f64> = (0..count).map(|k| at(f64::from(k) * step)).collect();
        let least = samples.iter().copied().fold(f64::INFINITY, f64::min);
        let mut best = least;
        for (k, _) in samples
            .iter()
            .enumerate()
            .filter(|(_, d)| **d < least + 1e-5)
        {
            let (mut low, mut high) = ((k as f64 - 1.0) * step, (k as f64 + 1.0) * step);
            for _ in 0..60 {
                let (a, b) = (low + (high - low) * 0.382, low + (high - low) * 0.618);
                if at(a) < at(b) { high = b } else { low = a }
            }
            best = best.min(at(low));
        }
        let inside = point.length() < self.curve(point.to_angle()).length();
        if inside { -best } else { best }
    }

    fn distance(self, point: DVec3) -> f64 {
        let side = self.distance_in_plane(point.truncate());
        let end = point.z.abs() - HEIGHT / 2.0;
        if side > 0.0 && end > 0.0 {
            side.hypot(end)
        } else {
            side.max(end)
        }
    }
}

fn shapes() -> impl Strategy<Value = Shape> {
    let knurls = prop_oneof![0_u32..=6, 0_u32..=130];
    let depth = prop_oneof![Just(0.0), 0.0..0.0005_f64];
    let ovality = prop_oneof![Just(0.0), -0.03..0.03_f64, -0.3..0.3_f64];
    (knurls, depth, ovality).prop_map(|(knurls, depth, ovality)| Shape {
        knurls,
        depth,
        ovality,
    })
}

fn cylindrical(
    radius: std::ops::Range<f64>,
    z: std::ops::Range<f64>,
) -> impl Strategy<Value = DVec3> {
    (radius, 0.0..TAU, z).prop_map(|(r, angle, z)| (r * DVec2::from_angle(angle)).extend(z))
}

fn points() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        3 => cylindrical(0.0125..0.0160, -0.009..0.009),
        1 => cylindrical(0.0120..0.0160, 0.008..0.012),
        1 => cylindrical(0.0..0.040, -0.030..0.030),
        1 => cylindrical(0.0..0.001, -0.010..0.010),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Golden-section search ends within 1e-12 m of the exact distance.
    #[test]
    fn the_distance_from_a_knurled_cylinder_matches_brute_force(shape in shapes(), point in points()) {
        let nearest = shape.build().nearest(point).unwrap();
        let expected = shape.distance(point);
        prop_assert!((nearest.distance - expected).abs() < 1e-10, "{nearest:?} {expected}");
        let back = nearest.position + nearest.distance * nearest.normal;
        prop_assert!((back - point).length() < 1e-9, "{nearest:?}");
        prop_assert!((nearest.normal.length() - 1.0).abs() < 1e-12);
        prop_assert!(shape.distance(nearest.position).abs() < 1e-10);
    }

    #[test]
    fn the_distance_is_lipschitz_continuous(
        shape in shapes(),
        point in points(),
        angle in 0.0..TAU,
        up in -1.0..1.0_f64,
        move_by in 1e-7..2e-3_f64,
    ) {
        let cylinder = shape.build();
        let other = point + move_by * DVec2::from_angle(angle).extend(up).normalize();
        let change = cylinder.nearest(point).unwrap().distance - cylinder.nearest(other).unwrap().distance;
        prop_assert!(change.abs() <= move_by + 1e-12, "{change} over {move_by}");
    }

    /// Central differences over 2e-8 m; points with two equally near surface points have no gradient and are skipped.
    #[test]
    fn the_normal_is_the_gradient_of_the_distance(shape in shapes(), point in points()) {
        let cylinder = shape.build();
        let nearest = cylinder.nearest(point).unwrap();
        let h = 1e-8;
        let at = |p: DVec3| cylinder.nearest(p).unwrap();
        let smooth = DVec3::AXES.into_iter().all(|e| {
            (at(point + h * e).normal - at(point - h * e).normal).length() < 1e-3
        });
        prop_assume!(smooth);
        let slope = |e: DVec3| (at(point + h * e).distance - at(point - h * e).distance) / (2.0 * h);
        let gradient = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
        prop_assert!((gradient - nearest.normal).length() < 1e-4, "{gradient} {}", nearest.normal);
    }

    #[test]
    fn without_knurls_and_ovality_the_shape_equals_a_cylinder(point in points(), knurls in 0_u32..120) {
        let ours = KnurledCylinder::new(RADIUS, HEIGHT, knurls, 0.0, 0.0).nearest(point).unwrap();
        let config = shape::ShapeConfig::Cylinder {
            radius: RADIUS,
            height: HEIGHT,
        };
        let plain = shape::Shape::new(&config, Path::new("")).unwrap();
        let plain = plain.nearest(point).unwrap();
        prop_assert!((ours.distance - plain.distance).abs() < 1e-14);
        // Deep inside, several surface points may be equally near.
        if plain.distance > -0.002 {
            prop_assert!((ours.position - plain.position).length() < 1e-12);
        }
    }
}

#[test]
fn points_on_side_and_ends_have_a_normal_and_points_on_the_rim_do_not() {
    let cylinder = KnurledCylinder::new(RADIUS, HEIGHT, 60, 0.0004, 0.0);
    let side = cylinder.nearest(DVec3::new(RADIUS, 0.0, 0.0)).unwrap();
    assert!(side.distance.abs() < 1e-15 && (side.normal - DVec3::X).length() < 1e-12);
    let end = cylinder
        .nearest(DVec3::new(0.003, 0.0, -HEIGHT / 2.0))
        .unwrap();
    assert!(end.distance.abs() < 1e-15 && end.normal == DVec3::NEG_Z);
    assert_eq!(
        cylinder.nearest(DVec3::new(RADIUS, 0.0, HEIGHT / 2.0)),
        None
    );
    assert_eq!(cylinder.nearest(DVec3::NAN), None);
    assert_eq!(cylinder.nearest(DVec3::INFINITY), None);
}
