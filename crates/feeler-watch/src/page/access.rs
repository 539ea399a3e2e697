//! Access control: a request must contain the secret token and use the printed address.

use axum::http::header::{HOST, ORIGIN};
use axum::http::{HeaderMap, HeaderName, Method, Uri};
use feeler_report::run::make::RECORDING;
use subtle::ConstantTimeEq;

/// Length of a token in bytes.
const TOKEN: usize = 16;
/// Path segment of the WebSocket, after the token.
const SOCKET: &str = "live";
/// Default HTTP port, which is omitted from host names.
const HTTP: u16 = 80;

/// Reason for rejecting a request.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The request names another host, which indicates a DNS rebinding attack.
    #[error(
        "expected the address that feeler printed, at {expected}, got a request for the host {actual:?}"
    )]
    Host {
        /// Accepted hosts.
        expected: String,
        /// Host in the request.
        actual: String,
    },
    /// The request was sent by another page.
    #[error("expected a request from the page at {expected}, got one from {actual:?}")]
    Origin {
        /// Accepted origins.
        expected: String,
        /// Origin in the request.
        actual: String,
    },
    /// The token is missing or wrong.
    #[error("wrong or missing token; use the complete address that feeler printed")]
    Token,
}

/// The requested resource.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// The page itself.
    Page,
    /// The page's WebSocket.
    Socket,
    /// The recording that the page shows.
    Recording,
    /// An unknown resource.
    Nothing,
}

/// Port and secret token of a page.
pub struct Address {
    port: u16,
    token: String,
}

impl Address {
    /// Creates an address at this port with a random token.
    ///
    /// # Errors
    /// If the operating system provides no random numbers.
    pub fn draw(port: u16) -> Result<Self, getrandom::Error> {
        let mut bytes = [0; TOKEN];
        getrandom::fill(&mut bytes)?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { port, token })
    }

    /// URL of the page.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Path of the WebSocket.
    pub fn socket(&self) -> String {
        format!("/{}/{SOCKET}", self.token)
    }

    /// Accepted values of the `Host` header.
    pub fn hosts(&self) -> [String; 2] {
        ["127.0.0.1", "localhost"].map(|host| match self.port {
            HTTP => host.to_string(),
            port => format!("{host}:{port}"),
        })
    }

    /// Checks a request and returns the requested resource.
    ///
    /// # Errors
    /// If the host, origin or token is not the page's.
    pub fn admit(
        &self,
        method: &Method,
        uri: &Uri,
        headers: &HeaderMap,
    ) -> Result<Wanted, Refusal> {
        let hosts = self.hosts();
        let host = only(headers, HOST);
        let named = uri.authority().map(|authority| authority.as_str());
        let foreign = [host.as_deref(), named.or(host.as_deref())]
            .into_iter()
            .find(|host| !is_one_of(host.unwrap_or_default(), &hosts));
        if let Some(actual) = foreign {
            return Err(Refusal::Host {
                expected: hosts.join(" or "),
                actual: actual.unwrap_or_default().into(),
            });
        }
        let (token, rest) = split(uri.path());
        let wanted = match rest {
            "" if method == Method::GET => Wanted::Page,
            SOCKET if method == Method::GET => Wanted::Socket,
            RECORDING if method == Method::GET => Wanted::Recording,
            _ => Wanted::Nothing,
        };
        let origins = hosts.map(|host| format!("http://{host}"));
        // A page opened by its address has no origin.
        let needs_origin = wanted == Wanted::Socket || headers.contains_key(ORIGIN);
        let origin = only(headers, ORIGIN).unwrap_or_default();
        if needs_origin && !is_one_of(&origin, &origins) {
            return Err(Refusal::Origin {
                expected: origins.join(" or "),
                actual: origin,
            });
        }
        if !bool::from(token.as_bytes().ct_eq(self.token.as_bytes())) {
            return Err(Refusal::Token);
        }
        Ok(wanted)
    }
}

/// Splits a path into the token and the remaining path.
fn split(path: &str) -> (&str, &str) {
    let path = path.strip_prefix('/').unwrap_or(path);
    path.split_once('/').unwrap_or((path, ""))
}

/// Returns the value of a header that occurs exactly once.
fn only(headers: &HeaderMap, name: HeaderName) -> Option<String> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?;
    let value = String::from_utf8_lossy(value.as_bytes()).into_owned();
    values.next().is_none().then_some(value)
}

fn is_one_of(value: &str, expected: &[String]) -> bool {
    expected.iter().any(|one| one.eq_ignore_ascii_case(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(list: &[(HeaderName, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in list {
            headers.append(name, value.parse().expect("a value"));
        }
        headers
    }

    fn ask(address: &Address, path: &str, list: &[(HeaderName, &str)]) -> Result<Wanted, Refusal> {
        let uri = path.parse().expect("a path");
        address.admit(&Method::GET, &uri, &headers(list))
    }

    #[test]
    fn only_requests_with_token_and_address_are_admitted() {
        let address = Address::draw(4321).expect("a token");
        let page = format!("/{}/", address.token);
        let (host, origin) = ((HOST, "127.0.0.1:4321"), (ORIGIN, "http://localhost:4321"));
        assert_eq!(
            ask(&address, &page, std::slice::from_ref(&host)),
            Ok(Wanted::Page)
        );
        let socket = address.socket();
        assert_eq!(
            ask(&address, &socket, &[host.clone(), origin]),
            Ok(Wanted::Socket)
        );
        let foreign = [
            "127.0.0.1",
            "127.0.0.1:4322",
            "evil.example:4321",
            "127.0.0.1:4321.evil.example",
            "",
        ];
        for foreign in foreign {
            let said = ask(&address, &page, &[(HOST, foreign)]);
            assert!(matches!(said, Err(Refusal::Host { .. })), "{foreign}");
        }
        let twice = ask(&address, &page, &[host.clone(), host.clone()]);
        assert!(matches!(twice, Err(Refusal::Host { .. })));
        for foreign in ["http://evil.example", "null", "https://127.0.0.1:4321"] {
            let said = ask(&address, &socket, &[host.clone(), (ORIGIN, foreign)]);
            assert!(matches!(said, Err(Refusal::Origin { .. })), "{foreign}");
        }
        let none = ask(&address, &socket, std::slice::from_ref(&host));
        assert!(matches!(none, Err(Refusal::Origin { .. })));
        let other = Address::draw(4321).expect("a token");
        for path in ["/", "/live", "//", &format!("/{}/", other.token)] {
            let said = ask(&address, path, std::slice::from_ref(&host));
            assert_eq!(said, Err(Refusal::Token), "{path}");
        }
    }

    #[test]
    fn a_host_in_the_request_line_counts_too() {
        let address = Address::draw(4321).expect("a token");
        let path = format!("http://evil.example/{}/", address.token);
        let said = ask(&address, &path, &[(HOST, "127.0.0.1:4321")]);
        assert!(matches!(said, Err(Refusal::Host { .. })));
    }
}
