//! Layout files of taxel arrays: built-in and user-written ones.

use feeler::sensor::fingertip::MAX_ELEMENTS;
use feeler::sensor::taxel::{BUILT_IN_TAXELS, BuiltInTaxels, TaxelLayout, TaxelUnit};
use proptest::prelude::*;

#[test]
fn built_in_layouts_are_valid() {
    let expected = [
        ("uskin-4x4", 16, TaxelUnit::Counts, 0.0047),
        ("eflesh", 5, TaxelUnit::Counts, 0.007),
        ("anyskin", 5, TaxelUnit::Counts, 0.007),
        ("reskin", 5, TaxelUnit::Counts, 0.007),
        ("flexitac", 384, TaxelUnit::Counts, 0.002),
        ("paxini-s1813e", 31, TaxelUnit::Newton, 0.002_628),
        ("papillarray", 9, TaxelUnit::Newton, 0.007),
    ];
    assert_eq!(expected.len(), BUILT_IN_TAXELS.len());
    for (name, taxels, unit, pitch) in expected {
        let layout = BuiltInTaxels::named(name).unwrap().layout().unwrap();
        assert_eq!((layout.taxels.len(), layout.force_unit()), (taxels, unit));
        let again = TaxelLayout::from_toml(&layout.to_toml().unwrap()).unwrap();
        assert_eq!(again, layout);
        // The smallest distance between taxels is the pitch, and the pad's middle is the origin.
        let places: Vec<_> = layout.elements().map(|(_, place)| place).collect();
        let pairs = places.iter().enumerate();
        let pairs = pairs.flat_map(|(i, a)| places[..i].iter().map(move |b| a.distance(*b)));
        let nearest = pairs.fold(f64::INFINITY, f64::min);
        // PaXini's positions are measured from the module's origin.
        let is_centred = name != "paxini-s1813e";
        let tolerance = if is_centred { 1e-9 } else { 5e-6 };
        assert!((nearest - pitch).abs() < tolerance, "{name}: {nearest}");
        let middle = places.iter().sum::<glam::DVec3>();
        assert!(middle.length() < 1e-9 || !is_centred, "{name}: {middle}");
        let on_a_dome = layout.element_layout();
        assert_eq!(on_a_dome.elements.len(), taxels);
        assert!(on_a_dome.elements.iter().all(|e| e.normal().x > 0.999));
    }
}

/// The example layout in the book is valid.
#[test]
fn the_books_layout_is_valid() {
    let page = include_str!("../../../../../docs/taxels.md");
    let (_, rest) = page.split_once("```toml\n").unwrap();
    let (block, _) = rest.split_once("```").unwrap();
    let layout = TaxelLayout::from_toml(block).unwrap();
    assert_eq!(
        (layout.taxels.len(), layout.force_unit()),
        (2, TaxelUnit::Newton)
    );
}

/// The keys in the book's page on skins are valid together.
#[test]
fn the_books_keys_of_skins_are_valid() {
    let page = include_str!("../../../../../docs/skins.md");
    let (_, rest) = page.split_once("```toml\n").unwrap();
    let (block, _) = rest.split_once("```").unwrap();
    let anyskin = BuiltInTaxels::named("anyskin").unwrap().text;
    let (above, _) = anyskin.split_once("taxel = [").unwrap();
    let own = above.lines().filter(|line| !line.starts_with("serial ="));
    let text = format!("{}\n{block}", own.collect::<Vec<_>>().join("\n"));
    let layout = TaxelLayout::from_toml(&text).unwrap();
    assert!(layout.common_mode && layout.serial.is_some() && layout.rezero.is_some());
    let places: Vec<_> = layout.elements().map(|(_, place)| place).collect();
    assert_eq!(places.len(), 16);
    // The second taxel is in the first row, the fifth below the first.
    assert!((places[1] - places[0] - 0.005 * glam::DVec3::Y).length() < 1e-12);
    assert!((places[4] - places[0] + 0.005 * glam::DVec3::Z).length() < 1e-12);
}

