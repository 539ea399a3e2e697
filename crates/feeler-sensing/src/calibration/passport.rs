//! Dates of calibrations, and requirements on their verifications.

use feeler::sensor::wrench::CalibrationOf;
use feeler::sensor::wrench::basis::Basis;
use feeler::sensor::wrench::passport::Passport;
use feeler_console::CommandError;
use jiff::Timestamp;
use jiff::civil::Date;
use jiff::tz::TimeZone;

/// Today's date in UTC, as in 2026-11-28.
pub fn today() -> String {
    date_today().to_string()
}

fn date_today() -> Date {
    Timestamp::now().to_zoned(TimeZone::UTC).date()
}

/// Checks that the last verification of `calibration` found it valid, at most `days` days ago.
///
/// # Errors
/// If it was never verified, was not valid, or was verified earlier or in the future.
pub fn require_verified<B: Basis>(
    calibration: &CalibrationOf<B>,
    days: u32,
) -> Result<(), CommandError> {
    check_verified(calibration.passport.as_ref(), days, date_today())
}

fn check_verified(passport: Option<&Passport>, days: u32, today: Date) -> Result<(), CommandError> {
    const HOW: &str = "test it with `feeler verify`";
    let verification = passport.and_then(|passport| passport.verifications.last());
    let Some(verification) = verification else {
        return Err(format!("expected a calibration verified within {days} days, got one that was never verified; {HOW}").into());
    };
    let text = &verification.date;
    let date: Date = text
        .parse()
        .map_err(|e| format!("date = {text:?} of the last verification: {e}"))?;
    if !verification.valid {
        return Err(format!(
            "the verification of {date} found the calibration no longer valid; calibrate again"
        )
        .into());
    }
    let age = (today - date).get_days();
    match (0..=i64::from(days)).contains(&i64::from(age)) {
        true => Ok(()),
        false => Err(format!(
            "expected a calibration verified within {days} days, got one verified on {date}; {HOW}"
        )
        .into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feeler::sensor::wrench::verification::Verification;

    fn passport(date: &str, valid: bool) -> Passport {
        Passport {
            verifications: vec![Verification {
                date: date.into(),
                false_alarm_rate: 0.01,
                valid,
                axes: Vec::new(),
            }],
            ..Passport::default()
        }
    }

    #[test]
    fn old_failed_and_future_verifications_are_rejected() {
        let today: Date = "2026-03-01".parse().unwrap();
        for (date, valid, words) in [
            ("2026-02-27", true, ""),
            ("2026-02-26", true, "verified on 2026-02-26"),
            ("2026-03-02", true, "verified on 2026-03-02"),
            ("2026-02-28", false, "no longer valid"),
            ("28.2.2026", true, "date = \"28.2.2026\""),
        ] {
            let found = check_verified(Some(&passport(date, valid)), 2, today);
            let message = found.err().map(|e| e.to_string()).unwrap_or_default();
            assert_eq!(message.is_empty(), words.is_empty(), "{date}: {message}");
            assert!(message.contains(words), "{message}");
        }
        assert!(check_verified(None, 2, today).is_err());
    }
}
