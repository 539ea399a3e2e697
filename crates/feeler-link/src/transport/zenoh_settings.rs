//! Zenoh configuration for the link.

use super::endpoints::{LinkConfig, LinkError};
use super::topic::Topic;
use crate::security::access_control::{Role, access_control};
use zenoh::Config;

/// Timeout of handshakes (ms).
const PATIENCE_MS: u64 = 2000;

/// Returns `endpoint` with the timeout for TLS handshakes appended.
fn patient(endpoint: &str) -> String {
    match endpoint.starts_with("tls/") {
        true => format!("{endpoint}#tls_handshake_timeout_ms={PATIENCE_MS}"),
        false => endpoint.into(),
    }
}

pub(crate) fn settings(config: &LinkConfig) -> Result<Config, LinkError> {
    let mut settings = Config::default();
    let mut set = |key: &str, value: serde_json::Value| {
        let set = settings.insert_json5(key, &value.to_string());
        set.map_err(|e| LinkError::Transport(format!("{key}: {e}")))
    };
    // A router forwards the messages of its clients. Clients connect only to the router and accept no connections.
    set(
        "mode",
        if config.is_hand { "router" } else { "client" }.into(),
    )?;
    let listen = config.listen.iter().map(|endpoint| patient(endpoint));
    set("listen/endpoints", listen.collect::<Vec<_>>().into())?;
    // Connections that do not complete their handshake are closed soon, and many may be pending.
    set("transport/unicast/accept_timeout", PATIENCE_MS.into())?;
    set("transport/unicast/accept_pending", 1000.into())?;
    set("connect/endpoints", config.connect.clone().into())?;
    // Retries forever, without blocking other work.
    set("connect/timeout_ms", (-1).into())?;
    set("connect/exit_on_failure", false.into())?;
    set(
        "connect/retry",
        serde_json::json!({
            "period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 1.5
        }),
    )?;
    set("listen/exit_on_failure", true.into())?;
    // Only configured endpoints are used.
    set("scouting/multicast/enabled", false.into())?;
    set("scouting/gossip/enabled", false.into())?;
    // The default queue size of 2 drops half of each burst.
    for priority in ["real_time", "interactive_high", "data_high", "data"] {
        set(
            &format!("transport/link/tx/queue/size/{priority}"),
            16.into(),
        )?;
    }
    // Never wait for a frozen peer that does not read. An image larger than the queue must wait until its first
    // fragments have been sent.
    let drop = "transport/link/tx/queue/congestion_control/drop";
    set(&format!("{drop}/wait_before_drop"), 0.into())?;
    set(
        &format!("{drop}/max_wait_before_drop_fragments"),
        5000.into(),
    )?;
    // A longer outage closes the link, so that stale data does not arrive in a burst afterwards.
    set("transport/link/tx/lease", 1000.into())?;
    let most = Topic::Picture(0).most_bytes();
    set("transport/link/rx/max_message_size", most.into())?;
    set("timestamping/enabled", false.into())?;
    set("adminspace/enabled", false.into())?;
    if let Some([ca, certificate, key]) = config.certificate_files() {
        let path = |path: &std::path::Path| path.display().to_string();
        set("transport/link/tls/root_ca_certificate", path(&ca).into())?;
        set("transport/link/tls/enable_mtls", true.into())?;
        set("transport/link/tls/close_link_on_expiration", true.into())?;
        for side in ["listen", "connect"] {
            set(
                &format!("transport/link/tls/{side}_certificate"),
                path(&certificate).into(),
            )?;
            set(
                &format!("transport/link/tls/{side}_private_key"),
                path(&key).into(),
            )?;
        }
    }
    let role = match config.is_hand {
        true => Role::Hand,
        false => Role::Member,
    };
    if let Some(rules) = access_control(config, role)? {
        set("access_control", rules)?;
    }
    Ok(settings)
}
