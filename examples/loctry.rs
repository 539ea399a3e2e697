use feeler::sensor::{frame::Picture, locate::*};
fn main() {
    let cfg = LocateConfig::default();
    let a: Vec<String> = std::env::args().skip(1).collect();
    let pics: Vec<Picture> = a
        .iter()
        .map(|p| {
            let i = image::open(p).unwrap().to_luma8();
            Picture {
                width: i.width() as usize,
                height: i.height() as usize,
                pixels: i.into_raw(),
            }
        })
        .collect();
    let r = ReferencePicture::mean(&pics).unwrap();
    let t = std::time::Instant::now();
    match locate(&r, &cfg) {
        Err(e) => println!("{e}"),
        Ok(l) => {
            println!(
                "{} elements spacing {} diam {} per {} dark {} in {:?}",
                l.elements.len(),
                l.spacing_px,
                l.spot_diameter_px,
                l.spots_per_element,
                l.dark_level,
                t.elapsed()
            );
            for w in &l.warnings {
                println!("  {w}");
            }
            let s = (1000 / r.width.max(1)).max(1) as u32;
            let mut im =
                image::RgbImage::from_fn(r.width as u32 * s, r.height as u32 * s, |x, y| {
                    let g = r.gray[(y / s) as usize * r.width + (x / s) as usize] as u8;
                    image::Rgb([g, g, g])
                });
            for e in &l.elements {
                for p in e.spots_px.iter() {
                    let x = ((p.x + 0.5) * s as f64) as i64;
                    let y = ((p.y + 0.5) * s as f64) as i64;
                    for d in -4..=4 {
                        for (dx, dy) in [(d, 0), (0, d)] {
                            let (x, y) = (x + dx, y + dy);
                            if x >= 0 && y >= 0 && x < im.width() as i64 && y < im.height() as i64 {
                                im.put_pixel(x as u32, y as u32, image::Rgb([255, 0, 0]));
                            }
                        }
                    }
                }
                let p = e.centre_px;
                for k in 0..200 {
                    let t = k as f64 * 0.0314;
                    let x = (p.x + 0.5 + e.radius_px * t.cos()) * s as f64;
                    let y = (p.y + 0.5 + e.radius_px * t.sin()) * s as f64;
                    if x >= 0.0 && y >= 0.0 && x < im.width() as f64 && y < im.height() as f64 {
                        im.put_pixel(x as u32, y as u32, image::Rgb([0, 200, 0]));
                    }
                }
            }
            im.save("/tmp/loc/out.png").unwrap();
        }
    }
}
