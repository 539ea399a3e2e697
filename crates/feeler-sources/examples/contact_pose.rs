//! Estimates depth and tilt of a contact from images of a real hemispherical sensor. Locates the sensor's pins,
//! computes their moments like `feeler sense`, and fits a ridge regression from the moments to the pose.
//!
//! ```text
//! cargo run --release --example contact_pose -- [FOLDER]
//! ```
//!
//! FOLDER contains `targets.csv` and `images/` (see `DataSet`). The default is `$FEELER_DATA/tactip-surface3d-tap`,
//! where `FEELER_DATA` defaults to `../shared/data`. Relative paths start at the repository.

use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::forces::{ElementReading, SensingChain};
use feeler::sensor::image::{DEFAULT_MAX_SATURATED, Picture};
use feeler::sensor::locate::{LocateConfig, ReferencePicture, locate};
use feeler_sources::read_picture;
use nalgebra::{Cholesky, DMatrix, DVector, RowDVector};
use std::{error::Error, fs, path::Path, path::PathBuf};

/// Number of images for fitting the regression, out of `pictures`: the first 70 %. The rest is predicted.
pub fn fitted(pictures: usize) -> usize {
    pictures * 7 / 10
}

/// Minimum number of images for a meaningful result.
const FEWEST: usize = 100;

/// Depth of the tap, mm, and its tilts about two axes, degrees.
pub const TARGETS: [&str; 3] = ["pose_3", "pose_4", "pose_5"];

/// Number of cross-validation folds of the fitted images, to choose the ridge and the sub-regions.
const FOLDS: usize = 10;

/// Radii of the sub-regions to try, relative to the pins' spacing.
const REGION_RADII: [f64; 6] = [0.35, 0.4, 0.45, 0.5, 0.6, 0.8];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os()
        .nth(1)
        .map_or_else(data_folder, PathBuf::from);
    if !folder.join("targets.csv").exists() {
        println!(
            "SKIPPED: {} does not exist",
            folder.join("targets.csv").display()
        );
        return Ok(());
    }
    let found = contact_pose(&DataSet::read(&folder, &TARGETS)?)?;
    println!("{} pins, {:.2} px apart", found.pins, found.spacing_px);
    for (told, name) in found.told.iter().zip(TARGETS) {
        println!(
            "{name}: mean absolute error {:.4} (cross-validated {:.4}: ridge {:.1}, sub-regions of {} spacings)",
            told.error, told.cross_validated, told.ridge, told.region_radius
        );
    }
    Ok(())
}

/// Folder of the default data set.
pub fn data_folder() -> PathBuf {
    data_folder_of("tactip-surface3d-tap")
}

/// Folder of the data set `name`.
pub fn data_folder_of(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = std::env::var_os("FEELER_DATA").unwrap_or("../shared/data".into());
    root.join(data).join(name)
}

/// Images and the pose of the contact in each.
pub struct DataSet {
    pub pictures: Vec<Picture>,
    /// One row per image, one column per target.
    pub poses: DMatrix<f64>,
}

impl DataSet {
    /// Reads the `targets` in `targets.csv`, and the images in `images/` named in its column `sensor_image`.
    pub fn read(folder: &Path, targets: &[&str]) -> Result<Self, Box<dyn Error>> {
        let text = fs::read_to_string(folder.join("targets.csv"))?;
        let mut lines = text.lines();
        let header = fields(lines.next().ok_or("targets.csv is empty")?);
        let column = |name: &str| {
            let found = header.iter().position(|field| field == name);
            found.ok_or(format!("targets.csv: no column {name}"))
        };
        let image_column = column("sensor_image")?;
        let pose_columns = targets
            .iter()
            .map(|target| column(target))
            .collect::<Result<Vec<_>, _>>()?;
        let (mut pictures, mut poses) = (Vec::new(), Vec::new());
        for line in lines {
            let row = fields(line);
            let field = |column: usize| row.get(column).ok_or("targets.csv: a row is too short");
            pictures.push(read_picture(
                &folder.join("images").join(field(image_column)?),
            )?);
            for &column in &pose_columns {
                poses.push(field(column)?.parse::<f64>()?);
            }
        }
        let poses = DMatrix::from_row_slice(pictures.len(), targets.len(), &poses);
        Ok(Self { pictures, poses })
    }
}

