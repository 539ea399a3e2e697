//! Tables of taxel arrays with irregular content.

use super::taxels::layout;
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::taxel::{
    BuiltInTaxels, MAX_LINE, TableProblem, TaxelError, TaxelLayout, TaxelSensor, TimeColumn,
    TimeUnit,
};
use proptest::prelude::*;
use std::io::{self, BufRead, Read};

const HEADER: &str = "t0_x,t0_y,t0_z,t1_x,t1_y,t1_z\n";

fn newtons() -> TaxelLayout {
    layout("unit = 'N'\nrate = 100.0", "")
}

fn timed(unit: TimeUnit) -> TaxelLayout {
    let mut layout = newtons();
    layout.columns.time = Some(TimeColumn {
        column: "time".into(),
        unit,
    });
    layout
}

/// Frames of the table, and each kind of problem with its count and the line of its first occurrence.
fn sensed(
    layout: &TaxelLayout,
    table: &[u8],
) -> (Vec<TactileFrame>, Vec<(TableProblem, u64, u64)>) {
    let mut sensor = TaxelSensor::open(table, layout, None).unwrap();
    let mut frame = TactileFrame::unloaded(sensor.element_count());
    let mut frames = Vec::new();
    loop {
        match sensor.read(&mut frame) {
            Ok(()) => frames.push(frame.clone()),
            Err(SensorError::Ended { count }) => {
                assert_eq!(count, frames.len() as u64);
                break;
            }
            // The first row has more cells than the header.
            Err(SensorError::Table(_)) if frames.is_empty() => break,
            Err(error) => panic!("{error}"),
        }
    }
    let seen = sensor.problems().iter();
    let seen = seen.map(|s| (s.problem, s.count, s.first.line));
    (frames, seen.collect())
}

fn refused(layout: &TaxelLayout, table: &str) -> TaxelError {
    TaxelSensor::open(table.as_bytes(), layout, None).unwrap_err()
}

#[test]
fn irregularities_are_counted_and_no_row_is_lost() {
    let mut table = format!("\u{feff}Connected to COM3\r\n# made by hand\r\n{HEADER}");
    let long = "1,".repeat(MAX_LINE);
    for line in [
        "1,2,3,4,5,6",
        "1,2,3,4,5,6",
        ",2,3,4,5,6",
        "1,x,3,4,5,6",
        "1,2,inf,4,5,6",
        "1,2,3,4,5,1e300",
        "1,2,3",
        "1,2,3,4,5,6,7",
        "error: timeout, again",
        "",
        long.as_str(),
        "\"7\", 2 ,3,4,5,\u{fffd}",
    ] {
        table += line;
        table += "\r\n";
    }
    table += HEADER;
    table += "9,2,3,4,5,6";
    let (frames, problems) = sensed(&newtons(), table.as_bytes());
    assert_eq!(
        problems,
        [
            (TableProblem::NotARow, 2, 1),
            (TableProblem::TooLong, 1, 14),
            (TableProblem::HeaderAgain, 1, 16),
            (TableProblem::CellCount, 2, 10),
            (TableProblem::Empty, 1, 6),
            (TableProblem::NotANumber, 2, 7),
            (TableProblem::NotFinite, 2, 8),
            (TableProblem::Repeated, 1, 5),
        ]
    );
    let valid: Vec<_> = frames
        .iter()
        .map(|f| [f.is_valid(0), f.is_valid(1)])
        .collect();
    let (both, first, second, none) = ([true, true], [true, false], [false, true], [false; 2]);
    assert_eq!(
        valid,
        [
            both, both, second, second, second, first, none, none, first, both
        ]
    );
    let stamps = frames.iter().map(|f| (f.sequence, f.stamp));
    let expected = (0..10).map(|n| (n, n as f64 / 100.0));
    assert!(stamps.eq(expected));
    assert_eq!(frames[8].forces[0].to_array(), [7.0, 2.0, 3.0]);
}

#[test]
fn irregular_times_are_counted_and_kept() {
    let times = [
        "0", "10", "20", "30", "40", "50", "60", "60", "55", "65", "75", "x", "1e40", "500", "510",
    ];
    let mut table = format!("time,{HEADER}");
    for (number, time) in times.iter().enumerate() {
        table += &format!("{time},{number},0,0,0,0,0\n");
    }
    let (frames, problems) = sensed(&timed(TimeUnit::Ms), table.as_bytes());
    assert_eq!(
        problems,
        [
            (TableProblem::TimeUnreadable, 2, 13),
            (TableProblem::TimeRepeated, 1, 9),
            (TableProblem::TimeBack, 1, 10),
            (TableProblem::TimeJump, 1, 15),
        ]
    );
    let stamps: Vec<_> = frames.iter().map(|f| (f.stamp * 1e3).round()).collect();
    let expected = [0, 10, 20, 30, 40, 50, 60, 60, 55, 65, 75, 75, 75, 500, 510].map(f64::from);
    assert_eq!(stamps, expected);
    // With a rate, the time column is ignored.
    let sensor = TaxelSensor::open(table.as_bytes(), &timed(TimeUnit::Ms), Some(50.0));
    let mut frame = TactileFrame::unloaded(2);
    let mut sensor = sensor.unwrap();
    while sensor.read(&mut frame).is_ok() {}
    assert_eq!(
        (frame.stamp, sensor.problems().iter().count()),
        (14.0 / 50.0, 0)
    );
}

