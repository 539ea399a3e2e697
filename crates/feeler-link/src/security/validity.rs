//! Validity periods of certificates.

use rcgen::{CertificateParams, date_time_ymd};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

const DAY: u64 = 24 * 60 * 60;

/// Default validity of a certificate, in days.
pub const DAYS: u32 = 365;

/// Validity of an authority, in days.
pub const AUTHORITY_DAYS: u32 = 3653;

/// Validity period of a certificate, in seconds since 1970.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validity {
    from: u64,
    until: u64,
}

impl Validity {
    /// Creates a period that ends `days` from now. It starts one day ago, for computers whose clocks are slow.
    pub fn days(days: u32) -> Self {
        let now = now();
        Self {
            from: now.saturating_sub(DAY),
            until: now.saturating_add(u64::from(days) * DAY),
        }
    }

    /// Creates a one-day period that ended `days` ago.
    pub fn that_ended(days: u32) -> Self {
        let until = now().saturating_sub(u64::from(days) * DAY);
        Self {
            from: until.saturating_sub(DAY),
            until,
        }
    }

    /// Returns the day on which the period ends, e.g. 2027-11-22.
    pub fn last_day(self) -> String {
        day(self.until)
    }

    pub(crate) fn set(self, certificate: &mut CertificateParams) {
        let epoch = date_time_ymd(1970, 1, 1);
        certificate.not_before = epoch + Duration::from_secs(self.from);
        certificate.not_after = epoch + Duration::from_secs(self.until);
    }
}

/// Returns the time in seconds since 1970, or 0 if the clock is set before 1970, when no certificate is valid.
pub(crate) fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}

/// Formats a time in seconds since 1970 as a day, e.g. 2027-11-22.
pub(crate) fn day(seconds: u64) -> String {
    // The calendar of `rcgen` ends with the year 9999.
    let seconds = seconds.min(253_402_300_799);
    let time = date_time_ymd(1970, 1, 1) + Duration::from_secs(seconds);
    format!(
        "{:04}-{:02}-{:02}",
        time.year(),
        u8::from(time.month()),
        time.day()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_follow_the_calendar() {
        assert_eq!(day(0), "1970-01-01");
        // date -u -d @1709164800
        assert_eq!(day(1_709_164_800), "2024-02-29");
        assert_eq!(day(u64::MAX), "9999-12-31");
        let validity = Validity::days(365);
        assert_eq!(validity.until - validity.from, 366 * DAY);
        assert!(Validity::that_ended(1).until < now());
    }
}
