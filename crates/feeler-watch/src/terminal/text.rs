//! Snapshots as text, without a terminal.

use super::draw::draw;
use crate::snapshot::Snapshot;
use ratatui::Terminal;
use ratatui::backend::TestBackend;

/// Renders `snapshot` on a screen of `width` columns and `height` rows as text without colours.
pub fn text(snapshot: &Snapshot, width: u16, height: u16) -> String {
    // Drawing into memory cannot fail.
    let Ok(mut terminal) = Terminal::new(TestBackend::new(width, height));
    let Ok(_) = terminal.draw(|frame| draw(frame, snapshot));
    let cells = &terminal.backend().buffer().content;
    let lines = cells.chunks(usize::from(width.max(1)));
    let lines = lines.map(|line| line.iter().map(|cell| cell.symbol()).collect::<String>());
    lines.collect::<Vec<_>>().join("\n")
}