#[test]
fn tables_without_a_header_use_the_layouts_column_order() {
    let layout = BuiltInTaxels::named("anyskin").unwrap().layout().unwrap();
    let row = |time: f64, x: f64| format!("{time}{}\n", format!(",{x},2,3").repeat(5));
    let table = row(0.5, 1.0) + &row(0.51, 5.0);
    let (frames, problems) = sensed(&layout, table.as_bytes());
    assert_eq!((frames.len(), problems.len()), (2, 0));
    assert_eq!((frames[0].stamp, frames[1].stamp), (0.5, 0.51));
    // Half of the step from 1 to 5, because the zero is the mean so far. The second chip is turned by -90 degrees.
    assert!((frames[1].forces[1].y + 2.0).abs() < 1e-9, "{frames:?}");
    let short = refused(&layout, "1,2,3\n").to_string();
    assert!(
        short.contains("expected 16 columns") && short.contains("got 3 in line 1"),
        "{short}"
    );
    let none = refused(&newtons(), "1,2,3,4,5,6\n").to_string();
    assert!(
        none.contains("columns.without_header of the layout"),
        "{none}"
    );
}

#[test]
fn errors_describe_invalid_headers() {
    let newtons = newtons();
    for (table, words) in [
        ("", "in 0 lines"),
        (
            "hello\nworld\n",
            "no header with \"t0_x\" in 2 lines; the first is \"hello\"",
        ),
        (
            "t0_x,t0_y\n",
            "expected one column \"t0_z\", got 0 in the header",
        ),
        (
            "t0_x,t0_y,t0_z,t1_x,t1_y,t1_z,t1_z\n",
            "expected one column \"t1_z\", got 2 in the header",
        ),
    ] {
        let message = refused(&newtons, table).to_string();
        assert!(message.contains(words), "{message}");
    }
    let prefixed = HEADER.replace('t', "left_t") + "1\n";
    let message = refused(&newtons, &prefixed).to_string();
    assert!(
        message.contains("expected another prefix: \"left_\""),
        "{message}"
    );
    let mut twice = newtons.clone();
    twice.columns.sequence = Some("t0_x".into());
    assert!(matches!(
        refused(&twice, HEADER),
        TaxelError::TwoMeanings { .. }
    ));
    let mut timeless = newtons.clone();
    timeless.rate = None;
    assert!(matches!(refused(&timeless, HEADER), TaxelError::NoTime));
    let long = "x".repeat(MAX_LINE + 1);
    assert!(matches!(
        refused(&newtons, &long),
        TaxelError::TooLong { line: 1 }
    ));
    assert!(matches!(
        TaxelSensor::open(HEADER.as_bytes(), &newtons, Some(f64::NAN)),
        Err(TaxelError::Rate { .. })
    ));
}

/// Tables in the formats of different programs give equal frames.
#[test]
fn tables_of_other_programs_are_read() {
    let plain = format!("{HEADER}0.5,-1,2.25,3,4,5\n7,8,9,10,11,12.75\n");
    let (expected, _) = sensed(&newtons(), plain.as_bytes());
    let german = plain.replace(',', ";").replace('.', ",");
    let units = "T0_X [N];t0 y;t0-z;t1_x;t1_y;T1_Z\r\n[N];N;-;N;N;N\r\n";
    for text in [
        german.clone(),
        german.replace(';', "\t"),
        plain.replace('\n', "\r"),
        german.replace(&HEADER.replace(',', ";"), units),
    ] {
        let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        for bytes in [text.as_bytes(), &wide] {
            let (frames, problems) = sensed(&newtons(), bytes);
            assert_eq!(problems, [], "{text}");
            assert_eq!(format!("{frames:?}"), format!("{expected:?}"), "{text}");
        }
    }
}

