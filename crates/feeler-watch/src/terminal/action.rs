//! Actions that the user triggers by keys.

use ratatui::crossterm::event::{Event, KeyCode, KeyEventKind, KeyModifiers};

/// Action requested by the user.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Quit.
    Quit,
    /// Stop the hand.
    Stop,
    /// Resume the hand.
    Resume,
}

impl Action {
    /// Returns the action of `event`, if any. A terminal in raw mode reports Ctrl-C as a key.
    pub fn of(event: &Event) -> Option<Self> {
        let key = event.as_key_event()?;
        if key.kind == KeyEventKind::Release {
            return None;
        }
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        match key.code {
            KeyCode::Char('c') if control => Some(Self::Quit),
            _ if control => None,
            KeyCode::Char('q' | 'Q') => Some(Self::Quit),
            KeyCode::Char('s' | 'S') => Some(Self::Stop),
            KeyCode::Char('r' | 'R') => Some(Self::Resume),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::crossterm::event::KeyEvent;

    #[test]
    fn keys_mean_what_the_help_says() {
        let plain = |c| Event::Key(KeyEvent::from(KeyCode::Char(c)));
        let control = |c| Event::Key(KeyEvent::new(KeyCode::Char(c), KeyModifiers::CONTROL));
        assert_eq!(Action::of(&plain('q')), Some(Action::Quit));
        assert_eq!(Action::of(&control('c')), Some(Action::Quit));
        assert_eq!(Action::of(&plain('s')), Some(Action::Stop));
        assert_eq!(Action::of(&plain('r')), Some(Action::Resume));
        assert_eq!(Action::of(&control('s')), None);
        assert_eq!(Action::of(&plain('c')), None);
        assert_eq!(Action::of(&Event::Resize(80, 24)), None);
    }
}
