//! Video4Linux cameras as text and JSON.

use super::{Kind, Listed};
use feeler_sources::video::{ListedDevice, VideoFormat, VideoInfo, VideoSize, list as found};
use serde_json::{Value, json};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

pub fn list() -> Kind {
    let mut kind = Kind {
        name: "Video4Linux",
        cameras: Vec::new(),
        missing: Vec::new(),
    };
    match found() {
        Ok(devices) => {
            for ListedDevice {
                device,
                by_id,
                info,
            } in devices
            {
                match info {
                    Ok(info) => kind.cameras.push(listed(&device, by_id.as_deref(), &info)),
                    Err(error) => kind.missing.push(why_not(&device, &error)),
                }
            }
        }
        Err(error) => kind.missing.push(format!("/dev: {error}")),
    }
    kind
}

/// Describes why a device cannot be queried, and the remedy.
fn why_not(device: &Path, error: &io::Error) -> String {
    let device_name = device.display();
    if error.kind() != io::ErrorKind::PermissionDenied {
        return format!("{device_name}: {error}");
    }
    let groups = std::fs::read_to_string("/etc/group").unwrap_or_default();
    let group = device.metadata().ok().map(|metadata| metadata.gid());
    let group = group.and_then(|gid| name_of_group(&groups, gid));
    let group = group.unwrap_or("video");
    format!(
        "{device_name}: {error}; requires the group {group} (sudo usermod -aG {group} $USER, then log in again)"
    )
}

/// Returns the name of the group `gid` from the contents of `/etc/group`.
fn name_of_group(groups: &str, gid: u32) -> Option<&str> {
    groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        let number: u32 = fields.nth(1)?.parse().ok()?;
        (number == gid).then_some(name)
    })
}

fn listed(device: &Path, by_id: Option<&Path>, info: &VideoInfo) -> Listed {
    let name = device.display().to_string();
    let VideoInfo {
        name: card,
        driver,
        bus,
        formats,
        controls,
    } = info;
    let mut words = vec![format!("{card} ({driver}, {bus})")];
    words.extend(by_id.map(|path| path.display().to_string()));
    words.extend(formats.iter().map(format_words));
    words.extend(controls.iter().map(|control| {
        let ([low, high], name) = (control.range, &control.name);
        let (step, default) = (control.step, control.default);
        format!("{name}: {low} to {high}, step {step}, default {default}")
    }));
    let formats: Vec<Value> = formats.iter().map(format_json).collect();
    let controls = controls.iter().map(|control| {
        json!({
            "name": control.name, "range": control.range, "step": control.step, "default": control.default,
        })
    });
    let controls: Vec<Value> = controls.collect();
    let json = json!({
        "source": name, "by_id": by_id, "name": card, "driver": driver, "bus": bus, "formats": formats,
        "controls": controls,
    });
    Listed { name, words, json }
}

fn format_words(format: &VideoFormat) -> String {
    let sizes: Vec<String> = format.sizes.iter().map(size_words).collect();
    let VideoFormat {
        fourcc,
        description,
        ..
    } = format;
    format!("{fourcc} ({description}): {}", sizes.join(", "))
}

fn size_words(size: &VideoSize) -> String {
    let range = |[low, high]: [u32; 2]| match low == high {
        true => low.to_string(),
        false => format!("{low}..{high}"),
    };
    let (columns, rows) = (range(size.columns), range(size.rows));
    let rates: Vec<String> = size.rates.iter().map(|rate| format!("{rate:.3}")).collect();
    let rates: Vec<&str> = rates
        .iter()
        .map(|rate| rate.trim_end_matches('0').trim_end_matches('.'))
        .collect();
    match rates.is_empty() {
        true => format!("{columns}x{rows}"),
        false => format!("{columns}x{rows} at {} Hz", rates.join(" ")),
    }
}

fn format_json(format: &VideoFormat) -> Value {
    let sizes = format
        .sizes
        .iter()
        .map(|size| json!({ "columns": size.columns, "rows": size.rows, "rates": size.rates }));
    let sizes: Vec<Value> = sizes.collect();
    json!({ "fourcc": format.fourcc, "description": format.description, "sizes": sizes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use feeler_sources::video::VideoControl;

    #[test]
    fn describes_a_camera_as_text_and_json() {
        let size = |columns: [u32; 2], rows: [u32; 2], rates: &[f64]| VideoSize {
            columns,
            rows,
            rates: rates.to_vec(),
        };
        let info = VideoInfo {
            name: "HD Webcam".into(),
            driver: "uvcvideo".into(),
            bus: "usb-0000:00:14.0-1".into(),
            formats: vec![VideoFormat {
                fourcc: "YUYV".into(),
                description: "YUYV 4:2:2".into(),
                sizes: vec![
                    size([640; 2], [480; 2], &[15.0, 30.0]),
                    size([16, 1280], [16, 720], &[]),
                    size([320; 2], [240; 2], &[29.97]),
                ],
            }],
            controls: vec![VideoControl {
                name: "Gain".into(),
                range: [0, 100],
                step: 1,
                default: 64,
            }],
        };
        let by_id = Path::new("/dev/v4l/by-id/usb-cam");
        let listed = listed(Path::new("/dev/video2"), Some(by_id), &info);
        assert_eq!(listed.name, "/dev/video2");
        let expected = [
            "HD Webcam (uvcvideo, usb-0000:00:14.0-1)",
            "/dev/v4l/by-id/usb-cam",
            "YUYV (YUYV 4:2:2): 640x480 at 15 30 Hz, 16..1280x16..720, 320x240 at 29.97 Hz",
            "Gain: 0 to 100, step 1, default 64",
        ];
        assert_eq!(listed.words, expected);
        assert_eq!(listed.json["formats"][0]["sizes"][0]["rates"][1], 30.0);
        assert_eq!(listed.json["controls"][0]["range"][1], 100);
    }

    #[test]
    fn permission_error_names_the_required_group() {
        let groups = "root:x:0:\nbroken\nvideo:x:44:ann,bob\n";
        assert_eq!(name_of_group(groups, 44), Some("video"));
        assert_eq!(name_of_group(groups, 45), None);
        let denied = io::Error::from(io::ErrorKind::PermissionDenied);
        let words = why_not(Path::new("/dev/null"), &denied);
        assert!(words.contains("requires the group root"), "{words}");
    }
}
