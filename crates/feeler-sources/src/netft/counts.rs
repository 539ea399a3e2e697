//! Reads the scale of a sensor's counts from its web page.

use super::address::{Counts, NetFtAddress};
use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Path of the XML page.
const PAGE: &str = "/netftapi2.xml";
/// Maximum duration of the request.
const TIME: Duration = Duration::from_secs(5);
/// Maximum size of the page (bytes). Pages usually have a few thousand.
const LONGEST: usize = 1 << 18;

/// Force units that a sensor may be configured to, with the name on its page and the value in N.
const FORCES: [(&str, f64); 6] = [
    ("N", 1.0),
    ("kN", 1e3),
    ("lbf", 4.448_221_615_260_5),
    ("klbf", 4_448.221_615_260_5),
    ("gf", 9.806_65e-3),
    ("kgf", 9.806_65),
];
/// Torque units that a sensor may be configured to, with the name on its page and the value in N m.
const TORQUES: [(&str, f64); 6] = [
    ("Nm", 1.0),
    ("Nmm", 1e-3),
    ("kNm", 1e3),
    ("lbfin", 0.112_984_829_027_616_7),
    ("lbfft", 1.355_817_948_331_4),
    ("kgfcm", 9.806_65e-2),
];

/// Error of reading the scale of a sensor's counts.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CountsError {
    /// The page cannot be loaded.
    #[error(
        "http://{web}{PAGE}: {reason}; expected the sensor's web page, or counts in the address as ?cpf=COUNTS&cpt=COUNTS"
    )]
    NoPage {
        /// Host and port.
        web: String,
        /// Error of the operating system or of the page.
        reason: String,
    },
    /// The page is not XML.
    #[error("the sensor's web page is not XML: {reason}")]
    NoXml {
        /// Error of the parser.
        reason: String,
    },
    /// A field is missing or invalid.
    #[error("the sensor's web page has {name} = {value:?}; expected {expected}")]
    Field {
        /// Name of the element.
        name: &'static str,
        /// Actual value; empty if the element is missing.
        value: String,
        /// Expected value.
        expected: String,
    },
}

/// Reads the scale of the counts from the sensor's web page.
///
/// # Errors
/// If the page does not respond within five seconds, or a field is missing or invalid.
pub fn read_counts(address: &NetFtAddress) -> Result<Counts, CountsError> {
    let web = address.web_host();
    let page = get(&web).map_err(|error| CountsError::NoPage {
        web,
        reason: error.to_string(),
    })?;
    parse_counts(&page)
}

/// Parses the active configuration on the page: `cfgcpf`, `cfgcpt`, and their units `scfgfu`, `scfgtu`.
///
/// # Errors
/// If the page is not XML, or a field is missing or invalid.
pub fn parse_counts(page: &str) -> Result<Counts, CountsError> {
    let page = roxmltree::Document::parse(page).map_err(|error| CountsError::NoXml {
        reason: error.to_string(),
    })?;
    let text = |name: &str| {
        let element = page.descendants().find(|node| node.has_tag_name(name));
        let text = element.and_then(|element| element.text());
        text.unwrap_or_default().trim().to_owned()
    };
    let counts = |name: &'static str| {
        let value = text(name);
        let number = value.parse::<f64>().ok();
        let number = number.filter(|number| number.is_finite() && *number > 0.0);
        number.ok_or(CountsError::Field {
            name,
            value,
            expected: "a number of counts above 0".into(),
        })
    };
    let unit = |name: &'static str, units: &[(&str, f64)]| {
        let value = text(name);
        // Firmware versions write N-m, N·m or Nm.
        let plain: String = value.chars().filter(char::is_ascii_alphabetic).collect();
        let known = units.iter().find(|(unit, _)| plain == *unit);
        let names: Vec<&str> = units.iter().map(|(unit, _)| *unit).collect();
        known.map(|(_, size)| *size).ok_or(CountsError::Field {
            name,
            value,
            expected: format!("one of {}", names.join(", ")),
        })
    };
    Ok(Counts {
        per_newton: counts("cfgcpf")? / unit("scfgfu", &FORCES)?,
        per_newton_metre: counts("cfgcpt")? / unit("scfgtu", &TORQUES)?,
    })
}

