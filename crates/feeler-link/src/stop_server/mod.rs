//! Stops a hand by datagrams, without a connection.

#[cfg(feature = "zenoh")]
pub(crate) mod call;
#[cfg(feature = "zenoh")]
pub(crate) mod guard;
#[cfg(feature = "zenoh")]
pub(crate) mod proof;
#[cfg(feature = "zenoh")]
pub(crate) mod server;
pub mod wire;

#[cfg(feature = "zenoh")]
pub use call::{StopCallError, call_stop};
#[cfg(feature = "zenoh")]
pub use guard::StopGuard;
#[cfg(feature = "zenoh")]
pub use proof::Credentials;
#[cfg(feature = "zenoh")]
pub use proof::CredentialsError;
#[cfg(feature = "zenoh")]
pub use server::StopServerError;
#[cfg(feature = "zenoh")]
pub use server::{StopAnswer, StopServer};
