//! GenICam cameras as text and JSON.

use super::{Kind, Listed};
use feeler_sources::genicam::{Abilities, GenicamDevice, GenicamInfo, Range, list as found};
use serde_json::json;

pub fn list(simulated: bool) -> Kind {
    let (cameras, missing) = match found(simulated) {
        Ok(cameras) => (cameras.iter().map(listed).collect(), Vec::new()),
        Err(error) => (Vec::new(), vec![error.to_string()]),
    };
    Kind {
        name: "GenICam",
        cameras,
        missing,
    }
}

fn listed(camera: &GenicamInfo) -> Listed {
    let GenicamInfo { device, abilities } = camera;
    let GenicamDevice {
        id,
        vendor,
        model,
        serial,
        protocol,
        address,
    } = device;
    let name = format!("genicam:{id}");
    let mut words = vec![format!(
        "{vendor} {model}, serial number {serial} ({protocol}, {address})"
    )];
    let mut json = json!({
        "source": name, "id": id, "vendor": vendor, "model": model, "serial": serial, "protocol": protocol,
        "address": address,
    });
    match abilities {
        Ok(abilities) => {
            words.extend(in_words(abilities));
            json["sensor_size"] = json!(abilities.sensor_size);
            json["region"] = json!(abilities.region);
            json["pixel_formats"] = json!(abilities.pixel_formats);
            json["exposure"] = json!(abilities.exposure);
            json["gain"] = json!(abilities.gain);
            json["rate"] = json!(abilities.rate);
            json["triggers"] = json!(abilities.triggers);
        }
        Err(reason) => {
            words.push(format!("capabilities unknown: {reason}"));
            json["missing"] = json!(reason);
        }
    }
    Listed { name, words, json }
}

fn in_words(abilities: &Abilities) -> [String; 3] {
    let [columns, rows] = abilities.sensor_size;
    let [column, row, width, height] = abilities.region;
    let range = |range: Option<Range>, unit: &str| match range {
        Some([low, high]) => format!("{low} to {high}{unit}"),
        None => "fixed".into(),
    };
    [
        format!(
            "sensor {columns}x{rows} px, now {width}x{height} px from {column},{row}; {}",
            abilities.pixel_formats.join(", ")
        ),
        format!(
            "exposure {}, gain {}, rate {}",
            range(abilities.exposure, " s"),
            range(abilities.gain, ""),
            range(abilities.rate, " Hz")
        ),
        format!(
            "trigger free, {}",
            abilities
                .triggers
                .join(", ")
                .replace("Software", "software")
        ),
    ]
}
