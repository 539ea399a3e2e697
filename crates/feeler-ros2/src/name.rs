//! Names of nodes, topics and services in ROS 2: parts of letters, digits and underscores, separated by slashes.

use std::fmt;

/// Maximum length of a name in bytes.
const MAX_BYTES: usize = 255;
/// Maximum domain id of DDS. Zenoh does not require it, but ROS 2 tools do.
pub const MAX_DOMAIN: u32 = 232;

/// Error for an invalid name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NameError {
    /// A part of the name is empty, contains an invalid character, or begins with a digit.
    #[error(
        "{what} {name:?}: expected letters, digits and underscores, not beginning with a digit, got {part:?}"
    )]
    Part {
        /// Kind of name: `namespace`, `node name` or `topic`.
        what: &'static str,
        /// Full name of the node, with its namespace.
        name: String,
        /// Invalid part.
        part: String,
    },
    /// The name is too long.
    #[error("{what}: expected at most {MAX_BYTES} bytes, got {bytes}")]
    Long {
        /// Kind of name: `namespace`, `node name` or `topic`.
        what: &'static str,
        /// Length in bytes.
        bytes: usize,
    },
    /// The domain id is too large.
    #[error("domain id: expected 0 to {MAX_DOMAIN}, got {0}")]
    Domain(u32),
}

/// Domain, namespace and name of a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeName {
    domain: u32,
    /// Namespace, such as `/` or `/lab/left`.
    namespace: String,
    name: String,
}

impl NodeName {
    /// Creates the name of a node. `namespace` may be empty.
    ///
    /// # Errors
    /// If an argument is invalid.
    pub fn new(domain: u32, namespace: &str, name: &str) -> Result<Self, NameError> {
        if domain > MAX_DOMAIN {
            return Err(NameError::Domain(domain));
        }
        check_length("namespace", namespace)?;
        let namespace = namespace.trim_matches('/');
        if !namespace.is_empty() {
            check_parts("namespace", namespace)?;
        }
        check_length("node name", name)?;
        check_part("node name", name, name)?;
        Ok(Self {
            domain,
            namespace: format!("/{namespace}"),
            name: name.into(),
        })
    }

    /// Domain id.
    pub fn domain(&self) -> u32 {
        self.domain
    }

    /// Namespace, such as `/` or `/lab/left`.
    pub fn namespace(&self) -> &str {
        &self.namespace
    }

    /// Name of the node without its namespace.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Resolves the name of a topic or service: `/a` is absolute, `a` is relative to the node's namespace, and `~/a` to
    /// the node.
    ///
    /// # Errors
    /// If the resolved name is invalid.
    pub fn resolve(&self, topic: &str) -> Result<String, NameError> {
        let namespace = self.namespace.trim_end_matches('/');
        let whole = match (topic.strip_prefix('/'), topic.strip_prefix("~/")) {
            (Some(_), _) => topic.to_string(),
            (_, Some(own)) => format!("{namespace}/{}/{own}", self.name),
            _ => format!("{namespace}/{topic}"),
        };
        check_length("topic", &whole)?;
        check_parts("topic", &whole[1..])?;
        Ok(whole)
    }
}

impl fmt::Display for NodeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.namespace.trim_end_matches('/'), self.name)
    }
}

fn check_length(what: &'static str, name: &str) -> Result<(), NameError> {
    match name.len() {
        bytes if bytes > MAX_BYTES => Err(NameError::Long { what, bytes }),
        _ => Ok(()),
    }
}

fn check_parts(what: &'static str, name: &str) -> Result<(), NameError> {
    name.split('/')
        .try_for_each(|part| check_part(what, name, part))
}

fn check_part(what: &'static str, name: &str, part: &str) -> Result<(), NameError> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let begins = part.chars().next().is_some_and(|c| !c.is_ascii_digit());
    if begins && part.chars().all(is_word) {
        return Ok(());
    }
    Err(NameError::Part {
        what,
        name: name.into(),
        part: part.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_resolve_as_in_ros() {
        let node = NodeName::new(3, "lab/left/", "feeler").unwrap();
        assert_eq!(node.to_string(), "/lab/left/feeler");
        let resolve = |topic| node.resolve(topic).unwrap();
        assert_eq!(resolve("/tf"), "/tf");
        assert_eq!(resolve("joint_states"), "/lab/left/joint_states");
        assert_eq!(
            resolve("~/get_parameters"),
            "/lab/left/feeler/get_parameters"
        );
        let root = NodeName::new(0, "", "feeler").unwrap();
        assert_eq!(root.namespace(), "/");
        assert_eq!(root.resolve("a/b").unwrap(), "/a/b");
        assert_eq!(root.to_string(), "/feeler");
    }

    #[test]
    fn invalid_names_are_rejected() {
        for name in ["", "1a", "a b", "a/b", "a%", "ä", "*"] {
            assert!(NodeName::new(0, "/", name).is_err(), "{name}");
        }
        assert_eq!(NodeName::new(233, "/", "a"), Err(NameError::Domain(233)));
        let node = NodeName::new(0, "/", "a").unwrap();
        for topic in ["", "/", "a//b", "/a/", "a/1", "a/**", "~", "~/"] {
            assert!(node.resolve(topic).is_err(), "{topic}");
        }
        assert!(node.resolve(&"a".repeat(256)).is_err());
    }
}
