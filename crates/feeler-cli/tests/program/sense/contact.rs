//! `feeler sense --contact`.

use super::rendered::{CALIBRATION, fingertip, pictures, pressed, save};
use crate::program::{folder, run, whole_run};
use feeler::sensor::contact::ContactEstimator;
use feeler_record::Contact;
use feeler_record::wire::{Message, cdr};
use glam::DVec3;
use std::collections::HashMap;
use std::fs;

const GRID: &str = "\
version = 1
name = 'four pillars'
unit = 'N'
rate = 100.0
columns = { x = 'p{n}_x', y = 'p{n}_y', z = 'p{n}_z' }
taxel = [{ place = [0, -0.002, -0.002] }, { place = [0, 0.002, -0.002] }, { place = [0, -0.002, 0.002] }, { place = [0, 0.002, 0.002] }]
";
/// Untouched; pressed evenly; pressed at one side and sheared along y; without two pillars.
const TABLE: &str = "\
p0_x,p0_y,p0_z,p1_x,p1_y,p1_z,p2_x,p2_y,p2_z,p3_x,p3_y,p3_z
0,0,0,0,0,0,0,0,0,0,0,0
0,0,1,0,0,1,0,0,1,0,0,1
0,0,1,0.8,0,2,0,0,1,0.8,0,2
,,,0.8,0,2,,,,0.8,0,2
";

