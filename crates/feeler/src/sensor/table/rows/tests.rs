use super::super::Mark;
use super::*;
use proptest::prelude::*;

/// Reads image name and force (N) of each row.
fn read(bytes: &[u8]) -> Result<Vec<(String, f64)>, TableError> {
    let mut table = Table::open(bytes)?;
    let picture = table.column("picture")?.expect("pictures");
    let force = table
        .number_column("f_z", Quantity::Force)?
        .expect("a force");
    let mut rows = Vec::new();
    while table.advance()? {
        rows.push((
            table.text(picture).into_owned(),
            table.number(force).unwrap_or(f64::NAN),
        ));
    }
    Ok(rows)
}

fn refused(text: &str) -> String {
    read(text.as_bytes()).unwrap_err().to_string()
}

#[test]
fn reads_the_same_rows_from_all_spellings() {
    let expected = [("a.png".to_owned(), 0.5), ("b.png".to_owned(), -1250.25)];
    for text in [
        "picture,f_z\na.png,0.5\nb.png,-1250.25\n",
        "picture;f_z\na.png;0,5\nb.png;-1250,25\n",
        "picture\tf_z\na.png\t0,5\nb.png\t-1250,25",
        "\u{feff}Picture,Fz\r\na.png,0.5\r\nb.png,-1250.25\r\n",
        "picture,FZ\ra.png,0.5\rb.png,-1250.25\r",
        "sep=;\nF_z [N];picture\n0.5;a.png\n-1250.25;b.png\n",
        "\"picture\",\"f_z\"\n\"a.png\",\"0,5\"\n\"b.png\",\"-1250,25\"\n",
        "picture , f_z (mN) \n# a note\n\n a.png , 500\n,\nb.png,-1250250\n  \n",
        "picture,f_z\n,N\na.png,0.5\nb.png,-1250.25\n",
        "picture,f_z,\n-,[mN],\na.png,500,,\nb.png,-1250250,,\n",
        "picture,f_z\na.png,0.5,\nb.png,-1.25025e3,\n",
        "\"Sep=;\"\nFz [\u{3bc}N];picture\n500000;a.png\n\u{2212}1250250000\u{a0};b.png\n",
        "SEP=\t\nFz\tpicture\n0.5\ta.png\n-1250.25\tb.png\n",
    ] {
        assert_eq!(read(text.as_bytes()).unwrap(), expected, "{text:?}");
        let units = || text.trim_start_matches('\u{feff}').encode_utf16();
        let little: Vec<u8> = [0xfeff]
            .into_iter()
            .chain(units())
            .flat_map(u16::to_le_bytes)
            .collect();
        let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
        assert_eq!(read(&little).unwrap(), expected);
        assert_eq!(read(&big).unwrap(), expected);
    }
}

#[test]
fn rejects_ambiguous_tables() {
    for (text, words) in [
        ("", "the table is empty"),
        ("# nothing\n\n", "the table is empty"),
        ("PK\x03\x04", "a workbook"),
        (
            "pic\0ture,f_z
",
            "the file is binary; expected a table",
        ),
        (
            "picture;f_z\tx\n",
            "line 1: the header has semicolons and tabs",
        ),
        (
            "picture,Fz,FZ\n",
            "columns \"Fz\", \"FZ\" may all be f_z; expected one",
        ),
        (
            "picture,f_z [lbf]\n",
            "column \"f_z [lbf]\" is in \"lbf\"; expected N, mN, µN, kN, kgf or gf",
        ),
        (
            "picture,f_z\n,Nm\n",
            "column \"f_z\" is in \"Nm\"; expected N, mN, µN, kN, kgf or gf",
        ),
        (
            "picture,f_z [N]\n,mN\n",
            "column \"f_z [N]\" is in \"mN\" according to line 2",
        ),
        (
            "picture,f_z\na.png,0,5\n",
            "line 2: 3 cells; expected 2, as in the header; if numbers have decimal commas, use a semicolon or a tab",
        ),
        (
            "picture;f_z\n\na.png\n",
            "line 3: 1 cells; expected 2, as in the header",
        ),
        (
            "picture,f_z\n\"a.png,1\nb.png,2\n",
            "line 2: a quote is not closed",
        ),
    ] {
        let message = refused(text);
        assert!(message.contains(words), "{message}");
    }
    assert!(refused(&"x".repeat(super::super::MAX_LINE + 1)).contains("line 1 is longer"));
}

#[test]
fn rejects_ambiguous_numbers() {
    let mut table = Table::open(&b"f_z;f_x;n\n1,234;2,5;3\n1.5;;4.0\n1,234,567;;-1\n"[..]).unwrap();
    let z = table
        .number_column("f_z", Quantity::Force)
        .unwrap()
        .unwrap();
    let n = table.column("n").unwrap().unwrap();
    // The other column is not a column of numbers, so it does not resolve the ambiguity.
    assert!(table.advance().unwrap());
    assert_eq!(
        (table.number(z), table.whole(n)),
        (Err(NumberError::Thousands(Mark::Comma)), Some(3))
    );
    assert!(table.advance().unwrap());
    assert_eq!((table.number(z), table.whole(n)), (Ok(1.5), Some(4)));
    assert!(table.advance().unwrap());
    assert_eq!(
        (table.number(z), table.whole(n)),
        (Err(NumberError::NotANumber), None)
    );
    assert_eq!((table.line(), &*table.number_text(z)), (4, "1,234,567"));
    assert!(!table.advance().unwrap() && !table.advance().unwrap());
}

proptest! {
    /// Arbitrary bytes in any encoding are read or rejected.
    #[test]
    fn any_bytes_are_read_or_refused(
        bytes in proptest::collection::vec(prop_oneof![Just(b','), Just(b';'), Just(b'\n'), Just(b'"'), Just(b'1'), any::<u8>()], 0..300),
        wide in 0usize..3,
    ) {
        let head = "picture;f_z\n";
        let mut text: Vec<u8> = match wide {
            0 => head.into(),
            1 => head.encode_utf16().flat_map(u16::to_le_bytes).collect(),
            _ => head.encode_utf16().flat_map(u16::to_be_bytes).collect(),
        };
        text.extend(&bytes);
        let mut table = Table::open(&*text).unwrap();
        let force = table.number_column("f_z", Quantity::Force).unwrap().unwrap();
        loop {
            match table.advance() {
                Ok(true) => { let _ = (table.number(force), table.text(0), table.whole(1)); }
                Ok(false) => break,
                Err(error) => prop_assert!(error.affects_one_row() || matches!(error, TableError::Unit { .. }), "{error}"),
            }
        }
        let _ = Table::open(&*bytes);
    }
}
