//! Public recordings of taxel arrays, if they are available.

use crate::program::{folder, rows, run};
use crate::recordings::recordings;
use flate2::read::GzDecoder;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::copy;
use std::path::{Path, PathBuf};

/// Number of rows over which the shear rate is computed: 0.1 s at the rate of the layout. From row to row, the rate is
/// that of the noise, 12 counts, and of the first touch, which do not indicate slip.
const RATE_ROWS: usize = 10;

/// Collects all tables below `folder` whose names are `wanted`.
fn tables(folder: &Path, wanted: &dyn Fn(&str) -> bool, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            tables(&path, wanted, found);
        } else if wanted(&path.file_name().unwrap().to_string_lossy()) {
            found.push(path);
        }
    }
}

#[test]
fn uskin_grasps_are_read_completely() {
    let name = "uskin_grasps_are_read_completely";
    let Some(data) = recordings("uskin-grasps", name) else {
        return;
    };
    let folder = folder("uskin-grasps");
    let mut found = Vec::new();
    tables(&data, &|name| name.starts_with("xela_sensor"), &mut found);
    assert!(
        !found.is_empty(),
        "no xela_sensor*.csv in {}",
        data.display()
    );
    for table in found {
        let lines = fs::read_to_string(&table).unwrap().lines().count();
        let path = table.to_str().unwrap();
        let ended = run(
            &folder,
            &[
                "sense",
                path,
                "--taxels",
                "uskin-4x4",
                "-o",
                "out.csv",
                "--force",
            ],
        );
        assert_eq!(ended.status, Some(0), "{ended:?}");
        assert!(
            ended
                .stderr
                .contains(&format!("{} frames sensed", lines - 1)),
            "{ended:?}"
        );
        assert!(ended.stderr.contains("; 0 skipped"), "{ended:?}");
        let forces = rows(&folder.join("out.csv"));
        assert_eq!(forces.len(), 16 * (lines - 1));
        assert!(
            forces
                .iter()
                .all(|row| row.values().all(|cell| !cell.is_empty()))
        );
    }
}

/// Shear (x, y) of each taxel in a frame.
type Shears = Vec<[f64; 2]>;
/// Frames of each sequence.
type Sequences = BTreeMap<String, Vec<Shears>>;

fn sequences(table: &Path) -> Sequences {
    let mut sequences = Sequences::new();
    for row in rows(table) {
        let number = |column: &str| row[column].parse::<f64>().expect("a number");
        let frames = sequences.entry(row["sequence"].clone()).or_default();
        if row["element"] == "0" {
            frames.push(Vec::new());
        }
        let shear = [number("f_x_counts"), number("f_y_counts")];
        frames.last_mut().expect("element 0 first").push(shear);
    }
    sequences
}

/// Largest change of any taxel's shear between frames that are `lag` apart.
fn largest_change(frames: &[Shears], lag: usize) -> f64 {
    let pairs = frames.iter().zip(frames.iter().skip(lag));
    let taxels = pairs.flat_map(|(before, now)| before.iter().zip(now));
    let changes = taxels.map(|(before, now)| (now[0] - before[0]).hypot(now[1] - before[1]));
    changes.fold(0.0, f64::max)
}

fn largest_shear(frames: &[Shears]) -> f64 {
    let shears = frames.iter().flatten().map(|[x, y]| x.hypot(*y));
    shears.fold(0.0, f64::max)
}

/// Area under the ROC curve of scores, each with its label (`true` for slip).
fn area(scores: &[(f64, bool)]) -> f64 {
    let of = |slip: bool| scores.iter().filter(move |s| s.1 == slip).map(|s| s.0);
    let wins = of(true).flat_map(|slip| {
        of(false).map(move |other| f64::from(slip > other) + 0.5 * f64::from(slip == other))
    });
    wins.sum::<f64>() / (of(true).count() * of(false).count()) as f64
}

/// Standard error of an AUC of `area` over `slips` positives and `others` negatives (Hanley and McNeil 1982).
fn standard_error(area: f64, slips: f64, others: f64) -> f64 {
    let square = area * area;
    let (q1, q2) = (area / (2.0 - area), 2.0 * square / (1.0 + area));
    let pairs = (slips - 1.0) * (q1 - square) + (others - 1.0) * (q2 - square);
    ((area * (1.0 - area) + pairs) / (slips * others)).sqrt()
}

/// Results of simple rules in the README of the data: the largest shear of a sequence detects slip with an AUC of
/// 0.970, the largest shear rate with 0.78. Both must be reproduced within three standard errors.
#[test]
fn eflesh_sequences_reproduce_known_slip_scores() {
    let name = "eflesh_sequences_reproduce_known_slip_scores";
    let Some(data) = recordings("eflesh-slip", name) else {
        return;
    };
    let folder = folder("eflesh-slip");
    let mut whole = File::create(folder.join("sequences.csv")).unwrap();
    let mut packed = GzDecoder::new(File::open(data.join("sequences.csv.gz")).unwrap());
    copy(&mut packed, &mut whole).unwrap();
    let labels = rows(&data.join("LABELS.csv"));
    let slips: BTreeMap<_, _> = labels
        .iter()
        .map(|l| (l["sequence"].clone(), l["slip"] == "1"))
        .collect();
    for prefix in ["left", "right"] {
        let arguments = [
            "sense",
            "sequences.csv",
            "--taxels",
            "eflesh",
            "--prefix",
            prefix,
        ];
        let more = ["--sequence", "sequence", "-o", "out.csv", "--force"];
        let ended = run(&folder, &[&arguments[..], &more].concat());
        assert_eq!(ended.status, Some(0), "{ended:?}");
        assert!(ended.stderr.contains("; 0 skipped"), "{ended:?}");
        let sensed = sequences(&folder.join("out.csv"));
        assert!(
            sensed.keys().eq(slips.keys()),
            "sequences and labels differ"
        );
        let scored = |score: &dyn Fn(&[Shears]) -> f64| {
            let scores = sensed
                .iter()
                .map(|(name, frames)| (score(frames), slips[name]));
            area(&scores.collect::<Vec<_>>())
        };
        let shear = scored(&largest_shear);
        let rate = scored(&|frames| largest_change(frames, RATE_ROWS));
        let step = scored(&|frames| largest_change(frames, 1));
        println!(
            "{prefix}: shear {shear:.3?}, rate over {RATE_ROWS} rows {rate:.3?}, from row to row {step:.3?}"
        );
        let slipped = slips.values().filter(|&&slip| slip).count();
        let counts = (slipped as f64, (slips.len() - slipped) as f64);
        for (found, known) in [(shear, 0.970), (rate, 0.78)] {
            let error = standard_error(known, counts.0, counts.1);
            let off = (found - known).abs();
            assert!(
                off <= 3.0 * error,
                "{prefix}: {found} +- {error}, expected {known}"
            );
        }
    }
}