/// Splits a row into fields. Commas in quotes do not separate.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.iter_mut().last().into_iter().for_each(|f| f.push(c)),
        }
    }
    fields
}

/// Result of estimating one target, with parameters chosen by cross-validation on the fitted images.
#[derive(Debug, Clone, Copy)]
pub struct Told {
    /// Radius of the sub-regions relative to the pins' spacing.
    pub region_radius: f64,
    /// Ridge parameter.
    pub ridge: f64,
    /// Cross-validated mean absolute error on the fitted images, mm or degrees.
    pub cross_validated: f64,
    /// Mean absolute error on the predicted images, mm or degrees.
    pub error: f64,
}

/// Result of the example.
pub struct ContactPose {
    /// Number of pins found.
    pub pins: usize,
    /// Spacing of the pins, px.
    pub spacing_px: f64,
    /// Result for each of [`TARGETS`].
    pub told: [Told; 3],
}

/// Locates the pins in the mean of the [`fitted`] images, fits on these, and predicts the rest.
pub fn contact_pose(data: &DataSet) -> Result<ContactPose, Box<dyn Error>> {
    let pictures = data.pictures.len();
    if pictures < FEWEST {
        return Err(format!("expected at least {FEWEST} images, got {pictures}").into());
    }
    let reference = ReferencePicture::mean(&data.pictures[..fitted(pictures)])?;
    let nothing = Told {
        region_radius: f64::NAN,
        ridge: f64::NAN,
        cross_validated: f64::INFINITY,
        error: f64::INFINITY,
    };
    let mut pose = ContactPose {
        pins: 0,
        spacing_px: 0.0,
        told: [nothing; 3],
    };
    for region_radius in REGION_RADII {
        let config = LocateConfig {
            region_radius,
            ..LocateConfig::default()
        };
        let located = locate(&reference, &config)?;
        (pose.pins, pose.spacing_px) = (located.elements.len(), located.spacing_px);
        let layout = LocatedLayout::new(&located);
        let sensing = SensingChain::new(
            (data.pictures[0].width, data.pictures[0].height),
            layout.kernel()?,
            &layout.weighted_pixels()?,
            DEFAULT_MAX_SATURATED,
        )?;
        let features = features(sensing, &data.pictures)?;
        for (target, told) in pose.told.iter_mut().enumerate() {
            let new = tell(&features, data.poses.column(target).into(), region_radius)?;
            if new.cross_validated < told.cross_validated {
                *told = new;
            }
        }
    }
    Ok(pose)
}

/// Fits one target on the [`fitted`] rows and predicts the rest.
fn tell(
    features: &DMatrix<f64>,
    target: DVector<f64>,
    region_radius: f64,
) -> Result<Told, Box<dyn Error>> {
    let first = fitted(features.nrows());
    let kept = features.nrows() - first;
    let learned = features.rows(0, first).into_owned();
    let known = target.rows(0, first).into_owned();
    let (ridge, cross_validated) = choose_ridge(&learned, &known);
    let rest = features.rows(first, kept).into_owned();
    let predicted = Ridge::fit(&learned, &known, ridge)?.predict(&rest);
    Ok(Told {
        region_radius,
        ridge,
        cross_validated,
        error: mean_absolute(&predicted, &target.rows(first, kept).into_owned()),
    })
}

