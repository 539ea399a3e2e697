//! A bar gauge with a target mark.

use super::palette::{MARK, QUIET};
use ratatui::style::Style;
use ratatui::text::Span;

/// Characters for cells filled to 0 … 7 eighths.
const EIGHTHS: [char; 8] = ['·', '▏', '▎', '▍', '▌', '▋', '▊', '▉'];

/// Returns a bar of `width` cells for `value` (at least 0) in `style`. Its range is 0 to twice `target`, which is
/// marked.
pub fn gauge(value: f64, target: f64, width: usize, style: Style) -> Vec<Span<'static>> {
    // NaN is drawn as an empty bar: the cast saturates.
    let part = (value / (2.0 * target)).clamp(0.0, 1.0);
    let eighths = (part * (8 * width) as f64).round() as usize;
    let mark = width / 2;
    let cell = |index: usize| {
        let filled = eighths.saturating_sub(8 * index).min(8);
        if index == mark {
            Span::styled("┃", if filled == 8 { style } else { MARK })
        } else if let Some(&part) = EIGHTHS.get(filled) {
            Span::styled(part.to_string(), if filled == 0 { QUIET } else { style })
        } else {
            Span::styled("█", style)
        }
    };
    (0..width).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(value: f64, target: f64) -> String {
        let spans = gauge(value, target, 8, Style::new());
        spans.iter().map(|span| span.content.as_ref()).collect()
    }

    #[test]
    fn the_bar_reaches_the_mark_at_the_target() {
        assert_eq!(text(0.0, 1.0), "····┃···");
        assert_eq!(text(0.5, 1.0), "██··┃···");
        assert_eq!(text(1.0, 1.0), "████┃···");
        assert_eq!(text(1.3125, 1.0), "████┃▎··");
        assert_eq!(text(2.0, 1.0), "████┃███");
    }

    #[test]
    fn handles_any_value() {
        for (value, target) in [(f64::NAN, 1.0), (-1.0, 1.0), (0.0, 0.0), (1.0, f64::NAN)] {
            assert_eq!(text(value, target), "····┃···", "{value} {target}");
        }
        assert_eq!(text(f64::INFINITY, 1.0), "████┃███");
        assert_eq!(text(1.0, 0.0), "████┃███");
    }
}
