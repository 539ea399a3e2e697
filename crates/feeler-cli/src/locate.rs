//! The `feeler locate` subcommand.

use super::locate_preview::preview;
use super::{CommandError, Outcome};
use crate::options::{Json, Overwrite};
use feeler::sensor::fingertip::{CameraConfig, DomeGeometry, LocatedLayout};
use feeler::sensor::locate;
use feeler::sensor::locate::{
    LocateConfig, LocateWarning, MeanPicture, Polarity, ReferencePicture,
};
use feeler_console::{Outputs, Steps, Working, print_json};
use feeler_lab::config::Experiment;
use feeler_lab::sensor::{file_of, named_picture};
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Images of the unloaded sensor; elements are detected in their mean.
    ///
    /// Of a video (.avi, .mp4, .mkv, .mov, .webm, .m4v; requires ffmpeg) the first frame is used, or with VIDEO@TIME
    /// the frame nearest to TIME (s).
    #[arg(required = true, value_name = "REFERENCE.png")]
    references: Vec<PathBuf>,
    /// Layout file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// PNG file to write: the image with the detected elements drawn over it.
    #[arg(long, value_name = "FILE")]
    preview: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Polarity of the elements: bright on dark, or dark on bright [default: the one that yields the more regular
    /// pattern]
    #[arg(long, value_name = "bright|dark")]
    polarity: Option<Polarity>,
    /// Diameter of a spot (px) [default: estimated from the image]
    #[arg(long, value_name = "PX")]
    spot_diameter: Option<f64>,
    /// Diameter of an element (px); spots within it form one element [default: groups of equal numbers of spots, if
    /// any]
    #[arg(long, value_name = "PX")]
    element_diameter: Option<f64>,
    /// Radius of a sub-region, relative to the distance to the nearest element.
    #[arg(long, value_name = "PART", default_value_t = LocateConfig::default().region_radius)]
    region_radius: f64,
    /// Experiment that defines the geometry of dome and camera: a file, or the name of a built-in one.
    #[arg(long, value_name = "EXPERIMENT", conflicts_with_all = ["dome_radius", "focal_length_px", "standoff", "axis_px"])]
    dome: Option<String>,
    /// Radius of the dome (m).
    #[arg(long, value_name = "M", requires_all = ["focal_length_px", "standoff"])]
    dome_radius: Option<f64>,
    /// Focal length of the camera (px).
    #[arg(long, value_name = "PX", requires = "dome_radius")]
    focal_length_px: Option<f64>,
    /// Distance of the camera's pinhole behind the dome's centre (m).
    #[arg(long, value_name = "M", requires = "dome_radius", value_parser = distance)]
    standoff: Option<f64>,
    /// Column and row of the dome's axis in the image (px) [default: the image's centre]
    #[arg(
        long,
        value_name = "COLUMN,ROW",
        requires = "dome_radius",
        value_delimiter = ',',
        num_args = 1
    )]
    axis_px: Vec<f64>,
    #[command(flatten)]
    json: Json,
}

/// Output of `--json`.
#[derive(Serialize)]
struct Found<'a> {
    /// Path of the layout.
    layout: &'a Path,
    /// Path of the preview, if any.
    preview: Option<&'a Path>,
    elements: usize,
    /// `bright` or `dark`.
    polarity: String,
    spots_per_element: usize,
    spot_diameter_px: f64,
    spacing_px: f64,
    width_px: usize,
    height_px: usize,
    /// Maximum gray level of the background; for dark spots, its minimum.
    ground: u8,
    /// Number of rings of elements on the dome, or `None` if the dome is unknown.
    rings: Option<usize>,
    warnings: Vec<String>,
}

fn distance(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    let distance = number.filter(|number| number.is_finite() && *number >= 0.0);
    distance.ok_or_else(|| "expected a distance, 0 m or more".into())
}