/// Loads the page and returns its body.
fn get(web: &str) -> io::Result<String> {
    let until = Instant::now() + TIME;
    let mut stream = connect(web)?;
    stream.set_write_timeout(Some(TIME))?;
    // HTTP 1.0: the response is not chunked and ends with the connection.
    let request = format!("GET {PAGE} HTTP/1.0\r\nHost: {web}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes())?;
    let mut answer = Vec::new();
    let mut bytes = [0; 4096];
    loop {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut bytes)? {
            0 => break,
            count => answer.extend_from_slice(&bytes[..count]),
        }
        if answer.len() > LONGEST {
            return Err(io::Error::other(format!("over {LONGEST} bytes")));
        }
    }
    let answer = String::from_utf8_lossy(&answer);
    let (head, body) = answer.split_once("\r\n\r\n").unwrap_or((&answer, ""));
    let status = head.lines().next().unwrap_or_default();
    if !status.starts_with("HTTP/") || status.split(' ').nth(1) != Some("200") {
        return Err(io::Error::other(format!("{status:?}; expected status 200")));
    }
    Ok(body.to_owned())
}

/// Connects to the first of the host's addresses that accepts.
fn connect(web: &str) -> io::Result<TcpStream> {
    let mut failed = io::Error::other("the host has no address");
    for address in web.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, TIME) {
            Ok(stream) => return Ok(stream),
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn page(fields: &str) -> String {
        format!("<?xml version=\"1.0\"?>\n<netft><runstat>0x00000000</runstat>{fields}</netft>")
    }

    #[test]
    fn counts_are_read_in_the_units_of_the_page() {
        let si =
            "<cfgcpf>1000000</cfgcpf><cfgcpt>500000</cfgcpt><scfgfu>N</scfgfu><scfgtu>Nm</scfgtu>";
        let counts = parse_counts(&page(si)).unwrap();
        assert_eq!((counts.per_newton, counts.per_newton_metre), (1e6, 5e5));
        // 1000 counts for 4.448 N (one pound-force), 100 for 0.113 N m (one pound-force inch).
        let other =
            "<cfgcpf>1000</cfgcpf><cfgcpt>100</cfgcpt><scfgfu>lbf</scfgfu><scfgtu>lbf-in</scfgtu>";
        let counts = parse_counts(&page(other)).unwrap();
        assert!((counts.per_newton - 224.809).abs() < 1e-3, "{counts:?}");
        assert!(
            (counts.per_newton_metre - 885.075).abs() < 1e-3,
            "{counts:?}"
        );
    }

    #[test]
    fn missing_and_invalid_fields_are_named() {
        let refused = |text: &str| parse_counts(text).unwrap_err().to_string();
        assert!(refused("404 not found").contains("not XML"));
        for (fields, words) in [
            ("", "cfgcpf = \"\""),
            ("<cfgcpf>-1</cfgcpf>", "above 0"),
            (
                "<cfgcpf>1</cfgcpf><scfgfu>stone</scfgfu>",
                "scfgfu = \"stone\"; expected one of N",
            ),
            ("<cfgcpf>1</cfgcpf><scfgfu>N</scfgfu>", "cfgcpt"),
        ] {
            let error = refused(&page(fields));
            assert!(error.contains(words), "{error}");
        }
    }

    proptest! {
        #[test]
        fn any_page_is_parsed_or_refused(text in ".{0,80}", fields in "(<cfgcpf>.{0,4}</cfgcpf>|<scfgfu>.{0,4}</scfgfu>){0,4}") {
            let _ = parse_counts(&text);
            if let Ok(counts) = parse_counts(&page(&fields)) {
                prop_assert!(counts.per_newton > 0.0 && counts.per_newton_metre > 0.0);
            }
        }
    }
}
