//! A fingertip seen from outside along its axis, with the forces on its elements.
//!
//! The apex is in the middle, y of `T` points right, z up. The distance of an element from the middle is proportional
//! to the angle between its normal and the axis.

use super::palette::{ARROW, BAD, FRAME, QUIET, SLIPPING, heat};
use crate::snapshot::Finger;
use feeler::control::FlagThresholds;
use feeler::sensor::fingertip::SensingElement;
use glam::{DVec2, Vec3Swizzles};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::Span;
use ratatui::widgets::canvas::{Canvas, Context, Line};
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_4, TAU};

/// Radius of the outermost elements, as a fraction of the rim's.
const OUTERMOST: f64 = 0.87;
/// Compression below which an element is drawn as unloaded (N).
const MIN_COMPRESSION: f64 = 0.02;
/// Tangential force below which no arrow is drawn (N).
const MIN_SHEAR: f64 = 0.03;
/// Maximum arrow length, as a fraction of the rim's radius: about the distance between rings.
const LONGEST_ARROW: f64 = 0.4;
/// Minimum arrow length, as a fraction of the maximum, so that the head is outside the element's cell on most screens.
const SHORTEST_ARROW: f64 = 0.45;
/// Arrow heads counter-clockwise from the right, 45 degrees apart.
const ARROWS: [&str; 8] = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];
/// Radius of the rim (in cell widths) from which loaded elements are drawn with their number.
const RADIUS_OF_NUMBERS: f64 = 15.0;
/// Number of line segments of the rim.
const RIM_LINES: u32 = 90;

/// An element as drawn; positions and arrows are fractions of the rim's radius.
struct Mark {
    element: usize,
    position: DVec2,
    /// Tangential force; zero to draw no arrow.
    arrow: DVec2,
    /// Compression (N).
    compression: f64,
    slips: bool,
    is_largest: bool,
}

impl Mark {
    fn is_pressed(&self) -> bool {
        self.compression > MIN_COMPRESSION
    }
}

/// Draws the elements of `finger`: colour shows compression, arrows show the tangential force on the feeler by the
/// object, and the element with the largest force is marked.
pub fn draw_dome(frame: &mut Frame, area: Rect, finger: &Finger) {
    if area.width < 5 || area.height < 3 {
        return;
    }
    let marks = marks(finger);
    // An odd width makes the drawing symmetric.
    let width = (area.width - 1) | 1;
    let area = Rect { width, ..area };
    // One unit per cell, so that each glyph is drawn in the intended cell. A cell is twice as high as wide.
    let (right, top) = (f64::from(area.width - 1), f64::from(area.height - 1));
    let radius = (right / 2.0).min(top);
    let place = |p: DVec2| DVec2::new(right / 2.0 + radius * p.x, top / 2.0 + radius * p.y / 2.0);
    let canvas = Canvas::default()
        .marker(Marker::Braille)
        .x_bounds([0.0, right])
        .y_bounds([0.0, top])
        .paint(|context| {
            draw_rim(context, place);
            let with_number = radius >= RADIUS_OF_NUMBERS;
            let elements = |context: &mut Context, pressed: bool| {
                for mark in marks.iter().filter(|mark| mark.is_pressed() == pressed) {
                    draw_element(context, mark, &finger.thresholds, with_number, place);
                }
            };
            // Arrows cover unloaded elements; loaded elements cover arrows.
            elements(context, false);
            for mark in &marks {
                draw_arrow(context, mark, place);
            }
            elements(context, true);
        });
    frame.render_widget(canvas, area);
}

/// Returns the arrow head that points along `direction`, with y up.
pub fn arrow_head(direction: DVec2) -> &'static str {
    let eighth = (direction.to_angle().rem_euclid(TAU) / FRAC_PI_4).round();
    ARROWS[eighth as usize % ARROWS.len()]
}

/// Returns the tangential part of `force` (in `E_i`) as seen along the axis of `T`. It has its full length, without
/// foreshortening far from the apex. Returns zero if it is too small to be shown.
pub fn seen_shear(element: &SensingElement, force: glam::DVec3) -> DVec2 {
    let shear = force.xy();
    if !shear.is_finite() || shear.length() < MIN_SHEAR {
        return DVec2::ZERO;
    }
    let x = element.rotation.x_axis.yz().normalize_or_zero();
    let y = element.rotation.y_axis.yz().normalize_or_zero();
    shear.length() * (shear.x * x + shear.y * y).normalize_or_zero()
}

/// Returns the elements sorted by compression, so that the largest is drawn on top.
fn marks(finger: &Finger) -> Vec<Mark> {
    let outermost = finger.elements.iter().map(polar_angle).fold(0.1, f64::max);
    let thresholds = &finger.thresholds;
    let forces = finger.elements.iter().zip(&finger.forces).enumerate();
    let mut marks: Vec<Mark> = forces
        .map(|(index, (element, &force))| {
            let outward = element.normal().yz().normalize_or_zero();
            let rate = finger.shear_rates.get(index).copied().unwrap_or(0.0);
            Mark {
                element: index,
                position: OUTERMOST / outermost * polar_angle(element) * outward,
                arrow: arrow(seen_shear(element, force), thresholds.over_force),
                compression: force.z,
                slips: rate > thresholds.slip_threshold,
                is_largest: finger.flags.largest_element == Some(index),
            }
        })
        .collect();
    marks.sort_by(|a, b| {
        let pressed = a.compression.total_cmp(&b.compression);
        a.is_largest.cmp(&b.is_largest).then(pressed)
    });
    marks
}

