//! Compact formatting of numbers.

/// Placeholder for an unknown number.
pub const DASH: &str = "–";

/// Formats `value` with `decimals` digits, huge values as powers of ten, non-finite ones as a dash.
pub fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        DASH.into()
    } else if value.abs() >= 1e5 {
        format!("{value:.0e}")
    } else {
        let text = format!("{value:.decimals$}");
        // Avoids "-0.00".
        match text.strip_prefix('-') {
            Some(digits) if digits.bytes().all(|b| matches!(b, b'0' | b'.')) => digits.into(),
            _ => text,
        }
    }
}

/// Formats a duration in a suitable unit: `12 ms`, `3.4 s`, `5 min`.
pub fn age(seconds: f64) -> String {
    let seconds_shown = seconds.abs();
    if !seconds.is_finite() {
        DASH.into()
    } else if seconds_shown < 0.9995 {
        format!("{} ms", number(1000.0 * seconds, 0))
    } else if seconds_shown < 99.95 {
        format!("{} s", number(seconds, 1))
    } else {
        format!("{} min", number(seconds / 60.0, 0))
    }
}

/// Formats a multiple of real time: `1.0 ×`, `620 ×`.
pub fn speed(factor: f64) -> String {
    format!("{} ×", number(factor, if factor < 9.95 { 1 } else { 0 }))
}

/// Formats an angle (rad) in degrees with `decimals`.
pub fn degrees(angle: f64, decimals: usize) -> String {
    if angle.is_finite() {
        format!("{}°", number(angle.to_degrees(), decimals))
    } else {
        DASH.into()
    }
}

/// Formats a fraction as a percentage of at most six characters.
pub fn per_cent(part: Option<f64>) -> String {
    match part {
        Some(part) if part.is_finite() => format!("{} %", number(100.0 * part, 1)),
        _ => DASH.into(),
    }
}

/// Returns the first `width` characters of `text`, with an ellipsis if it is cut.
pub fn clipped(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.into();
    }
    let kept = text.chars().take(width.saturating_sub(1));
    kept.chain(std::iter::repeat_n('…', width.min(1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_short() {
        let shown = [1.25, -0.001, f64::NAN, f64::NEG_INFINITY, 1e300, -12345.6];
        let shown = shown.map(|value| number(value, 2));
        assert_eq!(shown, ["1.25", "0.00", DASH, DASH, "1e300", "-12345.60"]);
    }

    #[test]
    fn times_choose_their_unit() {
        let shown = [0.0, 0.0123, 0.9996, 12.34, 600.0, f64::NAN].map(age);
        assert_eq!(shown, ["0 ms", "12 ms", "1.0 s", "12.3 s", "10 min", DASH]);
    }

    #[test]
    fn texts_are_clipped_to_their_width() {
        assert_eq!(clipped("äöü", 3), "äöü");
        assert_eq!(clipped("äöüß", 3), "äö…");
        assert_eq!(clipped("abc", 0), "");
    }
}
