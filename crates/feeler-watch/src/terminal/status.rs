//! Lines above and below the panels: title, progress, faults, keys.

use super::palette::{BAD, GOOD, QUANTITY, QUIET, TITLE, WARNING, badge};
use super::words::{clipped, degrees, number, speed};
use crate::snapshot::{Fault, Snapshot, TaskState, TimeBase};
use feeler::control::Phase;
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};

const NAME: &str = " feeler ";
/// Phases of a stroke, in order.
const ROUND: [Phase; 4] = [Phase::Search, Phase::Move, Phase::Release, Phase::Return];

/// Draws the first line: title and time.
pub fn draw_title(frame: &mut Frame, area: Rect, snapshot: &Snapshot) {
    let name = QUANTITY.add_modifier(Modifier::REVERSED | Modifier::BOLD);
    let time = time(snapshot);
    // The time takes precedence over the end of a long title.
    let room = usize::from(area.width).saturating_sub(NAME.len() + 2 + time.width());
    let title = Line::from(vec![
        Span::styled(NAME, name),
        Span::styled(format!(" {}", clipped(&snapshot.title, room)), TITLE),
    ]);
    ends(frame, area, title, time);
}

fn time(snapshot: &Snapshot) -> Line<'static> {
    let seconds = Span::styled(format!("{} s", number(snapshot.time, 2)), TITLE);
    match snapshot.clock {
        TimeBase::Real => Line::from(seconds),
        TimeBase::Simulated { speed: factor } => Line::from(vec![
            seconds,
            Span::styled(format!(" simulated, {} real time ", speed(factor)), QUIET),
        ]),
    }
}

/// Draws the second line: phase, stroke and the cap's angle.
pub fn draw_task(frame: &mut Frame, area: Rect, snapshot: &Snapshot) {
    let task = snapshot.task.map_or_else(
        || Line::styled(" no hand found", QUIET),
        |task| task_line(&task),
    );
    let cap = snapshot.true_cap_angle.map(|angle| {
        let angle = Span::raw(format!("cap {} ", degrees(angle, 1)));
        Line::from(vec![angle, Span::styled("(simulated truth) ", QUIET)])
    });
    ends(frame, area, task, cap.unwrap_or_default());
}

fn task_line(task: &TaskState) -> Line<'static> {
    let mut spans = Vec::new();
    for phase in ROUND {
        if phase != ROUND[0] {
            spans.push(Span::styled("›", QUIET));
        }
        let style = if phase == Phase::Move { GOOD } else { QUANTITY };
        spans.push(badge(&phase.to_string(), phase == task.phase, style));
    }
    let ended = match task.phase {
        Phase::Done => Some(GOOD),
        Phase::Stopped => Some(BAD),
        _ => None,
    };
    if let Some(style) = ended {
        spans.push(badge(&task.phase.to_string(), true, style));
    }
    let of = task.strokes.map(|strokes| format!(" of {strokes}"));
    let stroke = format!("  stroke {}{}", task.stroke, of.unwrap_or_default());
    spans.push(Span::raw(stroke));
    Line::from(spans)
}

/// Draws the second last line: the latest fault.
pub fn draw_fault(frame: &mut Frame, area: Rect, snapshot: &Snapshot) {
    let width = usize::from(area.width);
    let line = match &snapshot.fault {
        None => Line::styled(" ✓ no fault so far", QUIET),
        Some(Fault { time, words, over }) => {
            let (mark, style) = if *over {
                ("✓ resolved:", BAD)
            } else {
                ("✗", BAD.add_modifier(Modifier::BOLD))
            };
            let time = if time.is_finite() {
                format!("{} s: ", number(*time, 2))
            } else {
                String::new()
            };
            let text = format!(" {mark} {time}{words}");
            Line::styled(clipped(&text, width), style)
        }
    };
    frame.render_widget(line, area);
}

/// Draws the last line: keys and notice.
pub fn draw_keys(frame: &mut Frame, area: Rect, snapshot: &Snapshot) {
    let hand: &[_] = if snapshot.hand_listens {
        &[("s", "stop the hand"), ("r", "resume")]
    } else {
        &[]
    };
    let mut spans = Vec::new();
    for (key, meaning) in [("q", "quit")].iter().chain(hand) {
        spans.push(Span::styled(format!(" {key} "), key_style()));
        spans.push(Span::styled(format!(" {meaning}  "), QUIET));
    }
    let notice = Line::styled(format!("{} ", snapshot.notice), WARNING);
    ends(frame, area, Line::from(spans), notice);
}

fn key_style() -> Style {
    TITLE.add_modifier(Modifier::REVERSED)
}

/// Draws `left` and `right` at the ends of `area`; `right` is omitted if both do not fit.
fn ends(frame: &mut Frame, area: Rect, left: Line<'static>, right: Line<'static>) {
    let taken = u16::try_from(left.width() + 1).unwrap_or(u16::MAX);
    frame.render_widget(left, area);
    let rest = area.width.saturating_sub(taken);
    if usize::from(rest) >= right.width() {
        let x = area.x.saturating_add(taken);
        let place = Rect {
            x,
            width: rest,
            ..area
        };
        frame.render_widget(right.right_aligned(), place);
    }
}
