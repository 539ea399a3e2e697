//! Page with the comparison.

use super::measure::{Look, STRETCH};
use base64::Engine;
use feeler::sensor::image::Picture;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::render::{layout::Layout, plots::Plot, render::render_multiple};
use std::error::Error;

/// A line of the table: name, unit, and the function that extracts the value.
type Line = (&'static str, &'static str, fn(&Look) -> Option<f64>);

const LINES: [Line; 10] = [
    ("markers", "", |look| Some(look.markers as f64)),
    ("diameter of a marker", "px", |look| {
        Some(look.spot_diameter)
    }),
    ("distance of neighbours", "px", |look| Some(look.spacing)),
    ("diameter over distance", "", |look| {
        Some(look.spot_diameter / look.spacing)
    }),
    ("contrast to the background", "grey levels", |look| {
        Some(look.contrast)
    }),
    (
        "interquartile range of contrasts",
        "of the median",
        |look| Some(look.spread_of_contrasts),
    ),
    ("noise of the background", "grey levels", |look| {
        Some(look.noise)
    }),
    (
        "fraction of the noise power in the upper half of the spectrum",
        "",
        |look| {
            let upper = look.spectrum.get(STRETCH / 4..)?;
            Some(upper.iter().sum())
        },
    ),
    ("change of brightness by compression", "1/N", |look| {
        look.growth_per_newton
    }),
    ("displacement by shear", "distances/N", |look| {
        look.displacement_per_newton
    }),
];

pub fn print(experiment: &str, simulated: &Look, real: &Look) {
    println!("{experiment:<48}{:>12}{:>12}", "simulated", "real");
    println!(
        "{:<48}{:>12}{:>12}",
        "polarity",
        simulated.polarity.to_string(),
        real.polarity.to_string()
    );
    for (what, unit, of) in LINES {
        println!(
            "{:<48}{:>12}{:>12}",
            format!("{what} {unit}"),
            text(of(simulated)),
            text(of(real))
        );
    }
}

fn text(value: Option<f64>) -> String {
    feeler_report::pages::value(value)
}

pub fn page(pairs: &[(String, Look, Look)]) -> Result<String, Box<dyn Error>> {
    let mut body = String::new();
    for (experiment, simulated, real) in pairs {
        body += &format!("<h2>{experiment}</h2><div class=pair>");
        for (name, look) in [("simulated", simulated), ("real", real)] {
            body += &format!(
                "<figure><img alt='{name}' src='{}'><figcaption>{name}</figcaption></figure>",
                address(&look.picture)?
            );
        }
        body += "</div><table><tr><th><th>simulated<th>real";
        for (what, unit, of) in LINES {
            body += &format!(
                "<tr><td>{what} <small>{unit}</small><td>{}<td>{}",
                text(of(simulated)),
                text(of(real))
            );
        }
        body += &format!("</table>{}", spectra(simulated, real));
    }
    Ok(format!(
        "<!doctype html><meta charset=utf-8><title>Simulated and real fingertips</title><style>body{{font:16px/1.4 sans-serif;max-width:60rem;\
         margin:2rem auto;padding:0 1rem}}.pair{{display:grid;grid-template-columns:1fr 1fr;gap:1rem}}figure{{margin:0}}img{{width:100%}}\
         td,th{{padding:.2rem 1rem .2rem 0;text-align:left}}svg{{max-width:30rem}}</style><h1>Simulated and real fingertips</h1>{body}"
    ))
}

/// Encodes the image as a data URL.
fn address(picture: &Picture) -> Result<String, Box<dyn Error>> {
    let mut png = Vec::new();
    let (width, height) = (picture.width as u32, picture.height as u32);
    PngEncoder::new(&mut png).write_image(&picture.pixels, width, height, ExtendedColorType::L8)?;
    Ok(format!(
        "data:image/png;base64,{}",
        base64::engine::general_purpose::STANDARD.encode(png)
    ))
}

/// Plots the power of the background noise over frequency for both images.
fn spectra(simulated: &Look, real: &Look) -> String {
    let looks = [
        ("simulated", "#1f77b4", simulated),
        ("real", "#d62728", real),
    ];
    let plots: Vec<Plot> = looks
        .into_iter()
        .filter(|(_, _, look)| !look.spectrum.is_empty())
        .map(|(name, colour, look)| {
            let points = look.spectrum.iter().enumerate();
            let points = points.map(|(k, share)| ((k + 1) as f64 / STRETCH as f64, *share));
            let points: Vec<(f64, f64)> = points.collect();
            Plot::Line(
                LinePlot::new()
                    .with_data(points)
                    .with_color(colour)
                    .with_legend(name),
            )
        })
        .collect();
    let layout = Layout::auto_from_plots(&plots)
        .with_x_label("Frequency (1/px)")
        .with_y_label("Share of the noise's power");
    SvgBackend.render_scene(&render_multiple(plots, layout))
}