fn eflesh() -> &'static str {
    BuiltInTaxels::named("eflesh").unwrap().text
}

fn refused(text: &str) -> String {
    TaxelLayout::from_toml(text).unwrap_err().to_string()
}

#[test]
fn errors_name_the_invalid_value() {
    for (from, to, words) in [
        ("version = 1", "version = 2", "version 1, got 2"),
        ("version = 1", "", "missing field `version`"),
        ("unit = \"counts\"", "unit = \"kg\"", "unknown variant"),
        (
            "unit = \"counts\"",
            "unit = \"N\"\ncounts_per_newton = [1, 1, 1]",
            "set for none, since columns are in newtons",
        ),
        (
            "rate = 100.0",
            "rate = nan",
            "rate = NaN: expected 0.001 to 100000",
        ),
        (
            "rate = 100.0",
            "rate = 1.0\nraet = 1",
            "unknown field `raet`",
        ),
        (
            "rate = 100.0",
            "counts_per_newton = [0.0, 1.0, 1.0]",
            "counts_per_newton, x = 0",
        ),
        (
            "z = \"z\" }",
            "z = \"-x\" }",
            "each of the columns x, y, z once",
        ),
        ("z = \"z\" }", "z = \"w\" }", "unknown variant"),
        (
            "{prefix}{n}_x",
            "{prefix}_x",
            "one {n} for the taxel's number",
        ),
        ("{prefix}{n}_x", "{prefix}{n}_y", "three different names"),
        (
            "rows = 10",
            "rows = 1000000",
            "zero.rows = 1000000: expected 0 to 100000",
        ),
        ("rows = 10", "rows = -1", "invalid value"),
        (
            "rows = 10 }",
            "rows = 10 }\ndrift = { untouched = 0.0, time_constant = 1.0, most = 1.0 }",
            "drift.untouched = 0",
        ),
        ("turn_deg = 180", "turn_deg = 1e9", "taxel[2].turn_deg"),
        ("turn_deg = 180", "normal = [0, 0, 0]", "taxel[2].normal"),
        (
            "turn_deg = 180",
            "zero = [0, 0, 0]",
            "set for all taxels and zero.rows = 0",
        ),
        (
            "turn_deg = 180",
            "counts_per_newton = [1, 1, 1]",
            "set for 1 of 5 taxels: expected set for all taxels or none",
        ),
        (
            "place = [0.0, 0.00000, 0.00000]",
            "place = [inf, 0, 0]",
            "taxel[0].place",
        ),
    ] {
        assert!(eflesh().contains(from), "{from}");
        let message = refused(&eflesh().replacen(from, to, 1));
        assert!(message.contains(words), "{from} -> {to}: {message}");
    }
    let (head, _) = eflesh().split_once("taxel = [").unwrap();
    assert!(refused(&format!("{head}taxel = []")).contains("0 taxels"));
    let many = "{ place = [0, 0, 0] },".repeat(MAX_ELEMENTS + 1);
    assert!(refused(&format!("{head}taxel = [{many}]")).contains("1 to 512"));
    assert!(refused("").contains("not a taxel layout"));
}

proptest! {
    /// Any text is rejected, or survives a round trip.
    #[test]
    fn any_text_is_rejected_or_survives_a_round_trip(place in 0usize..3000, cut in 0usize..40, text in "[ -~\n]{0,12}") {
        let whole = eflesh();
        let start = place.min(whole.len());
        let end = (start + cut).min(whole.len());
        if whole.is_char_boundary(start) && whole.is_char_boundary(end) {
            let changed = format!("{}{text}{}", &whole[..start], &whole[end..]);
            if let Ok(layout) = TaxelLayout::from_toml(&changed) {
                let again = TaxelLayout::from_toml(&layout.to_toml().unwrap()).unwrap();
                prop_assert_eq!(again, layout);
            }
        }
    }
}
