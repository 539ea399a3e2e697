//! Colours of the 256-colour palette that are readable on black and on white.

use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, BorderType};

/// Colours from zero force to the limit, as palette indices.
const HEAT: [u8; 9] = [33, 37, 71, 106, 142, 178, 208, 202, 196];

/// Style of unimportant information.
pub const QUIET: Style = Style::new().fg(Color::Indexed(244));
/// Style of the frames around panels.
pub const FRAME: Style = Style::new().fg(Color::Indexed(240));
/// Style of titles; their colour differs from that of the surrounding frame.
pub const TITLE: Style = Style::new().fg(Color::Reset).add_modifier(Modifier::BOLD);
/// Style of a normal state.
pub const GOOD: Style = Style::new().fg(Color::Indexed(71));
/// Style of a warning.
pub const WARNING: Style = Style::new().fg(Color::Indexed(178));
/// Style of a fault.
pub const BAD: Style = Style::new().fg(Color::Indexed(196));
/// Style of the target mark of a gauge.
pub const MARK: Style = Style::new().add_modifier(Modifier::BOLD);
/// Style of a quantity.
pub const QUANTITY: Style = Style::new().fg(Color::Indexed(38));
/// Style of the arrow of a force.
pub const ARROW: Style = Style::new().fg(Color::Reset).add_modifier(Modifier::BOLD);
/// Style of a slipping element.
pub const SLIPPING: Style = Style::new().fg(Color::Indexed(170));

/// Returns the styles of all colours of [`heat`], coolest first.
pub fn heat_scale() -> impl Iterator<Item = Style> {
    HEAT.into_iter()
        .map(|color| Style::new().fg(Color::Indexed(color)))
}

/// Returns the style for a fraction of a limit, from 0 to 1.
pub fn heat(part: f64) -> Style {
    let steps = HEAT.len() as f64;
    // NaN counts as 0.
    let step = (part.clamp(0.0, 1.0) * steps) as usize;
    Style::new().fg(Color::Indexed(HEAT[step.min(HEAT.len() - 1)]))
}

/// Returns the frame of a panel with this title.
pub fn panel(title: impl Into<String>) -> Block<'static> {
    Block::bordered()
        .border_type(BorderType::Rounded)
        .border_style(FRAME)
        .title_top(Line::styled(title.into(), TITLE))
}

/// Formats a label that is active (`lit`) or not: in capitals on a background of `style`'s colour, or muted in lower
/// case, so that the state is visible without colours.
pub fn badge(word: &str, lit: bool, style: Style) -> Span<'static> {
    if lit {
        let lit = style.add_modifier(Modifier::REVERSED | Modifier::BOLD);
        Span::styled(format!(" {} ", word.to_uppercase()), lit)
    } else {
        Span::styled(format!(" {} ", word.to_lowercase()), QUIET)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_has_a_colour() {
        let first = heat(0.0);
        let last = heat(1.0);
        assert_ne!(first, last);
        for part in [-1.0, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(heat(part), first);
        }
        assert_eq!(heat(f64::INFINITY), last);
    }
}
