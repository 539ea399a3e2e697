//! Address of a sensor and scale of its counts.

use super::rdt::RDT_PORT;
use std::fmt;
use std::str::FromStr;

/// Expected syntax of an address.
const EXPECTED: &str = "netft://HOST[:PORT], or netft://HOST[:PORT]?cpf=COUNTS&cpt=COUNTS, with counts per newton and per newton \
                        metre as shown on the sensor's web page under Configurations";

/// Address of a Net F/T sensor: `netft://192.168.1.1` reads the scale of the counts from the sensor's web page;
/// `netft://192.168.1.1?cpf=1000000&cpt=1000000` specifies it.
///
/// Counts per unit are part of the sensor's calibration and not transmitted in records, so they have no default.
#[derive(Debug, Clone, PartialEq)]
pub struct NetFtAddress {
    /// Host and port.
    pub host: String,
    /// Scale of the counts; `None` to read it from the sensor's web page.
    pub counts: Option<Counts>,
    /// Port of the web page (`web=PORT`); 80 if `None`.
    pub web_port: Option<u16>,
}

/// Scale of a sensor's counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counts {
    /// Counts per newton.
    pub per_newton: f64,
    /// Counts per newton metre.
    pub per_newton_metre: f64,
}

/// Error of parsing a sensor's address.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{what}; expected {EXPECTED}")]
pub struct AddressError {
    /// The invalid part.
    what: String,
}

impl FromStr for NetFtAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let wrong = |what: String| AddressError { what };
        let rest = text.strip_prefix("netft://");
        let rest = rest.ok_or_else(|| wrong(format!("{text:?} is not a netft:// address")))?;
        let (host, query) = rest.split_once('?').unwrap_or((rest, ""));
        let host = host.trim_end_matches('/');
        if host.is_empty() || host.chars().any(|c| c.is_whitespace() || c == '/') {
            return Err(wrong(format!("{host:?} is not a host")));
        }
        let (mut force, mut torque, mut web_port) = (None, None, None);
        for pair in query.split('&').filter(|pair| !pair.is_empty()) {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            let place = match name {
                "cpf" => &mut force,
                "cpt" => &mut torque,
                "web" => {
                    let port = value.parse().ok().filter(|port| *port > 0);
                    web_port = Some(port.ok_or_else(|| wrong(format!("web is {value:?}")))?);
                    continue;
                }
                _ => return Err(wrong(format!("{name:?} is not a known parameter"))),
            };
            let number = value.parse::<f64>().ok();
            let number = number.filter(|number| number.is_finite() && *number > 0.0);
            *place = Some(number.ok_or_else(|| wrong(format!("{name} is {value:?}")))?);
        }
        let missing = |name: &str| wrong(format!("{name} is missing"));
        let counts = match (force, torque) {
            (None, None) => None,
            (force, torque) => Some(Counts {
                per_newton: force.ok_or_else(|| missing("cpf"))?,
                per_newton_metre: torque.ok_or_else(|| missing("cpt"))?,
            }),
        };
        Ok(Self {
            host: with_port(host),
            counts,
            web_port,
        })
    }
}

impl NetFtAddress {
    /// Host and port of the sensor's web page.
    pub(super) fn web_host(&self) -> String {
        let host = self.host.rsplit_once(':').map_or("", |(host, _)| host);
        format!("{host}:{}", self.web_port.unwrap_or(80))
    }
}

/// Adds RDT's port to the host if it has none. IPv6 addresses are in brackets.
fn with_port(host: &str) -> String {
    let after = host.rsplit_once(']').map_or(host, |(_, after)| after);
    match after.contains(':') {
        true => host.into(),
        false => format!("{host}:{RDT_PORT}"),
    }
}

impl fmt::Display for NetFtAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "netft://{}", self.host)?;
        let mut separator = '?';
        if let Some(counts) = &self.counts {
            let (force, torque) = (counts.per_newton, counts.per_newton_metre);
            write!(f, "?cpf={force}&cpt={torque}")?;
            separator = '&';
        }
        match self.web_port {
            Some(port) => write!(f, "{separator}web={port}"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn addresses_are_parsed_and_invalid_ones_refused() {
        let read = |text: &str| text.parse::<NetFtAddress>();
        let own = read("netft://10.0.0.2?cpf=1e6&cpt=500").unwrap();
        assert_eq!(own.host, "10.0.0.2:49152");
        let counts = own.counts.unwrap();
        assert_eq!((counts.per_newton, counts.per_newton_metre), (1e6, 500.0));
        assert_eq!(own.web_host(), "10.0.0.2:80");
        let asked = read("netft://[::1]:7?web=8080").unwrap();
        assert_eq!(
            (asked.counts, asked.web_host()),
            (None, "[::1]:8080".into())
        );
        assert_eq!(
            read("netft://[::1]?cpf=1&cpt=1").unwrap().host,
            "[::1]:49152"
        );
        assert_eq!(
            read("netft://[::1]:7/?cpt=1&cpf=1").unwrap().host,
            "[::1]:7"
        );
        for (text, words) in [
            ("10.0.0.2", "not a netft:// address"),
            ("netft://?cpf=1&cpt=1", "not a host"),
            ("netft://a?cpf=1", "cpt is missing"),
            ("netft://a?cpf=-1&cpt=1", "cpf is \"-1\""),
            ("netft://a?cpf=nan&cpt=1", "cpf is \"nan\""),
            ("netft://a?rate=1", "\"rate\" is not a known parameter"),
            ("netft://a?web=0", "web is \"0\""),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(
                error.contains(words) && error.contains("Configurations"),
                "{error}"
            );
        }
    }

    proptest! {
        #[test]
        fn parsed_addresses_round_trip(text in "(netft://)?.{0,40}") {
            if let Ok(address) = text.parse::<NetFtAddress>() {
                prop_assert_eq!(address.to_string().parse::<NetFtAddress>(), Ok(address));
            }
        }
    }
}
