//! Who is let in: whoever knows the token, and comes by the address that was printed.

use axum::http::header::{HOST, ORIGIN};
use axum::http::{HeaderMap, HeaderName, Method, Uri};
use feeler_report::make::RECORDING;
use subtle::ConstantTimeEq;

/// Bytes of a token.
const TOKEN: usize = 16;
/// What follows the token in the path of the socket.
const SOCKET: &str = "live";
/// The port that an address need not name.
const HTTP: u16 = 80;

/// Why somebody is not let in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The address of the page was not typed, nor followed here.
    #[error(
        "the request is for the host {actual:?}; expected the address that feeler printed, at {expected}"
    )]
    Host {
        /// Where the page is.
        expected: String,
        /// Where it was looked for.
        actual: String,
    },
    /// Another page asks.
    #[error("the request comes from {actual:?}; expected from the page at {expected}")]
    Origin {
        /// Where the page is.
        expected: String,
        /// Who asks.
        actual: String,
    },
    /// The token is another, or none.
    #[error(
        "the address does not end with the token of this program; expected the whole address that feeler printed"
    )]
    Token,
}

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// The page.
    Page,
    /// Its socket.
    Socket,
    /// The recording that it is of.
    Recording,
    /// Something that is not there.
    Nothing,
}

/// Where a page is, and its token.
pub struct Address {
    port: u16,
    token: String,
}

impl Address {
    /// At this port, with a token that nobody can guess.
    ///
    /// # Errors
    /// When the system gives no random numbers.
    pub fn draw(port: u16) -> Result<Self, getrandom::Error> {
        let mut bytes = [0; TOKEN];
        getrandom::fill(&mut bytes)?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { port, token })
    }

    /// What to type.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Path of the socket.
    pub fn socket(&self) -> String {
        format!("/{}/{SOCKET}", self.token)
    }

    /// The hosts by which the page is reached.
    pub fn hosts(&self) -> [String; 2] {
        ["127.0.0.1", "localhost"].map(|host| match self.port {
            HTTP => host.to_string(),
            port => format!("{host}:{port}"),
        })
    }

    /// What is wanted by a request, if whoever asks is let in.
    ///
    /// # Errors
    /// When host, origin or token are not this page's.
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
        // A page that is typed has none.
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

/// The token of a path, and what follows it.
fn split(path: &str) -> (&str, &str) {
    let path = path.strip_prefix('/').unwrap_or(path);
    path.split_once('/').unwrap_or((path, ""))
}

/// The value of a header that is there once.
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
    fn only_who_knows_the_token_and_comes_by_the_address_is_let_in() {
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
