//! Panel of a finger: flags, grasp force, fingertip, forces, joint angles.

use super::dome::draw_dome;
use super::force_list::{WIDTH, draw_force_list};
use super::gauge::gauge;
use super::palette::{BAD, GOOD, QUANTITY, SLIPPING, WARNING, badge, panel};
use super::words::{degrees, number};
use crate::snapshot::Finger;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::{Line, Span};

/// Minimum width of a panel with labels.
const MIN_WIDTH_OF_WORDS: u16 = 36;

/// Draws `finger` into `area`.
pub fn draw_finger(frame: &mut Frame, area: Rect, finger: &Finger) {
    let narrow = area.width < MIN_WIDTH_OF_WORDS;
    let name = if narrow { "" } else { "finger " };
    let block = panel(format!(" {name}{} ", finger.number))
        .title_top(flags(finger).right_aligned())
        .title_bottom(joints(finger, narrow).right_aligned());
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let [force, body] = Layout::vertical([Constraint::Length(1), Constraint::Fill(1)]).areas(inner);
    frame.render_widget(grasp(finger, usize::from(force.width)), force);
    let (dome, list) = share(body);
    draw_dome(frame, dome, finger);
    draw_force_list(frame, list, finger);
}

/// Returns the areas of dome and list: side by side, or one above the other in a narrow panel.
fn share(body: Rect) -> (Rect, Rect) {
    let areas = if body.width >= WIDTH + 14 {
        // Square, because a cell is twice as high as wide.
        let list = body.width.saturating_sub(2 * body.height + 2).max(WIDTH);
        Layout::horizontal([Constraint::Fill(1), Constraint::Length(list)])
            .spacing(1)
            .areas(body)
    } else {
        let dome = (body.width / 2).min(body.height * 3 / 4);
        Layout::vertical([Constraint::Length(dome), Constraint::Fill(1)]).areas(body)
    };
    let [dome, list] = areas;
    (dome, list)
}

fn flags(finger: &Finger) -> Line<'static> {
    let flags = &finger.flags;
    Line::from(vec![
        badge("touch", flags.touch, GOOD),
        badge("slip", flags.slip, SLIPPING),
        badge("over", flags.over, BAD),
    ])
}

/// Formats the grasp force, relative to the force at which the fingers start to move.
fn grasp(finger: &Finger, width: usize) -> Line<'static> {
    const LABEL: &str = "grasp ";
    let (force, target) = (finger.flags.grasp_force, finger.grasp_target);
    let style = match finger.flags {
        flags if flags.over => WARNING,
        _ if force >= target => GOOD,
        _ => QUANTITY,
    };
    let label = if width >= 24 { LABEL } else { "" };
    let words = format!(" {} of {} N", number(force, 2), number(target, 2));
    let bar = width.saturating_sub(label.len() + words.chars().count());
    let mut spans = vec![Span::raw(label)];
    spans.extend(gauge(force, target, bar, style));
    spans.push(Span::raw(words));
    Line::from(spans)
}

fn joints(finger: &Finger, narrow: bool) -> Line<'static> {
    let (word, decimals) = if narrow { ("", 0) } else { ("joints ", 1) };
    let angles = finger.joints.iter().map(|angle| degrees(angle, decimals));
    let angles: Vec<_> = angles.collect();
    Line::raw(format!(" {word}{} ", angles.join(" ")))
}