/// One row per image and three columns per pin: its integrated gray value relative to the mean, and the displacement
/// of its centroid, px. The displacement of a pin that is not visible is 0.
fn features(
    mut sensing: SensingChain,
    pictures: &[Picture],
) -> Result<DMatrix<f64>, Box<dyn Error>> {
    let pins = sensing.element_count();
    let mut readings = vec![ElementReading::default(); pins];
    let mut features = DMatrix::zeros(pictures.len(), 3 * pins);
    let mut seen = DMatrix::from_element(pictures.len(), pins, true);
    for (row, picture) in pictures.iter().enumerate() {
        sensing.sense(picture, &mut readings)?;
        for (pin, reading) in readings.iter().enumerate() {
            let centroid = reading.centroid.unwrap_or_default();
            seen[(row, pin)] = reading.centroid.is_some();
            features[(row, 3 * pin)] = reading.integrated_gray;
            features[(row, 3 * pin + 1)] = centroid.x;
            features[(row, 3 * pin + 2)] = centroid.y;
        }
    }
    for pin in 0..pins {
        let learned = 0..fitted(pictures.len());
        let rows: Vec<usize> = learned.filter(|&row| seen[(row, pin)]).collect();
        let mean = |column: usize| {
            rows.iter().map(|&row| features[(row, column)]).sum::<f64>() / rows.len().max(1) as f64
        };
        let gray = mean(3 * pin);
        let centroid = [mean(3 * pin + 1), mean(3 * pin + 2)];
        for row in 0..pictures.len() {
            if gray > 0.0 {
                features[(row, 3 * pin)] /= gray;
            }
            for (axis, mean) in centroid.into_iter().enumerate() {
                let u = &mut features[(row, 3 * pin + 1 + axis)];
                *u = if seen[(row, pin)] { *u - mean } else { 0.0 };
            }
        }
    }
    Ok(features)
}

/// Ridge regression: a linear map whose squared coefficients are penalized.
struct Ridge {
    means: RowDVector<f64>,
    offset: f64,
    coefficients: DVector<f64>,
}

impl Ridge {
    fn fit(x: &DMatrix<f64>, y: &DVector<f64>, ridge: f64) -> Result<Self, Box<dyn Error>> {
        let means = x.row_mean();
        let centred = centred(x, &means);
        let offset = y.mean();
        // There are more features than images, so the dual form is smaller.
        let gram = &centred * centred.transpose();
        let dual = solve(&gram, ridge, &y.add_scalar(-offset)).ok_or("the ridge is too small")?;
        Ok(Self {
            coefficients: centred.transpose() * dual,
            means,
            offset,
        })
    }

    fn predict(&self, x: &DMatrix<f64>) -> DVector<f64> {
        (centred(x, &self.means) * &self.coefficients).add_scalar(self.offset)
    }
}

pub fn centred(x: &DMatrix<f64>, means: &RowDVector<f64>) -> DMatrix<f64> {
    let mut centred = x.clone();
    centred.row_iter_mut().for_each(|mut row| row -= means);
    centred
}

fn solve(gram: &DMatrix<f64>, ridge: f64, y: &DVector<f64>) -> Option<DVector<f64>> {
    let mut gram = gram.clone();
    for i in 0..gram.nrows() {
        gram[(i, i)] += ridge;
    }
    Some(Cholesky::new(gram)?.solve(y))
}

/// Ridge parameter with the smallest cross-validated mean absolute error, and that error.
fn choose_ridge(x: &DMatrix<f64>, y: &DVector<f64>) -> (f64, f64) {
    let gram = {
        let centred = centred(x, &x.row_mean());
        &centred * centred.transpose()
    };
    let cross_validated = |exponent: i32| {
        let ridge = 10_f64.powf(f64::from(exponent) / 4.0);
        let sum: f64 = (0..FOLDS)
            .map(|fold| fold_error(&gram, y, fold, ridge))
            .sum();
        (ridge, sum / FOLDS as f64)
    };
    let tried = (0..=12).map(cross_validated);
    tried.fold((1.0, f64::INFINITY), |best, new| {
        if new.1 < best.1 { new } else { best }
    })
}

/// Mean absolute error on one fold after fitting the others, from the Gram matrix of all samples.
pub fn fold_error(gram: &DMatrix<f64>, y: &DVector<f64>, fold: usize, ridge: f64) -> f64 {
    let (out, kept): (Vec<usize>, Vec<usize>) = (0..y.len()).partition(|i| i % FOLDS == fold);
    let own = gram.select_rows(&kept).select_columns(&kept);
    let across = gram.select_rows(&out).select_columns(&kept);
    let (fitted, truth) = (y.select_rows(&kept), y.select_rows(&out));
    let offset = fitted.mean();
    let dual = solve(&own, ridge, &fitted.add_scalar(-offset));
    dual.map_or(f64::INFINITY, |dual| {
        mean_absolute(&(across * dual).add_scalar(offset), &truth)
    })
}

fn mean_absolute(a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    (a - b).abs().mean()
}
