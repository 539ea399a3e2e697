//! `feeler sense TABLE --taxels LAYOUT`.

use crate::program::{Ended, feeler, folder, run};
use feeler::sensor::taxel::BUILT_IN_TAXELS;
use feeler_record::Tactile;
use feeler_record::wire::{Message, cdr};
use flate2::Compression;
use flate2::write::GzEncoder;
use glam::DVec3;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::Stdio;

/// Two pillars, in newtons.
const PILLARS: &str = "\
version = 1
name = 'two pillars'
unit = 'N'
rate = 100.0
columns = { x = 'p{n}_x', y = 'p{n}_y', z = 'p{n}_z' }
taxel = [{ place = [0.0, -0.004, 0.0] }, { place = [0.0, 0.004, 0.0] }]
";
const TABLE: &str =
    "p0_x,p0_y,p0_z,p1_x,p1_y,p1_z\n0,0,0,0,0,0\n0.5,-0.25,1.5,,0,2\n0.5,-0.25,1.5,0,0,2\n";
/// Expected output for [`TABLE`].
const WRITTEN: &str = "\
frame,stamp,element,f_x,f_y,f_z
0,0.0,0,0.0,0.0,0.0
0,0.0,1,0.0,0.0,0.0
1,0.01,0,0.5,-0.25,1.5
1,0.01,1,,,
2,0.02,0,0.5,-0.25,1.5
2,0.02,1,0.0,0.0,2.0
";

fn prepare(name: &str, layout: &str) -> std::path::PathBuf {
    let folder = folder(name);
    fs::write(folder.join("pillars.toml"), layout).unwrap();
    fs::write(folder.join("forces.csv"), TABLE).unwrap();
    folder
}

fn sense(folder: &Path, more: &[&str]) -> Ended {
    let all = [&["sense", "forces.csv", "--taxels", "pillars.toml"], more].concat();
    run(folder, &all)
}

#[test]
fn tables_in_other_formats_are_sensed_alike() {
    let folder = prepare("taxels-of-others", PILLARS);
    let german = TABLE.replace(',', ";").replace('.', ",");
    let german = german
        .replacen("p0_x;p0_y;p0_z", "P0_X [N];\"p0 y\";p0-z", 1)
        .replace('\n', "\r\n");
    let wide = german.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [
        german.clone().into_bytes(),
        german.replace(';', "\t").into_bytes(),
        wide,
    ] {
        fs::write(folder.join("forces.csv"), bytes).unwrap();
        let ended = sense(&folder, &[]);
        assert_eq!(
            (ended.status, ended.stdout.as_str()),
            (Some(0), WRITTEN),
            "{ended:?}"
        );
    }
    fs::write(folder.join("forces.csv"), german.replace("[N]", "[mN]")).unwrap();
    sense(&folder, &[]).refused(&[
        "\"P0_X [mN]\" is in \"mN\"",
        "expected N, the unit in the layout",
    ]);
}

#[test]
fn compressed_table_is_read() {
    let folder = prepare("taxels-packed", PILLARS);
    let packed = fs::File::create(folder.join("forces.csv.gz")).unwrap();
    let mut packed = GzEncoder::new(packed, Compression::fast());
    packed.write_all(TABLE.as_bytes()).unwrap();
    packed.finish().unwrap();
    let arguments = ["sense", "forces.csv.gz", "--taxels", "pillars.toml"];
    let ended = run(&folder, &arguments);
    assert_eq!((ended.status, ended.stdout.as_str()), (Some(0), WRITTEN));
    // A truncated file is reported after its readable rows.
    let whole = fs::read(folder.join("forces.csv.gz")).unwrap();
    fs::write(folder.join("forces.csv.gz"), &whole[..whole.len() - 12]).unwrap();
    run(&folder, &arguments).refused(&["forces.csv.gz"]);
}

