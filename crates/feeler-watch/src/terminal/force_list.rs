//! List of the elements with the largest compression.

use super::dome::{arrow_head, seen_shear};
use super::palette::{ARROW, QUIET, SLIPPING, TITLE, heat, heat_scale};
use super::words::number;
use crate::snapshot::Finger;
use glam::{DVec2, DVec3, Vec3Swizzles};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span, Text};

/// Preferred width of the list.
pub const WIDTH: u16 = 18;
/// Minimum width at which all three components are shown.
const WIDTH_OF_COMPONENTS: u16 = 29;
/// Minimum compression of listed elements (N).
const MIN_COMPRESSION: f64 = 0.02;
/// Minimum height at which the legend is shown.
const HEIGHT_OF_LEGEND: u16 = 14;

/// Lists the elements of `finger` with the largest compression, as many as fit into `area`, with a legend of the dome
/// next to it.
pub fn draw_force_list(frame: &mut Frame, area: Rect, finger: &Finger) {
    if area.height < HEIGHT_OF_LEGEND {
        draw_forces(frame, area, finger);
        return;
    }
    let legend = legend(finger);
    let parts = [Constraint::Fill(1), Constraint::Length(legend.len() as u16)];
    let [forces, below] = Layout::vertical(parts).spacing(1).areas(area);
    draw_forces(frame, forces, finger);
    frame.render_widget(Text::from(legend), below);
}

fn legend(finger: &Finger) -> Vec<Line<'static>> {
    let heat = heat_scale().map(|style| Span::styled("▀▀", style));
    let limit = format!("0   OVER at {} N", number(finger.thresholds.over_force, 2));
    vec![
        Line::from_iter(heat),
        Line::styled(limit, QUIET),
        Line::from(vec![
            Span::styled("→ ", ARROW),
            Span::styled("shear ", QUIET),
            Span::styled("→ ", SLIPPING),
            Span::styled("slips", QUIET),
        ]),
        Line::styled("seen from outside", QUIET),
    ]
}

fn draw_forces(frame: &mut Frame, area: Rect, finger: &Finger) {
    let by_component = area.width >= WIDTH_OF_COMPONENTS;
    let title = if by_component {
        " el      F_x    F_y    F_z N"
    } else {
        " el    F_z  shear"
    };
    let mut lines = vec![Line::styled(title, TITLE)];
    let pressed = hardest_pressed(finger, usize::from(area.height.saturating_sub(1)));
    if pressed.is_empty() {
        let is_known = finger.forces.iter().any(|force| force.z.is_finite());
        let words = if is_known {
            "  no contact"
        } else {
            "  unknown"
        };
        lines.push(Line::styled(words, QUIET));
    }
    let row = |element| row(finger, element, by_component);
    lines.extend(pressed.into_iter().map(row));
    frame.render_widget(Text::from(lines), area);
}

/// Returns the `count` elements with the largest compression, in descending order.
fn hardest_pressed(finger: &Finger, count: usize) -> Vec<usize> {
    let force = |&element: &usize| finger.forces[element].z;
    let elements = 0..finger.forces.len();
    let mut pressed: Vec<usize> = elements
        .filter(|e| force(e).is_finite() && force(e) > MIN_COMPRESSION)
        .collect();
    pressed.sort_by(|a, b| force(b).total_cmp(&force(a)));
    pressed.truncate(count);
    pressed
}

fn row(finger: &Finger, element: usize, by_component: bool) -> Line<'static> {
    let (force, thresholds) = (finger.forces[element], &finger.thresholds);
    let rate = finger.shear_rates.get(element).copied().unwrap_or(0.0);
    let slipping = rate > thresholds.slip_threshold;
    let shear_style = if slipping { SLIPPING } else { Style::new() };
    let touching = force.z > thresholds.touch_force;
    let pressed_style = if touching {
        heat(force.z / thresholds.over_force).add_modifier(Modifier::BOLD)
    } else {
        QUIET
    };
    let mark = if finger.flags.largest_element == Some(element) {
        "▸"
    } else {
        " "
    };
    let name = Span::raw(format!("{mark}{element:>2}"));
    let compression = format!("{:>7}", number(force.z, 2));
    let compression = Span::styled(compression, pressed_style);
    if by_component {
        let shear = format!("  {:>7}{:>7}", number(force.x, 2), number(force.y, 2));
        Line::from(vec![name, Span::styled(shear, shear_style), compression])
    } else {
        let shear = Span::styled(shear_words(finger, element, force), shear_style);
        Line::from(vec![name, compression, shear])
    }
}

/// Formats the tangential force with its direction on the drawn dome: ` ↗ 0.32`.
fn shear_words(finger: &Finger, element: usize, force: DVec3) -> String {
    let element = finger.elements.get(element);
    let seen = element.map_or(DVec2::ZERO, |element| seen_shear(element, force));
    let head = if seen == DVec2::ZERO {
        " "
    } else {
        arrow_head(seen)
    };
    format!(" {head} {:>4}", number(force.xy().length(), 2))
}
