//! Hand of a networked rig: permission to move, active stops, orders, remote joints and sensors.

pub(crate) mod hand_client;
pub(crate) mod holds;
pub(crate) mod order;
pub(crate) mod own_stop;
pub(crate) mod permission;
pub(crate) mod remote;
pub(crate) mod run_clock;

pub use hand_client::{Ack, HandClient, INTERVAL, STEADY};
pub use holds::{ActiveStop, Cause};
pub use order::{Order, stop_to_resume};
pub use permission::Permission;
pub use remote::{RemoteFinger, RemoteHand};
pub use run_clock::{RigSpeed, RunClock};