/// Rows of a comma-separated table as numbers by column; empty cells are left out.
fn rows(text: &str) -> Vec<HashMap<String, f64>> {
    let mut lines = text
        .lines()
        .map(|line| line.split(',').map(str::to_string).collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let row = |cells: Vec<String>| {
        assert_eq!(cells.len(), header.len());
        let cells = header.iter().cloned().zip(cells);
        cells
            .filter(|(_, cell)| !cell.is_empty())
            .map(|(name, cell)| (name, cell.parse().unwrap()))
            .collect()
    };
    lines.map(row).collect()
}

fn vector(row: &HashMap<String, f64>, name: &str) -> DVec3 {
    DVec3::from_array(["x", "y", "z"].map(|axis| row[&format!("{name}_{axis}")]))
}

#[test]
fn contacts_of_taxels_are_written_in_every_format() {
    let folder = folder("contact-taxels");
    fs::write(folder.join("grid.toml"), GRID).unwrap();
    fs::write(folder.join("forces.csv"), TABLE).unwrap();
    let sense = |more: &[&str]| {
        run(
            &folder,
            &[
                &["sense", "forces.csv", "--taxels=grid.toml", "--contact"],
                more,
            ]
            .concat(),
        )
    };
    let said = sense(&["--friction=0.5"]);
    assert_eq!(said.status, Some(0), "{said:?}");
    let table = rows(&said.stdout);
    let touching: Vec<_> = table.iter().map(|row| row["touching"]).collect();
    assert_eq!(touching, [0.0, 4.0, 4.0, 2.0]);
    assert!(!table[0].contains_key("c_x"));
    assert_eq!(vector(&table[1], "c"), DVec3::ZERO);
    assert_eq!(
        (vector(&table[1], "n"), table[1]["sliding"]),
        (DVec3::X, 0.0)
    );
    // Weights 1 and 2 at -2 and 2 mm.
    assert!((table[2]["c_y"] - 0.002 / 3.0).abs() < 1e-12);
    assert!((vector(&table[2], "f") - DVec3::new(-6.0, 1.6, 0.0)).length() < 1e-12);
    // 0.8 N of 2 N is below the friction.
    assert_eq!((table[2]["sliding"], table[2]["friction"]), (0.0, 0.5));
    assert_eq!(table[3]["invalid"], 2.0);

    assert_eq!(
        sense(&["--friction=0.4", "-o=slides.jsonl"]).status,
        Some(0)
    );
    let slides = fs::read_to_string(folder.join("slides.jsonl")).unwrap();
    let row: serde_json::Value = serde_json::from_str(slides.lines().nth(2).unwrap()).unwrap();
    assert_eq!(row["sliding"], 0.5);
    assert_eq!(row["touching"], 4);

    assert_eq!(sense(&["-o=contacts.mcap"]).status, Some(0));
    let bytes = fs::read(folder.join("contacts.mcap")).unwrap();
    let messages = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    let contacts = messages.filter(|message| message.channel.topic == "/contact");
    let contacts: Vec<Contact> = contacts
        .inspect(|message| {
            assert_eq!(
                message.channel.schema.as_ref().unwrap().name,
                Contact::SCHEMA_NAME
            )
        })
        .map(|message| cdr::decode(&message.data).unwrap())
        .collect();
    assert_eq!(contacts.len(), 4);
    assert!(contacts[0].centre.x.is_nan() && contacts[0].touching == 0);
    assert_eq!(contacts[2].centre.y, table[2]["c_y"]);
}

#[test]
fn contacts_of_images_have_the_centre_of_the_loads() {
    let folder = folder("contact-images");
    let pictures = pressed(6);
    save(&pictures, &folder.join("loads"));
    // Three standard errors: shear has a hysteresis of 0.2 N when loads change at random.
    let sense = [
        "sense",
        "loads",
        "--calibration",
        CALIBRATION,
        "--contact=0.6",
    ];
    let said = run(&folder, &sense);
    assert_eq!(said.status, Some(0), "{said:?}");
    let layout = fingertip().layout;
    let table = rows(&said.stdout);
    assert_eq!(table.len(), pictures.len());
    for (row, picture) in table.iter().zip(&pictures) {
        let mut known = ContactEstimator::new(layout.places(), 0.6);
        let Some(known) = known.estimate(&picture.forces) else {
            assert_eq!(row["touching"], 0.0);
            continue;
        };
        // Two standard errors.
        let off = (vector(row, "c") - known.centre).length();
        assert!(off < 2.0 * row["c_error"], "{off} {}", row["c_error"]);
        let off = (vector(row, "f") - known.force).abs().max_element();
        assert!(off < 2.0 * row["f_error"], "{off} {}", row["f_error"]);
    }
}

#[test]
fn contacts_of_a_recorded_run_follow_its_flags() {
    let folder = folder("contact-run");
    let recording = whole_run(&folder);
    let path = recording.to_str().unwrap();
    let said = run(&folder, &["sense", path, "--contact=0.1"]);
    assert_eq!(said.status, Some(0), "{said:?}");
    let table = rows(&said.stdout);
    let touched = table.iter().filter(|row| row["touching"] > 0.0).count();
    assert!(touched > table.len() / 10, "{touched} of {}", table.len());
    // Friction of the simulated cap, estimated while the grip begins to slide.
    let last = table.iter().rev().find_map(|row| row.get("friction"));
    assert!(
        last.is_none_or(|friction| (0.2..2.0).contains(friction)),
        "{last:?}"
    );
}

#[test]
fn impossible_contacts_are_refused() {
    let folder = folder("contact-refused");
    fs::write(folder.join("grid.toml"), GRID.replace("'N'", "'counts'")).unwrap();
    fs::write(folder.join("forces.csv"), TABLE).unwrap();
    save(&pictures(2), &folder.join("loads"));
    let taxels = ["sense", "forces.csv", "--taxels=grid.toml"];
    let refused = |arguments: &[&str], words: &[&str]| {
        run(&folder, arguments).refused(words);
    };
    refused(
        &[&taxels[..], &["--contact"]].concat(),
        &["--contact=COUNTS", "counts"],
    );
    refused(
        &[&taxels[..], &["--contact=0"]].concat(),
        &["greater than 0, got 0"],
    );
    refused(
        &[&taxels[..], &["--contact=nan"]].concat(),
        &["greater than 0, got nan"],
    );
    refused(&[&taxels[..], &["--friction=1"]].concat(), &["--contact"]);
    refused(
        &["sense", "loads", "--contact"],
        &["--contact: requires --calibration"],
    );
    refused(
        &["sense", "loads", "--contact", "--track", "--layout=l.toml"],
        &["--track", "--contact"],
    );
}
