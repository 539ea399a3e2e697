//! Units of columns.

/// Physical quantity of a column, with the unit to which values are converted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Force, N.
    Force,
    /// Torque, N·m.
    Torque,
    /// Time, s.
    Time,
    /// Length, m.
    Length,
    /// Angle, rad.
    Angle,
    /// Position in an image, px.
    Pixels,
    /// Any quantity; values are not converted.
    Any,
}

/// Supported units: name, quantity, and factor that converts to the unit of the [`Quantity`].
const UNITS: [(&str, Quantity, f64); 39] = [
    ("N", Quantity::Force, 1.0),
    ("mN", Quantity::Force, 1e-3),
    ("uN", Quantity::Force, 1e-6),
    // With the micro sign, and with the Greek letter mu, which looks the same.
    ("µN", Quantity::Force, 1e-6),
    ("\u{3bc}N", Quantity::Force, 1e-6),
    ("kN", Quantity::Force, 1e3),
    ("newton", Quantity::Force, 1.0),
    ("newtons", Quantity::Force, 1.0),
    // Kilogram-force and gram-force, as shown by scales.
    ("kgf", Quantity::Force, 9.80665),
    ("gf", Quantity::Force, 9.80665e-3),
    ("Nm", Quantity::Torque, 1.0),
    ("N m", Quantity::Torque, 1.0),
    ("N*m", Quantity::Torque, 1.0),
    ("N·m", Quantity::Torque, 1.0),
    ("N-m", Quantity::Torque, 1.0),
    ("mNm", Quantity::Torque, 1e-3),
    ("Nmm", Quantity::Torque, 1e-3),
    ("N-mm", Quantity::Torque, 1e-3),
    ("N mm", Quantity::Torque, 1e-3),
    ("N·mm", Quantity::Torque, 1e-3),
    ("s", Quantity::Time, 1.0),
    ("sec", Quantity::Time, 1.0),
    ("ms", Quantity::Time, 1e-3),
    ("us", Quantity::Time, 1e-6),
    ("µs", Quantity::Time, 1e-6),
    ("\u{3bc}s", Quantity::Time, 1e-6),
    ("ns", Quantity::Time, 1e-9),
    ("m", Quantity::Length, 1.0),
    ("cm", Quantity::Length, 1e-2),
    ("mm", Quantity::Length, 1e-3),
    ("um", Quantity::Length, 1e-6),
    ("µm", Quantity::Length, 1e-6),
    ("rad", Quantity::Angle, 1.0),
    ("deg", Quantity::Angle, std::f64::consts::PI / 180.0),
    ("degrees", Quantity::Angle, std::f64::consts::PI / 180.0),
    ("°", Quantity::Angle, std::f64::consts::PI / 180.0),
    ("px", Quantity::Pixels, 1.0),
    ("pixel", Quantity::Pixels, 1.0),
    ("pixels", Quantity::Pixels, 1.0),
];

/// Names for raw values, such as ADC counts.
const COUNTS: [&str; 8] = [
    "counts", "count", "cts", "raw", "lsb", "digits", "adc", "a.u.",
];

impl Quantity {
    /// Factor that converts from the unit `name` to the unit of the quantity; `None` if it is not a unit of this
    /// quantity.
    pub fn scale(self, name: &str) -> Option<f64> {
        if self == Self::Any {
            return Some(1.0);
        }
        let own = UNITS
            .iter()
            .find(|(unit, of, _)| *of == self && *unit == name);
        own.map(|(.., scale)| *scale)
    }

    /// Supported units of the quantity, for messages.
    pub fn units(self) -> &'static str {
        match self {
            Self::Force => "N, mN, µN, kN, kgf or gf",
            Self::Torque => "Nm, mNm or Nmm",
            Self::Time => "s, ms, us or ns",
            Self::Length => "m, cm, mm or µm",
            Self::Angle => "rad or deg",
            Self::Pixels => "px",
            Self::Any => "any unit",
        }
    }
}

/// Returns `true` if a row contains units: at least one unit, and otherwise only dashes or empty cells.
pub fn are_units<'a>(cells: impl Iterator<Item = &'a str>) -> bool {
    let mut is_named = false;
    for cell in cells.map(without_brackets) {
        let counts = COUNTS.iter().any(|name| name.eq_ignore_ascii_case(cell));
        let is_known = counts || is_known(cell);
        is_named |= is_known;
        if !is_known && !is_no_unit(cell) {
            return false;
        }
    }
    is_named
}

/// Returns `true` if a cell of the row of units is empty or a dash.
pub fn is_no_unit(cell: &str) -> bool {
    matches!(cell, "" | "-")
}

/// Removes the brackets around a unit.
pub fn without_brackets(cell: &str) -> &str {
    let inside = |open, close| cell.strip_prefix(open)?.strip_suffix(close);
    inside('[', ']')
        .or_else(|| inside('(', ')'))
        .unwrap_or(cell)
        .trim()
}

/// Splits a column name into name and optional unit, as in `f_x [N]`, `Fx (N)`, `Fx/N` or `time_ms`.
pub fn name_and_unit(column: &str) -> (&str, Option<&str>) {
    let bracketed = [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| {
            let (name, unit) = column.strip_suffix(close)?.rsplit_once(open)?;
            Some((name, unit))
        });
    let known = || {
        let (name, unit) = column.rsplit_once(['/', '_', ' '])?;
        is_known(unit.trim()).then_some((name.trim_end_matches([' ', '/']), unit))
    };
    match bracketed.or_else(known) {
        Some((name, unit)) => (
            name.trim(),
            Some(unit.trim()).filter(|unit| !unit.is_empty()),
        ),
        None => (column, None),
    }
}

fn is_known(unit: &str) -> bool {
    UNITS.iter().any(|(name, ..)| *name == unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_split_into_name_and_unit() {
        for (column, expected) in [
            ("f_x", ("f_x", None)),
            ("Fx [N]", ("Fx", Some("N"))),
            ("Fx(mN)", ("Fx", Some("mN"))),
            ("F_x / N", ("F_x", Some("N"))),
            ("time_ms", ("time", Some("ms"))),
            ("Mx [N m]", ("Mx", Some("N m"))),
            ("f_x [lbf]", ("f_x", Some("lbf"))),
            ("f_x []", ("f_x", None)),
            ("0_x", ("0_x", None)),
        ] {
            assert_eq!(name_and_unit(column), expected);
        }
    }

    #[test]
    fn units_are_of_one_quantity() {
        assert_eq!(Quantity::Force.scale("mN"), Some(1e-3));
        assert_eq!(Quantity::Force.scale("Nm"), None);
        assert_eq!(Quantity::Angle.scale("deg"), Some(1f64.to_radians()));
        assert_eq!(Quantity::Any.scale("furlong"), Some(1.0));
        let are_units = |cells: &[&str]| super::are_units(cells.iter().copied());
        assert!(are_units(&["[N]", "-", "(mN)", ""]));
        assert!(!are_units(&["-", ""]) && !are_units(&["N", "7"]) && !are_units(&["N", "a.png"]));
    }
}
