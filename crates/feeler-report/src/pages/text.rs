//! Number formatting for pages.

/// Formatted value, or a dash for `None`.
pub fn value(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), significant)
}

/// Formats a number with three significant digits (integers with all digits) and a proper minus sign. A dash for NaN.
pub fn significant(value: f64) -> String {
    match value {
        0.0 => return "0".into(),
        f64::INFINITY => return "∞".into(),
        f64::NEG_INFINITY => return "\u{2212}∞".into(),
        value if value.is_nan() => return "–".into(),
        _ => {}
    }
    let magnitude = value.abs();
    let decimals = (2 - magnitude.log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{magnitude:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    match text {
        "0" => "0".into(),
        text if value < 0.0 => format!("\u{2212}{text}"),
        text => text.into(),
    }
}

/// Formats an estimate (`[low, estimate, high]`) with its interval, whose ends are NaN if there is only one trial.
pub fn with_interval([low, value, high]: [f64; 3], text: impl Fn(f64) -> String) -> String {
    if low.is_nan() || high.is_nan() {
        return format!("{} (no interval)", text(value));
    }
    format!("{} [{}, {}]", text(value), text(low), text(high))
}

/// Formats a mean with its interval.
pub fn number(mean: [f64; 3]) -> String {
    let digits = digits(mean[1]);
    with_interval(mean, |value| format!("{value:.digits$}"))
}

/// Formats a signed difference with its interval.
pub fn signed(difference: [f64; 3]) -> String {
    let digits = digits(difference[1]);
    with_interval(difference, |value| format!("{value:+.digits$}"))
}

fn digits(value: f64) -> usize {
    if value.abs() < 10.0 { 2 } else { 1 }
}

/// Formats a fraction with its interval, in percent.
pub fn percent(share: [f64; 3]) -> String {
    let text = with_interval(share.map(|part| 100.0 * part), |part| format!("{part:.1}"));
    text + " %"
}

/// Formats a fraction with its interval in percent, without the unit; a dash for `None`.
pub fn share(share: Option<[f64; 3]>) -> String {
    let percent = |share: [f64; 3]| number(share.map(|part| 100.0 * part));
    share.map_or_else(|| "-".into(), percent)
}

/// Splits a label such as `Torque (mN·m)` into name and unit; the unit may be empty.
pub fn name_and_unit(label: &str) -> (&str, &str) {
    let parts = label.strip_suffix(')').and_then(|l| l.rsplit_once(" ("));
    parts.unwrap_or((label, ""))
}

#[cfg(test)]
mod tests {
    use super::{name_and_unit, significant};

    #[test]
    fn numbers_have_three_significant_digits() {
        assert_eq!(significant(0.0), "0");
        assert_eq!(significant(4.0), "4");
        assert_eq!(significant(0.029_34), "0.0293");
        assert_eq!(significant(-12.345), "\u{2212}12.3");
        assert_eq!(significant(48.76), "48.8");
        assert_eq!(significant(123_456.0), "123456");
        assert_eq!(significant(-1e-13), "0");
        assert_eq!(significant(0.15), "0.15");
        let [nan, infinity] = [f64::NAN, f64::NEG_INFINITY].map(significant);
        assert_eq!([&*nan, &*infinity], ["–", "\u{2212}∞"]);
    }

    #[test]
    fn labels_are_split_into_name_and_unit() {
        assert_eq!(name_and_unit("Torque (mN·m)"), ("Torque", "mN·m"));
        assert_eq!(name_and_unit("F (x) (N)"), ("F (x)", "N"));
        assert_eq!(name_and_unit("friction"), ("friction", ""));
    }
}
