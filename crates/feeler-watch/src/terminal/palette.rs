//! Colours: of the 256 that nearly every terminal has, those that can be read on black and on white.

use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Span;

/// From hardly pressed to the limit.
const HEAT: [u8; 9] = [33, 37, 71, 106, 142, 178, 208, 202, 196];

/// What is there but does not matter now.
pub const QUIET: Style = Style::new().fg(Color::Indexed(244));
/// Frames around panels.
pub const FRAME: Style = Style::new().fg(Color::Indexed(240));
/// Titles, not in the colour of the frame that they stand in.
pub const TITLE: Style = Style::new().fg(Color::Reset).add_modifier(Modifier::BOLD);
/// As it should be.
pub const GOOD: Style = Style::new().fg(Color::Indexed(71));
/// Worth a look.
pub const WARNING: Style = Style::new().fg(Color::Indexed(178));
/// Wrong.
pub const BAD: Style = Style::new().fg(Color::Indexed(196));
/// What something is measured against.
pub const MARK: Style = Style::new().add_modifier(Modifier::BOLD);
/// A quantity by itself.
pub const QUANTITY: Style = Style::new().fg(Color::Indexed(38));
/// Where a force points to.
pub const ARROW: Style = Style::new().fg(Color::Reset).add_modifier(Modifier::BOLD);
/// What slips.
pub const SLIPPING: Style = Style::new().fg(Color::Indexed(170));

/// All colours of [`heat`], the coolest first.
pub fn heat_scale() -> impl Iterator<Item = Style> {
    HEAT.into_iter()
        .map(|color| Style::new().fg(Color::Indexed(color)))
}

/// The colour of `part` of a limit, from 0 to 1.
pub fn heat(part: f64) -> Style {
    let steps = HEAT.len() as f64;
    // A part that is no number counts as 0.
    let step = (part.clamp(0.0, 1.0) * steps) as usize;
    Style::new().fg(Color::Indexed(HEAT[step.min(HEAT.len() - 1)]))
}

/// A word that is lit or not: in capitals on a ground of `style`'s colour, or quietly in small letters, so
/// that one can tell without colours.
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
