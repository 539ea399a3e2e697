//! Layout of the screen.

use super::finger::draw_finger;
use super::palette::QUIET;
use super::programs::draw_programs;
use super::status::{draw_fault, draw_keys, draw_task, draw_title};
use super::torque::draw_torque;
use crate::snapshot::Snapshot;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line;

/// Minimum height of a screen on which torque and programs are shown.
const MIN_HEIGHT_OF_BAND: u16 = 16;
/// Minimum width of a screen on which torque is shown next to the programs.
const MIN_WIDTH_OF_TORQUE: u16 = 70;

/// Draws `snapshot` on the whole of `frame`. Any size works; the layout is designed for 80 columns and 24 rows or
/// more.
pub fn draw(frame: &mut Frame, snapshot: &Snapshot) {
    let area = frame.area();
    let band = band_height(area.height, snapshot.programs.len());
    let rows = [
        Constraint::Length(1),
        Constraint::Length(1),
        Constraint::Fill(1),
        Constraint::Length(band),
        Constraint::Length(1),
        Constraint::Length(1),
    ];
    let [title, task, fingers, band, fault, keys] = Layout::vertical(rows).areas(area);
    draw_title(frame, title, snapshot);
    draw_task(frame, task, snapshot);
    draw_fingers(frame, fingers, snapshot);
    if !band.is_empty() {
        draw_band(frame, band, snapshot);
    }
    draw_fault(frame, fault, snapshot);
    draw_keys(frame, keys, snapshot);
}

/// Returns the height of the panels below the fingers: one row for each of `programs`, up to a third of the screen.
fn band_height(height: u16, programs: usize) -> u16 {
    if height < MIN_HEIGHT_OF_BAND {
        return 0;
    }
    let frame_and_titles = 3;
    let wanted = u16::try_from(programs + frame_and_titles).unwrap_or(u16::MAX);
    wanted.max(height / 5).max(6).min(height / 3)
}

fn draw_fingers(frame: &mut Frame, area: Rect, snapshot: &Snapshot) {
    if snapshot.fingers.is_empty() {
        frame.render_widget(Line::styled(" no fingers found yet", QUIET), area);
        return;
    }
    let panels = Layout::horizontal(snapshot.fingers.iter().map(|_| Constraint::Fill(1)));
    for (finger, &panel) in snapshot.fingers.iter().zip(panels.split(area).iter()) {
        draw_finger(frame, panel, finger);
    }
}

fn draw_band(frame: &mut Frame, area: Rect, snapshot: &Snapshot) {
    if area.width < MIN_WIDTH_OF_TORQUE {
        draw_programs(frame, area, snapshot);
        return;
    }
    let halves = [Constraint::Fill(1), Constraint::Length(area.width * 5 / 8)];
    let [torque, programs] = Layout::horizontal(halves).areas(area);
    draw_torque(frame, torque, snapshot.torque.as_ref());
    draw_programs(frame, programs, snapshot);
}