#[test]
fn all_outputs_contain_the_forces() {
    let folder = prepare("taxels-outputs", PILLARS);
    let shown = sense(&folder, &[]);
    assert_eq!((shown.status, shown.stdout.as_str()), (Some(0), WRITTEN));
    let words = "1 empty cell: no force there; line 3, column \"p1_x\"";
    assert!(shown.stderr.contains(words), "{shown:?}");
    assert!(shown.stderr.contains("3 frames sensed"), "{shown:?}");
    for name in ["out.csv", "out.jsonl", "out.mcap"] {
        let ended = sense(&folder, &["-o", name]);
        assert_eq!((ended.status, ended.stdout.as_str()), (Some(0), ""));
    }
    assert_eq!(fs::read_to_string(folder.join("out.csv")).unwrap(), WRITTEN);
    let lines = fs::read_to_string(folder.join("out.jsonl")).unwrap();
    let lines: Vec<Value> = lines
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    let second = r#"{"frame":1,"stamp":0.01,"element":0,"f_x":0.5,"f_y":-0.25,"f_z":1.5}"#;
    assert_eq!((lines.len(), lines[2].to_string()), (6, sorted(second)));
    assert_eq!(lines[3]["f_z"], Value::Null);
    let (tactile, topics, facts) = recorded(&folder.join("out.mcap"));
    assert_eq!(tactile[2].forces[1].z, 2.0);
    assert!(DVec3::from(tactile[1].forces[1]).is_nan());
    // The scene once; the cloud, limited to 30 Hz, for the first frame only; forces and their sum for every frame.
    let expected = [
        ("/finger/0/taxels", 1),
        ("/finger/0/wrench", 3),
        ("/scene", 1),
        ("/tactile", 3),
    ];
    assert_eq!(
        topics,
        BTreeMap::from(expected.map(|(t, n)| (t.to_string(), n)))
    );
    assert_eq!(
        (facts["unit"].as_str(), facts["name"].as_str()),
        ("N", "two pillars")
    );
    assert!(facts["layout"].contains("p{n}_x"));
}

/// Text of a JSON object with its keys in order, like that of `Value`.
fn sorted(text: &str) -> String {
    serde_json::from_str::<Value>(text).unwrap().to_string()
}

type Facts = BTreeMap<String, String>;

/// Tactile frames, number of messages per topic, and metadata of the taxels.
fn recorded(path: &Path) -> (Vec<Tactile>, BTreeMap<String, usize>, Facts) {
    let file = fs::read(path).unwrap();
    let (mut tactile, mut topics) = (Vec::new(), BTreeMap::new());
    for message in mcap::MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        *topics.entry(message.channel.topic.clone()).or_default() += 1;
        if message.channel.schema.as_ref().unwrap().name == Tactile::SCHEMA_NAME {
            tactile.push(cdr::decode(&message.data).unwrap());
        }
    }
    let records = mcap::read::LinearReader::new(&file).unwrap();
    let facts = records.filter_map(|record| match record.unwrap() {
        mcap::records::Record::Metadata(m) if m.name == "feeler.taxels" => Some(m.metadata),
        _ => None,
    });
    (tactile, topics, facts.into_iter().next().unwrap())
}

