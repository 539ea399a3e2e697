//! Lists Video4Linux cameras and their capabilities.

use linuxvideo::format::{FrameIntervals, FrameSizes, PixelFormat};
use linuxvideo::{BufType, CapabilityFlags, Device, Fract};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// A device in `/dev` whose name is that of a video device.
#[derive(Debug)]
pub struct ListedDevice {
    /// Path of the device, as in `/dev/video0`.
    pub device: PathBuf,
    /// Link in `/dev/v4l/by-id`, which does not depend on the USB port.
    pub by_id: Option<PathBuf>,
    /// Description of the camera, or the error of reading it.
    pub info: io::Result<VideoInfo>,
}

/// Description of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct VideoInfo {
    /// Name.
    pub name: String,
    /// Name of the driver.
    pub driver: String,
    /// Bus address.
    pub bus: String,
    /// Available pixel formats.
    pub formats: Vec<VideoFormat>,
    /// Controls that can be varied.
    pub controls: Vec<VideoControl>,
}

/// A pixel format of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct VideoFormat {
    /// Four-character code, as in `GREY`.
    pub fourcc: String,
    /// Description by the driver.
    pub description: String,
    /// Available sizes.
    pub sizes: Vec<VideoSize>,
}

/// A size, or a range of sizes, of a camera's images.
#[derive(Debug, Clone, PartialEq)]
pub struct VideoSize {
    /// Minimum and maximum width, px.
    pub columns: [u32; 2],
    /// Minimum and maximum height, px.
    pub rows: [u32; 2],
    /// Frame rates at the largest size, Hz, in increasing order: all rates, or the ends of their range.
    pub rates: Vec<f64>,
}

/// A control of a camera.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VideoControl {
    /// Name.
    pub name: String,
    /// Minimum and maximum value.
    pub range: [i32; 2],
    /// Step between values.
    pub step: i32,
    /// Default value.
    pub default: i32,
}

/// Lists all video devices, except those that cannot capture (such as the metadata stream of a camera).
///
/// # Errors
/// If `/dev` cannot be read.
pub fn list() -> io::Result<Vec<ListedDevice>> {
    let mut devices = Vec::new();
    for entry in fs::read_dir("/dev")? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let number = name.strip_prefix("video").unwrap_or_default();
        if let Ok(number) = number.parse::<u32>() {
            devices.push((number, path));
        }
    }
    devices.sort();
    let listed = devices.into_iter().filter_map(|(_, device)| {
        let info = info(&device).transpose()?;
        let by_id = by_id(&device);
        Some(ListedDevice {
            device,
            by_id,
            info,
        })
    });
    Ok(listed.collect())
}

/// Returns the link in `/dev/v4l/by-id` to `device`.
fn by_id(device: &Path) -> Option<PathBuf> {
    let links = fs::read_dir("/dev/v4l/by-id").ok()?;
    let links = links.filter_map(Result::ok).map(|link| link.path());
    links
        .into_iter()
        .find(|link| fs::canonicalize(link).is_ok_and(|to| to == device))
}

/// Reads the description of the device at `path`; `None` if it cannot capture images.
pub(super) fn info(path: &Path) -> io::Result<Option<VideoInfo>> {
    let device = Device::open(path)?;
    let capabilities = device.capabilities()?;
    let takes = CapabilityFlags::VIDEO_CAPTURE;
    if !capabilities.device_capabilities().contains(takes) {
        return Ok(None);
    }
    let formats = device.formats(BufType::VIDEO_CAPTURE);
    let formats = formats.filter_map(Result::ok).map(|format| {
        let pixels = format.pixel_format();
        VideoFormat {
            fourcc: String::from_utf8_lossy(&pixels.as_fourcc()).into_owned(),
            description: format.description().into(),
            sizes: sizes(&device, pixels),
        }
    });
    let controls = device.controls().filter_map(Result::ok);
    let controls = controls.filter(|control| control.minimum() < control.maximum());
    let controls = controls.map(|control| VideoControl {
        name: control.name().into(),
        range: [control.minimum(), control.maximum()],
        step: control.step(),
        default: control.default_value(),
    });
    Ok(Some(VideoInfo {
        name: capabilities.card().into(),
        driver: capabilities.driver().into(),
        bus: capabilities.bus_info().into(),
        formats: formats.collect(),
        controls: controls.collect(),
    }))
}

fn sizes(device: &Device, pixels: PixelFormat) -> Vec<VideoSize> {
    let sizes: Vec<[[u32; 2]; 2]> = match device.frame_sizes(pixels) {
        Ok(FrameSizes::Discrete(sizes)) => sizes
            .iter()
            .map(|size| [[size.width(); 2], [size.height(); 2]])
            .collect(),
        Ok(FrameSizes::Stepwise(range) | FrameSizes::Continuous(range)) => vec![[
            [range.min_width(), range.max_width()],
            [range.min_height(), range.max_height()],
        ]],
        // Drivers may not support this query.
        Err(_) => Vec::new(),
    };
    let size = |[columns, rows]: [[u32; 2]; 2]| {
        let intervals = device.frame_intervals(pixels, columns[1], rows[1]);
        VideoSize {
            columns,
            rows,
            rates: intervals.map_or_else(|_| Vec::new(), |intervals| rates(&intervals)),
        }
    };
    sizes.into_iter().map(size).collect()
}

fn rates(intervals: &FrameIntervals) -> Vec<f64> {
    let rate = |interval: &Fract| {
        f64::from(interval.denominator()) / f64::from(interval.numerator().max(1))
    };
    let mut rates: Vec<f64> = match intervals {
        FrameIntervals::Discrete(all) => all.iter().map(|one| rate(one.fract())).collect(),
        FrameIntervals::Stepwise(range) | FrameIntervals::Continuous(range) => {
            vec![rate(range.max()), rate(range.min())]
        }
    };
    rates.sort_by(f64::total_cmp);
    rates
}
