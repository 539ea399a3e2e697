//! Shows a run, a recording or a rig in the browser.

mod access;
mod client;
mod download;
mod feed;
mod live_run;
mod pump;
mod recording;
mod rig;
mod server;
mod site;
mod source;
mod state;

pub use live_run::LiveRun;
pub use recording::serve_recording;
pub use rig::serve_rig;

/// Options of a page's server.
#[derive(Debug, Clone, Copy, Default)]
pub struct ServerOptions {
    /// Port on this computer; 0 for any free port.
    pub port: u16,
    /// `true` to open the page in the default browser.
    pub open: bool,
}
