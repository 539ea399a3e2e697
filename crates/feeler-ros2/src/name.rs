//! Names of nodes, topics and services, as ROS 2 has them: parts of letters, digits and underscores between slashes.

use std::fmt;

/// Most bytes of a name.
const MAX_BYTES: usize = 255;
/// The highest domain that DDS can have; Zenoh has no limit, but tools check this one.
pub const MAX_DOMAIN: u32 = 232;

/// Why a name cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NameError {
    /// A part of it has other characters, or begins with a digit.
    #[error(
        "{what} {name:?}: letters, digits and underscores expected, not beginning with a digit, found {part:?}"
    )]
    Part {
        /// What it is the name of.
        what: &'static str,
        /// The name.
        name: String,
        /// What is wrong of it.
        part: String,
    },
    /// It is too long.
    #[error("{what}: at most {MAX_BYTES} bytes expected, found {bytes}")]
    Long {
        /// What it is the name of.
        what: &'static str,
        /// How long it is.
        bytes: usize,
    },
    /// There is no such domain.
    #[error("domain id: 0 to {MAX_DOMAIN} expected, found {0}")]
    Domain(u32),
}

/// Whose name a node has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeName {
    domain: u32,
    /// `/`, or `/` before each part.
    namespace: String,
    name: String,
}

impl NodeName {
    /// The node `name` of a `namespace`, which may be empty, in a `domain`.
    ///
    /// # Errors
    /// When one of these is no such thing.
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

    /// The domain.
    pub fn domain(&self) -> u32 {
        self.domain
    }

    /// `/`, or `/` before each part.
    pub fn namespace(&self) -> &str {
        &self.namespace
    }

    /// The node's own name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole name of a topic or service: `/a` is that already, `a` is in the node's namespace, and `~/a` its own.
    ///
    /// # Errors
    /// When it is no name.
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
    fn what_is_no_name_is_refused() {
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