pub fn locate(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let references = arguments.references.iter().map(|name| Some(file_of(name)));
    let inputs = references.chain([arguments.dome.as_deref().map(Path::new)]);
    let mut outputs = Outputs::new(arguments.overwrite.force, inputs);
    // Opened first, because locating takes a while.
    let layout_file = outputs.create(&arguments.output, "--output")?;
    let preview_file = match &arguments.preview {
        Some(path) => Some(outputs.create(path, "--preview")?),
        None => None,
    };
    let reference = mean_of_files(&arguments.references)?;
    let config = LocateConfig {
        polarity: arguments.polarity,
        spot_diameter_px: arguments.spot_diameter,
        element_diameter_px: arguments.element_diameter,
        region_radius: arguments.region_radius,
    };
    let working = Working::on("locating the elements");
    let located = locate::locate(&reference, &config)?;
    drop(working);
    let layout = match dome_geometry(arguments, &reference)? {
        Some(dome) => LocatedLayout::on_dome(&located, dome)?,
        None => LocatedLayout::new(&located),
    };
    let text = layout.to_toml()?;
    // Check that the output is valid.
    LocatedLayout::from_toml(&text)?;
    layout_file.finish(text.as_bytes())?;
    if let Some(file) = preview_file {
        let mut png = std::io::Cursor::new(Vec::new());
        preview(&reference, &layout).write_to(&mut png, image::ImageFormat::Png)?;
        file.finish(png.get_ref())?;
    }
    let rings = layout.elements.iter().filter_map(|e| e.ring).max();
    // Only the layout is sorted by rings; warnings must refer to its indices.
    let warnings = in_layout_order(&located, &layout);
    let found = Found {
        layout: &arguments.output,
        preview: arguments.preview.as_deref(),
        elements: located.elements.len(),
        polarity: located.polarity.to_string(),
        spots_per_element: located.spots_per_element,
        spot_diameter_px: located.spot_diameter_px,
        spacing_px: located.spacing_px,
        width_px: layout.width,
        height_px: layout.height,
        ground: layout.dark_level,
        rings: rings.map(|last| last + 1),
        warnings: warnings.iter().map(ToString::to_string).collect(),
    };
    match arguments.json.json {
        true => print_json(&found, out)?,
        false => say(&found, located.polarity, out)?,
    }
    Ok(Outcome::Done)
}

fn say(found: &Found<'_>, polarity: Polarity, out: &mut dyn Write) -> io::Result<()> {
    let spots = match found.spots_per_element {
        1 => format!("{polarity} spots"),
        count => format!("groups of {count} {polarity} spots"),
    };
    writeln!(
        out,
        "{} elements ({spots} of {:.1} px), {:.1} px apart, in {}x{} px; background {} gray level {}",
        found.elements,
        found.spot_diameter_px,
        found.spacing_px,
        found.width_px,
        found.height_px,
        if polarity.is_bright() {
            "up to"
        } else {
            "from"
        },
        found.ground,
    )?;
    if let Some(rings) = found.rings {
        writeln!(out, "{rings} rings on the dome")?;
    }
    for warning in &found.warnings {
        writeln!(out, "warning: {warning}")?;
    }
    writeln!(out, "{}", found.layout.display())
}

/// Returns the warnings with the element indices of the layout.
fn in_layout_order(located: &locate::Located, layout: &LocatedLayout) -> Vec<LocateWarning> {
    let index = |element: usize| {
        let centre = located.elements[element].centre_px;
        let distance = |i: &usize| layout.elements[*i].centre_px.distance_squared(centre);
        let all = 0..layout.elements.len();
        all.min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(element)
    };
    let mut warnings = located.warnings.clone();
    for warning in &mut warnings {
        match warning {
            LocateWarning::Merged { element, .. } | LocateWarning::Incomplete { element, .. } => {
                *element = index(*element);
            }
            LocateWarning::Saturated { elements } | LocateWarning::CutOff { elements } => {
                elements
                    .iter_mut()
                    .for_each(|element| *element = index(*element));
                elements.sort_unstable();
            }
            LocateWarning::TwoLevels
            | LocateWarning::LeftOut { .. }
            | LocateWarning::AtBorder { .. }
            | LocateWarning::IrregularPattern { .. } => {}
        }
    }
    warnings
}

/// Computes the mean of the images in `files`.
fn mean_of_files(files: &[PathBuf]) -> Result<ReferencePicture, CommandError> {
    let mut mean = MeanPicture::default();
    let progress = Steps::new(files.len());
    for file in files {
        let picture = named_picture(file)?;
        mean.add(&picture)
            .map_err(|e| format!("{}: {e}", file.display()))?;
        progress.advance();
    }
    Ok(mean.finish()?)
}

/// Returns the dome described by the arguments, if any.
fn dome_geometry(
    arguments: &Arguments,
    reference: &ReferencePicture,
) -> Result<Option<DomeGeometry>, CommandError> {
    if let Some(experiment) = &arguments.dome {
        let fingertip = Experiment::load(experiment, &[])?.config.sensor.fingertip;
        return Ok(Some(DomeGeometry {
            radius: fingertip.layout.dome_radius,
            camera: fingertip.camera,
        }));
    }
    let given = arguments
        .dome_radius
        .zip(arguments.focal_length_px)
        .zip(arguments.standoff);
    let Some(((radius, focal_length_px), standoff)) = given else {
        return Ok(None);
    };
    let centre_px = match arguments.axis_px[..] {
        [] => None,
        [column, row] => Some([column, row]),
        _ => return Err("--axis-px: expected column and row, e.g. 319.5,239.5".into()),
    };
    Ok(Some(DomeGeometry {
        radius,
        camera: CameraConfig {
            width: reference.width,
            height: reference.height,
            focal_length_px,
            standoff,
            centre_px,
            radial_distortion: [0.0, 0.0],
        },
    }))
}