/// Returns the angle between the dome's axis and the element's normal (rad).
fn polar_angle(element: &SensingElement) -> f64 {
    let normal = element.normal();
    let angle = normal.yz().length().atan2(normal.x);
    if angle.is_finite() { angle } else { 0.0 }
}

/// Returns the arrow of the tangential force `shear` (N). It reaches its maximum length at half of `over_force`.
fn arrow(shear: DVec2, over_force: f64) -> DVec2 {
    let part = 2.0 * shear.length() / over_force;
    let part = if part.is_finite() {
        part.clamp(SHORTEST_ARROW, 1.0)
    } else {
        1.0
    };
    LONGEST_ARROW * part * shear.normalize_or_zero()
}

fn draw_rim(context: &mut Context, place: impl Fn(DVec2) -> DVec2) {
    let at = |line: u32| {
        place(DVec2::from_angle(
            TAU * f64::from(line) / f64::from(RIM_LINES),
        ))
    };
    for line in 0..RIM_LINES {
        draw_line(context, at(line), at(line + 1), FRAME);
    }
}

fn draw_arrow(context: &mut Context, mark: &Mark, place: impl Fn(DVec2) -> DVec2) {
    if mark.arrow == DVec2::ZERO {
        return;
    }
    let style = if mark.slips { SLIPPING } else { ARROW };
    let start = place(mark.position);
    let mut end = place(mark.position + mark.arrow);
    draw_line(context, start, end, style);
    if end.round() == start.round() {
        end = start.round() + mark.arrow.normalize_or_zero().round();
    }
    print(context, end, arrow_head(mark.arrow), style);
}

fn draw_element(
    context: &mut Context,
    mark: &Mark,
    thresholds: &FlagThresholds,
    with_number: bool,
    place: impl Fn(DVec2) -> DVec2,
) {
    let (at, force) = (place(mark.position), mark.compression);
    let hot = heat(force / thresholds.over_force).add_modifier(Modifier::BOLD);
    match force {
        _ if !force.is_finite() => print(context, at, "?", BAD),
        _ if force > thresholds.touch_force && with_number => {
            let number = format!("{:^3}", mark.element);
            print(
                context,
                at - DVec2::X,
                number,
                hot.add_modifier(Modifier::REVERSED),
            );
            if mark.is_largest {
                print(context, at - 2.0 * DVec2::X, "[", hot);
                print(context, at + 2.0 * DVec2::X, "]", hot);
            }
        }
        _ if mark.is_largest => print(context, at, "◉", hot),
        _ if force > thresholds.touch_force => print(context, at, "●", hot),
        _ if force > MIN_COMPRESSION => print(context, at, "∘", heat(0.0)),
        _ => print(context, at, "·", QUIET),
    }
}

fn draw_line(context: &mut Context, from: DVec2, to: DVec2, style: Style) {
    let color = style.fg.unwrap_or_default();
    context.draw(&Line::new(from.x, from.y, to.x, to.y, color));
}

/// Prints `text`, starting in the cell around `at`.
fn print(context: &mut Context, at: DVec2, text: impl Into<Cow<'static, str>>, style: Style) {
    let at = at.round();
    context.print(at.x, at.y, Span::styled(text, style));
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn heads_point_along_their_arrows() {
        for (eighth, &head) in ARROWS.iter().enumerate() {
            for off in [-20_f64, 0.0, 20.0] {
                let direction = DVec2::from_angle(FRAC_PI_4 * eighth as f64 + off.to_radians());
                assert_eq!(arrow_head(direction), head);
            }
        }
        assert_eq!(ARROWS.len(), 8);
        let _ = arrow_head(DVec2::NAN);
    }

    /// At the side of the dome, x (the meridian) points outward, and y (the parallel) around the apex.
    #[test]
    fn shear_is_seen_along_meridian_and_parallel() {
        for azimuth in [0.0_f64, 1.0, 2.5, -2.0] {
            let (sin, cos) = azimuth.sin_cos();
            let normal = DVec3::new(0.5, 0.75_f64.sqrt() * cos, 0.75_f64.sqrt() * sin);
            let element = SensingElement::facing(normal);
            let outward = seen_shear(&element, DVec3::new(0.4, 0.0, 1.0));
            assert!(outward.distance(0.4 * DVec2::new(cos, sin)) < 1e-12);
            let around = seen_shear(&element, DVec3::new(0.0, 0.4, 1.0));
            assert!(around.distance(0.4 * DVec2::new(-sin, cos)) < 1e-12);
        }
        let apex = SensingElement::facing(DVec3::X);
        assert_eq!(seen_shear(&apex, DVec3::new(0.01, 0.0, 1.0)), DVec2::ZERO);
        assert_eq!(seen_shear(&apex, DVec3::NAN), DVec2::ZERO);
    }
}