/// Every output states that the values are counts, not newtons.
#[test]
fn all_outputs_state_the_unit_counts() {
    let counts = PILLARS.replace("'N'", "'counts'");
    let folder = prepare("taxels-counts", &counts);
    let shown = sense(&folder, &[]);
    assert!(
        shown
            .stdout
            .starts_with("frame,stamp,element,f_x_counts,f_y_counts,f_z_counts\n")
    );
    assert!(shown.stderr.contains("forces are in counts"), "{shown:?}");
    sense(&folder, &["-o", "out.jsonl"]);
    let lines = fs::read_to_string(folder.join("out.jsonl")).unwrap();
    assert!(lines.contains(r#""f_z_counts":1.5"#) && !lines.contains(r#""f_z":"#));
    sense(&folder, &["-o", "out.mcap"]);
    let (_, topics, facts) = recorded(&folder.join("out.mcap"));
    assert_eq!(facts["unit"], "counts");
    assert!(!topics.contains_key("/finger/0/wrench"), "{topics:?}");
    // With known counts per newton, forces are in newtons.
    let known = counts.replace("rate", "counts_per_newton = [2.0, 2.0, 4.0]\nrate");
    fs::write(folder.join("pillars.toml"), known).unwrap();
    let shown = sense(&folder, &["--rate", "10"]);
    assert!(
        shown.stdout.contains("\n1,0.1,0,0.25,-0.125,0.375\n"),
        "{shown:?}"
    );
    assert!(!shown.stderr.contains("counts"), "{shown:?}");
}

#[test]
fn sequences_and_prefixes_are_chosen_by_argument() {
    let layout = PILLARS.replace("'p{n}", "'{prefix}{n}");
    let folder = prepare("taxels-sequences", &layout);
    let table = "run,a0_x,a0_y,a0_z,a1_x,a1_y,a1_z\nleft,1,1,1,1,1,1\nleft,2,1,1,1,1,1\nright,9,9,9,9,9,9\n";
    fs::write(folder.join("forces.csv"), table).unwrap();
    let more = ["--prefix", "a", "--sequence", "run", "--unloaded", "1"];
    let shown = sense(&folder, &more);
    let forces = "sequence,frame,stamp,element,f_x,f_y,f_z\nleft,0,0.0,0,0.0,0.0,0.0\nleft,0,0.0,1,0.0,0.0,0.0\n\
                  left,1,0.01,0,1.0,0.0,0.0\nleft,1,0.01,1,0.0,0.0,0.0\n\
                  right,2,0.02,0,0.0,0.0,0.0\nright,2,0.02,1,0.0,0.0,0.0\n";
    assert_eq!(
        (shown.status, shown.stdout.as_str()),
        (Some(0), forces),
        "{}",
        shown.stderr
    );
    let lines = sense(&folder, &[&more[..], &["-o", "out.jsonl"]].concat());
    assert_eq!(lines.status, Some(0), "{lines:?}");
    let lines = fs::read_to_string(folder.join("out.jsonl")).unwrap();
    assert!(
        lines.starts_with(r#"{"sequence":"left","frame":0"#),
        "{lines}"
    );
    sense(&folder, &[]).refused(&["expected another prefix: \"a\""]);
}

/// Each row gives a frame before the next row arrives.
#[test]
fn rows_on_standard_input_are_sensed_immediately() {
    let folder = prepare("taxels-live", PILLARS);
    let mut command = feeler(&folder, &["sense", "-", "--taxels", "pillars.toml"]);
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut rows = child.stdin.take().unwrap();
    let mut frames = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut lines = TABLE.lines();
    writeln!(rows, "starting up\n{}", lines.next().unwrap()).unwrap();
    let mut expected = WRITTEN.lines();
    assert_eq!(frames.next().unwrap().unwrap(), expected.next().unwrap());
    for line in lines {
        writeln!(rows, "{line}").unwrap();
        for _ in 0..2 {
            assert_eq!(frames.next().unwrap().unwrap(), expected.next().unwrap());
        }
        // A line that is not a row changes nothing.
        writeln!(rows, "warning: 3 fingers").unwrap();
    }
    drop(rows);
    assert!(frames.next().is_none());
    let ended = Ended::of(child.wait_with_output().unwrap());
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(
        ended
            .stderr
            .contains("4 lines without a number: skipped; the first in line 1"),
        "{ended:?}"
    );
    assert!(ended.stderr.contains("3 frames sensed") && ended.stderr.contains("4 skipped"));
}

/// A stream without rows can be interrupted, and closing the output ends the program.
#[cfg(unix)]
#[test]
fn silent_stream_can_be_interrupted_and_a_closed_pipe_is_not_an_error() {
    let folder = prepare("taxels-silent", PILLARS);
    let arguments = ["sense", "-", "--taxels", "pillars.toml"];
    let start = || {
        let mut command = feeler(&folder, &arguments);
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command.spawn().unwrap()
    };
    let mut child = start();
    let stdin = child.stdin.take();
    let mut first = String::new();
    BufReader::new(child.stdout.as_mut().unwrap())
        .read_line(&mut first)
        .unwrap();
    let ended = super::interrupted::interrupt(child);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    drop(stdin);
    let mut child = start();
    let mut stdin = child.stdin.take().unwrap();
    let rows = TABLE.replace("0,0,0,0,0,0\n", &"1,1,1,1,1,1\n".repeat(100_000));
    // The program may end before it has read everything.
    let writer = std::thread::spawn(move || stdin.write_all(rows.as_bytes()));
    let mut some = [0; 1000];
    child
        .stdout
        .as_mut()
        .unwrap()
        .read_exact(&mut some)
        .unwrap();
    drop(child.stdout.take());
    let ended = Ended::of(child.wait_with_output().unwrap());
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let _ = writer.join().unwrap();
}

#[test]
fn invalid_input_is_refused() {
    let folder = prepare("taxels-bad", PILLARS);
    let table = |text: &str| {
        fs::write(folder.join("bad.csv"), text).unwrap();
        run(
            &folder,
            &[
                "sense",
                "bad.csv",
                "--taxels",
                "pillars.toml",
                "-o",
                "bad-out.csv",
            ],
        )
    };
    table("").refused(&["bad.csv: no header with \"p0_x\" in 0 lines"]);
    table("p0_x,p0_y,p0_z,p1_x,p1_y,p1_z\n").refused(&["no frame was sensed (0 skipped)"]);
    table("1,2,3\n").refused(&["missing header", "without_header"]);
    table("p0_x\n").refused(&["expected one column \"p0_y\", got 0 in the header \"p0_x\""]);
    let bytes: Vec<u8> = (0..200_000_u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    fs::write(folder.join("bad.csv"), bytes).unwrap();
    run(&folder, &["sense", "bad.csv", "--taxels", "pillars.toml"]).refused(&["bad.csv"]);
    assert!(!folder.join("bad-out.csv").exists());
    let sense = |arguments: &[&str]| run(&folder, &[&["sense"], arguments].concat());
    sense(&["none.csv", "--taxels", "pillars.toml"]).refused(&["none.csv", "expected a table"]);
    sense(&[".", "--taxels", "pillars.toml"]).refused(&["it is a folder"]);
    sense(&["forces.csv", "forces.csv", "--taxels", "eflesh"]).refused(&["expected one table"]);
    sense(&["forces.csv", "--taxels", "none"]).refused(&["none", "uskin-4x4", "papillarray"]);
    sense(&["forces.csv", "--taxels", "forces.csv"]).refused(&["not a taxel layout"]);
    sense(&["forces.csv", "--taxels", "pillars.toml", "--prefix", "x"])
        .refused(&["columns.prefix", "{prefix}"]);
    sense(&["forces.csv", "--prefix", "x"]).refused(&["--taxels"]);
    // The experiment has no fingertip of two taxels.
    let publish = ["forces.csv", "--taxels", "pillars.toml", "--publish"];
    sense(&publish).refused(&["2 taxels", "41 elements"]);
    sense(&["forces.csv", "--taxels", "pillars.toml", "--finger", "1"])
        .refused(&["--finger", "--publish"]);
    sense(&[
        "forces.csv",
        "--taxels",
        "pillars.toml",
        "-o",
        "forces.csv",
        "--force",
    ])
    .refused(&["the file is an input"]);
    sense(&[
        "forces.csv",
        "--taxels",
        "pillars.toml",
        "-o",
        "pillars.toml",
        "--force",
    ])
    .refused(&[".csv, .jsonl or .mcap"]);
}

/// Printed layouts are complete, so that they can be edited and used.
#[test]
fn built_in_layouts_are_listed_and_printed() {
    let folder = folder("taxels-list");
    let list = run(&folder, &["list"]).done();
    for built_in in BUILT_IN_TAXELS {
        assert!(list.contains(built_in.name), "{list}");
        let printed = run(&folder, &["list", "--taxels", built_in.name]).done();
        assert_eq!(printed, built_in.text);
    }
    run(&folder, &["list", "--taxels", "none"]).refused(&["none", "expected one of uskin-4x4"]);
}
