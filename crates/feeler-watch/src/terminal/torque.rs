//! Panel of the torque sensor.

use super::palette::{QUANTITY, QUIET, WARNING, panel};
use super::words::{age, number};
use crate::snapshot::Torque;
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use ratatui::widgets::{RenderDirection, Sparkline, SparklineBar};

/// Minimum full scale (N·m); smaller torques are sensor noise.
const MIN_SCALE: f64 = 2e-3;
/// Height of the highest bar, in the sparkline's units.
const FULL_HEIGHT: f64 = 1e4;

/// Draws the latest torque and its recent history, newest on the right; opening torques have a different colour.
pub fn draw_torque(frame: &mut Frame, area: Rect, torque: Option<&Torque>) {
    let block = panel(" torque ");
    let Some(torque) = torque else {
        let nothing = Line::styled(" no torque sensor", QUIET);
        let inner = block.inner(area);
        frame.render_widget(block, area);
        frame.render_widget(nothing, inner);
        return;
    };
    let shown = usize::from(area.width.saturating_sub(2)).min(torque.history.len());
    let shown = &torque.history[torque.history.len() - shown..];
    let highest = shown.iter().filter(|t| t.is_finite());
    let highest = highest.fold(0.0, |highest: f64, t| highest.max(t.abs()));
    let seconds = age(shown.len() as f64 * torque.interval);
    let newest = format!(" {} N·m ", number(torque.newest, 4));
    let block = block
        .title_top(Line::styled(newest, QUANTITY).right_aligned())
        .title_bottom(Span::styled(format!(" last {seconds} "), QUIET))
        .title_bottom(
            Line::styled(format!(" up to {} ", number(highest, 4)), QUIET).right_aligned(),
        );
    let scale = highest.max(MIN_SCALE);
    let bars = shown.iter().rev().map(|&torque| bar(torque, scale));
    let sparkline = Sparkline::default()
        .block(block)
        .data(bars.collect::<Vec<_>>())
        .max(FULL_HEIGHT as u64)
        .direction(RenderDirection::RightToLeft);
    frame.render_widget(sparkline, area);
}

fn bar(torque: f64, scale: f64) -> SparklineBar {
    // The cast converts NaN to 0.
    let height = (FULL_HEIGHT * torque.abs() / scale) as u64;
    // Small negative values are noise.
    let opens = torque < -0.1 * scale;
    let style = if opens { WARNING } else { QUANTITY };
    SparklineBar::from(height).style(style)
}
