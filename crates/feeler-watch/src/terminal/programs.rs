//! Table of the programs.

use super::palette::{BAD, GOOD, QUIET, WARNING, panel};
use super::words::{DASH, age, number, per_cent};
use crate::snapshot::{Program, ProgramState, Snapshot};
use ratatui::Frame;
use ratatui::layout::{Constraint, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Cell, Row, Table};

/// Minimum width at which versions are shown.
const WIDTH_OF_VERSIONS: u16 = 60;

/// Draws the table of programs, the number of programs that do not fit, and the number of messages that the view
/// missed.
pub fn draw_programs(frame: &mut Frame, area: Rect, snapshot: &Snapshot) {
    let programs = &snapshot.programs;
    let mut block = panel(" programs ");
    if let Some(missed) = snapshot.missed {
        let words = format!(" {missed} missed here ");
        let style = if missed > 0 { WARNING } else { QUIET };
        block = block.title_bottom(Line::styled(words, style));
    }
    let shown = usize::from(area.height.saturating_sub(3));
    if programs.len() > shown {
        let more = format!(" and {} more ", programs.len() - shown);
        block = block.title_bottom(Line::styled(more, WARNING).right_aligned());
    }
    let with_version = area.width >= WIDTH_OF_VERSIONS;
    let right = |text: &'static str| Cell::from(Line::raw(text).right_aligned());
    let mut titles = vec![Cell::from("program")];
    let mut widths = vec![Constraint::Length(if with_version { 12 } else { 9 })];
    if with_version {
        titles.push(Cell::from("version"));
        widths.push(Constraint::Length(8));
    }
    titles.extend(["rate", "age", "lost", "late"].map(right));
    titles.push(Cell::from("state"));
    widths.extend([8, 6, 6, 5].map(Constraint::Length));
    widths.push(Constraint::Fill(1));
    let rows = programs.iter().take(shown).map(|p| row(p, with_version));
    let table = Table::new(rows, widths)
        .header(Row::new(titles).style(QUIET))
        .block(block);
    frame.render_widget(table, area);
}

fn row(program: &Program, with_version: bool) -> Row<'static> {
    let silent = program.state == ProgramState::Silent;
    let name = match program.finger {
        Some(finger) => format!("{} {finger}", program.name),
        None => program.name.clone(),
    };
    let right = |text: String, style: Style| Cell::from(Line::styled(text, style).right_aligned());
    let warn = |wrong: bool| if wrong { WARNING } else { Style::new() };
    let mut cells = vec![Cell::from(name)];
    if with_version {
        cells.push(Cell::from(Span::styled(program.version.clone(), QUIET)));
    }
    let late = program
        .late
        .map_or_else(|| DASH.into(), |late| number(late as f64, 0));
    cells.extend([
        right(rate(program.rate), Style::new()),
        right(age(program.age), if silent { BAD } else { Style::new() }),
        right(lost(program), warn(program.lost > 0)),
        right(late, warn(program.late.is_some_and(|late| late > 0))),
        Cell::from(state(program, with_version)),
    ]);
    Row::new(cells)
}

fn rate(rate: f64) -> String {
    if rate.is_finite() {
        format!("{} Hz", number(rate, if rate < 99.5 { 1 } else { 0 }))
    } else {
        DASH.into()
    }
}

/// Formats the fraction of messages lost, or their number if the total is unknown.
fn lost(program: &Program) -> String {
    match program.received {
        Some(_) => per_cent(program.lost_part()),
        None => number(program.lost as f64, 0),
    }
}

fn state(program: &Program, has_room: bool) -> Line<'static> {
    let (mark, style, words) = match &program.state {
        ProgramState::Alive => ("●", GOOD, "alive".into()),
        ProgramState::Silent if !program.age.is_finite() => ("○", WARNING, "not found".into()),
        ProgramState::Silent if has_room => ("○", BAD, format!("silent for {}", age(program.age))),
        ProgramState::Silent => ("○", BAD, "SILENT".into()),
        ProgramState::Refused { why } => ("✗", BAD, format!("REFUSED: {why}")),
    };
    Line::from(vec![
        Span::styled(mark, style),
        Span::styled(format!(" {words}"), style),
    ])
}
