//! Certificates of a rig's computers and the rights that they grant.

pub(crate) mod access_control;
#[cfg(feature = "zenoh")]
pub(crate) mod authority;
#[cfg(feature = "zenoh")]
pub(crate) mod certificate_error;
#[cfg(feature = "zenoh")]
pub(crate) mod certificate_list;
pub(crate) mod files;
#[cfg(feature = "zenoh")]
pub(crate) mod own_certificate;
#[cfg(feature = "zenoh")]
pub(crate) mod register;
pub(crate) mod right;
#[cfg(feature = "zenoh")]
pub(crate) mod validity;
pub(crate) mod withdrawn;

pub use access_control::{Role, access_control};
#[cfg(feature = "zenoh")]
pub use authority::{Authority, Listed};
#[cfg(feature = "zenoh")]
pub use certificate_error::CertificateError;
pub use files::FileError;
#[cfg(feature = "zenoh")]
pub use own_certificate::{OwnCertificate, OwnCertificateError};
#[cfg(feature = "zenoh")]
pub use register::RegisterError;
pub use right::{CertificateName, Right, RightError};
#[cfg(feature = "zenoh")]
pub use validity::{DAYS, Validity};
pub use withdrawn::{WITHDRAWN, WithdrawnError};
