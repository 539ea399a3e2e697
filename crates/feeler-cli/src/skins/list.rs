//! Lists serial ports and the skins on them.

use crate::{CommandError, Outcome};
use feeler::sensor::skin::SkinProtocol;
use feeler::sensor::taxel::BUILT_IN_TAXELS;
use feeler_sources::skin::{FoundSkin, ListedPort, list_ports, probe_port};
use std::io::Write;

/// Lists `ports`, or all USB serial ports if empty.
pub fn list(ports: &[String], out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let named = |port: &String| ListedPort {
        path: port.clone(),
        product: String::new(),
    };
    let listed = match ports {
        [] => list_ports()?,
        _ => ports.iter().map(named).collect(),
    };
    if listed.is_empty() {
        writeln!(
            out,
            "no USB serial port; plug the skin in, or name its port"
        )?;
        return Ok(Outcome::GivenUp);
    }
    let mut found = 0;
    for ListedPort { path, product } in listed {
        let product = match product.is_empty() {
            true => String::new(),
            false => format!(" ({product})"),
        };
        write!(out, "{path}{product}: ")?;
        out.flush()?;
        match probe_port(&path) {
            Ok(Some(skin)) => {
                found += 1;
                writeln!(out, "{}", in_words(&skin, &path))?;
            }
            Ok(None) => writeln!(out, "no skin found")?,
            Err(error) => writeln!(out, "{error}")?,
        }
    }
    Ok(match found {
        0 => Outcome::GivenUp,
        _ => Outcome::Done,
    })
}

/// Describes a skin and the command that reads it.
fn in_words(skin: &FoundSkin, path: &str) -> String {
    let kind = match skin.serial.protocol {
        SkinProtocol::Magnetometers => "board with magnetometers".to_string(),
        SkinProtocol::Flexitac => "FlexiTac".to_string(),
        SkinProtocol::Paxini => format!("PaXini module at address {}", skin.serial.address),
    };
    let taxels = skin.taxels.map(|taxels| format!(", {taxels} taxels"));
    let rate = skin.rate.map(|rate| format!(", {rate:.0} Hz"));
    let names: Vec<_> = BUILT_IN_TAXELS
        .iter()
        .filter(|built_in| {
            built_in.layout().is_ok_and(|layout| {
                let fits = skin
                    .taxels
                    .is_none_or(|taxels| taxels == layout.taxels.len());
                let protocol = layout.serial.map(|serial| serial.protocol);
                fits && protocol == Some(skin.serial.protocol)
            })
        })
        .map(|built_in| built_in.name)
        .collect();
    let layouts = match names.is_empty() {
        true => "a custom layout".to_string(),
        false => names.join(" or "),
    };
    format!(
        "{kind}{}{}; feeler sense serial:{path} --taxels {layouts}",
        taxels.unwrap_or_default(),
        rate.unwrap_or_default()
    )
}