#[test]
fn ambiguous_numbers_and_units_are_not_guessed() {
    let header = HEADER.replace(',', ";");
    let (frames, problems) = sensed(
        &newtons(),
        format!("{header}1,234;0;0;0;0;0\n1,5;0;0;2.5;0;0\n").as_bytes(),
    );
    assert_eq!(problems, [(TableProblem::DecimalMark, 2, 2)]);
    assert_eq!(
        [
            frames[0].is_valid(0),
            frames[1].is_valid(0),
            frames[1].is_valid(1)
        ],
        [false, true, false]
    );
    // Decimal commas between comma separators add cells, which the first row reports as an error.
    let commas = "0,5,1,5,2,5,3,5,4,5,5,5\n";
    let error = first_error(&format!("{HEADER}{commas}"));
    assert!(
        error.contains(
            "line 2: 12 cells; expected 6, as in the header; if numbers have decimal commas"
        ),
        "{error}"
    );
    // In a later row, or with one more cell, all forces are invalid.
    for table in [
        format!("{HEADER}1,2,3,4,5,6\n{commas}"),
        format!("{HEADER}1,2,3,4,5,6,7\n"),
    ] {
        let (frames, problems) = sensed(&newtons(), table.as_bytes());
        let last = frames.last().unwrap();
        assert_eq!(
            (last.is_valid(0), &*problems),
            (
                false,
                &[(TableProblem::CellCount, 1, 1 + frames.len() as u64)][..]
            )
        );
    }
    let message = refused(&newtons(), &HEADER.replace("t0_x", "T0x [mN]")).to_string();
    assert_eq!(
        message,
        "column \"T0x [mN]\" is in \"mN\"; expected N, the unit in the layout"
    );
    let error = first_error(&format!("{HEADER}mN,mN,mN,mN,mN,mN\n1,2,3,4,5,6\n"));
    assert!(error.contains("is in \"mN\"; expected N"), "{error}");
}

/// Error for the first row of a table.
fn first_error(table: &str) -> String {
    let mut sensor = TaxelSensor::open(table.as_bytes(), &newtons(), None).unwrap();
    let read = sensor.read(&mut TactileFrame::unloaded(2));
    read.unwrap_err().to_string()
}

/// A reader that returns a few bytes at a time and is interrupted in between.
struct Trickle<'a>(&'a [u8], usize, bool);

impl Read for Trickle<'_> {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        unreachable!("only the buffered interface is used")
    }
}

impl BufRead for Trickle<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.2 = !self.2;
        match self.2 {
            true => Err(io::ErrorKind::Interrupted.into()),
            false => Ok(&self.0[..self.1.min(self.0.len())]),
        }
    }

    fn consume(&mut self, amount: usize) {
        self.0 = &self.0[amount..];
    }
}

proptest! {
    /// With any bytes below a header, nothing panics and forces are finite or invalid.
    #[test]
    fn any_bytes_give_finite_or_invalid_forces(bytes in proptest::collection::vec(
        prop_oneof![Just(b','), Just(b'\n'), Just(b'1'), Just(b'-'), Just(b'e'), Just(b'"'), any::<u8>()], 0..600)
    ) {
        let table = [format!("time,{HEADER}").as_bytes(), &bytes].concat();
        let (frames, problems) = sensed(&timed(TimeUnit::Ns), &table);
        let lines = bytes.split(|&b| matches!(b, b'\n' | b'\r')).count() as u64;
        let skipped: u64 = problems.iter().filter(|t| t.0.is_skipped()).map(|t| t.1).sum();
        prop_assert!(frames.len() as u64 + skipped <= lines);
        for force in frames.iter().flat_map(|frame| &frame.forces) {
            prop_assert!(force.is_finite() || force.is_nan());
        }
        prop_assert!(frames.iter().all(|frame| frame.stamp.is_finite()));
    }

    /// A broken cell invalidates only its taxel's force in its frame.
    #[test]
    fn broken_cells_invalidate_only_their_taxel(
        rows in proptest::collection::vec((proptest::array::uniform6(-1e6..1e6), proptest::option::of((0usize..6, 0usize..4))), 1..40),
        chunk in 1usize..50,
    ) {
        let mut table = HEADER.to_string();
        for (values, broken) in &rows {
            let mut cells = values.map(|value: f64| value.to_string());
            if let Some((cell, how)) = *broken {
                cells[cell] = ["", "NaN", "what?", "-inf"][how].into();
            }
            table += &(cells.join(",") + "\n");
        }
        let (frames, _) = sensed(&newtons(), table.as_bytes());
        prop_assert_eq!(frames.len(), rows.len());
        for (frame, (values, broken)) in frames.iter().zip(&rows) {
            for taxel in 0..2 {
                let is_broken = broken.is_some_and(|(cell, _)| cell / 3 == taxel);
                prop_assert_eq!(frame.is_valid(taxel), !is_broken);
                if !is_broken {
                    prop_assert_eq!(&frame.forces[taxel].to_array()[..], &values[3 * taxel..][..3]);
                }
            }
        }
        // The result does not depend on how the stream is split.
        let mut sensor = TaxelSensor::open(Trickle(table.as_bytes(), chunk, false), &newtons(), None).unwrap();
        let mut frame = TactileFrame::unloaded(2);
        let same = |a: &TactileFrame, b: &TactileFrame| format!("{a:?}") == format!("{b:?}");
        for expected in &frames {
            sensor.read(&mut frame).unwrap();
            prop_assert!(same(&frame, expected));
        }
        prop_assert!(sensor.read(&mut frame).is_err());
    }
}
