//! How long certificates are valid.

use rcgen::{CertificateParams, date_time_ymd};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

const DAY: u64 = 24 * 60 * 60;

/// Days for which a certificate is valid unless said otherwise.
pub const DAYS: u32 = 365;

/// Days for which an authority is valid.
pub const AUTHORITY_DAYS: u32 = 3653;

/// From when until when a certificate is valid, s since 1970.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validity {
    from: u64,
    until: u64,
}

impl Validity {
    /// For `days` from now on. It starts a day before, for computers whose clock is late.
    pub fn days(days: u32) -> Self {
        let now = now();
        Self {
            from: now.saturating_sub(DAY),
            until: now.saturating_add(u64::from(days) * DAY),
        }
    }

    /// For a day that ended `days` before now.
    pub fn that_ended(days: u32) -> Self {
        let until = now().saturating_sub(u64::from(days) * DAY);
        Self {
            from: until.saturating_sub(DAY),
            until,
        }
    }

    /// The day on which it ends, as in 2027-11-22.
    pub fn last_day(self) -> String {
        day(self.until)
    }

    pub(super) fn set(self, certificate: &mut CertificateParams) {
        let epoch = date_time_ymd(1970, 1, 1);
        certificate.not_before = epoch + Duration::from_secs(self.from);
        certificate.not_after = epoch + Duration::from_secs(self.until);
    }
}

/// The time, s since 1970. A clock that stands before that makes every certificate not valid yet.
pub(super) fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}

/// The day of a time in s since 1970, as in 2027-11-22.
pub(super) fn day(seconds: u64) -> String {
    // The calendar of the library that writes certificates ends with the year 9999.
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
    fn days_are_those_of_the_calendar() {
        assert_eq!(day(0), "1970-01-01");
        // date -u -d @1709164800
        assert_eq!(day(1_709_164_800), "2024-02-29");
        assert_eq!(day(u64::MAX), "9999-12-31");
        let validity = Validity::days(365);
        assert_eq!(validity.until - validity.from, 366 * DAY);
        assert!(Validity::that_ended(1).until < now());
    }
}
