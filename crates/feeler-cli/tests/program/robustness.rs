//! `feeler robustness`.

use crate::program::{folder, rows, run, summary};
use serde_json::Value;
use std::collections::HashMap;
use std::fs;

/// Two parameters of each group.
const RANGES: &str = r#"
[[parameter]]
name = "stiffness"
group = "apparatus"
unit = "N/m"
key = "sim.feeler.normal_stiffness"
range = "log_uniform(200, 1500)"
why = "w"

[[parameter]]
name = "shear by normal"
group = "apparatus"
key = "sim.feeler.shear_stiffness"
of = "sim.feeler.normal_stiffness"
range = "uniform(0.2, 0.5)"
why = "w"

[[parameter]]
name = "speed"
group = "tuning"
unit = "m/s"
key = "search_speed"
range = "relative(0.5, 2.0)"
why = "w"

[[parameter]]
name = "start"
group = "tuning"
unit = "m"
keys = [{ key = "screw.finger.0.home.0", factor = -1.0 }, { key = "screw.finger.1.home.0" }]
range = "shifted(-0.001, 0.16)"
why = "farther out than a finger reaches, from half way on: no hand"
"#;

/// 8 points, 2 controls each of both groups and of neither, 2 pairs of 4 parameters, the seed and 2 groups: 28 trials.
fn robustness<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let short = [
        "robustness",
        "cap-closing",
        "--ranges=ranges.toml",
        "--trials=8",
        "--controls=2",
        "--sensitivity=2",
        "--set=time_limit=1.0",
        "--seed=3",
    ];
    [&short, more].concat()
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().expect("a number")
}

#[test]
fn points_are_reproducible_and_the_page_counts_them() {
    let folder = folder("robustness");
    fs::write(folder.join("ranges.toml"), RANGES).unwrap();
    let said = run(&folder, &robustness(&["--jobs=1", "-o=one"])).done();
    assert!(
        said.contains("all together")
            && said.contains("all about the hand")
            && said.contains("four peaks (hand and bottle)")
            && said.contains("infeasible"),
        "{said}"
    );
    run(&folder, &robustness(&["--jobs=2", "-o=two"])).done();
    let whole = fs::read(folder.join("one/trials.csv")).unwrap();
    assert_eq!(whole, fs::read(folder.join("two/trials.csv")).unwrap());

    // State after an interruption: two rows are complete, a third is truncated.
    let lines: Vec<_> = whole.split_inclusive(|&b| b == b'\n').collect();
    let torn = &lines[3][..lines[3].len() / 2];
    fs::remove_file(folder.join("two/trials.csv")).unwrap();
    fs::write(
        folder.join("two/trials.csv.part"),
        [lines[0], lines[20], lines[1], torn].concat(),
    )
    .unwrap();
    run(&folder, &["robustness", "--resume", "-o=two"]).done();
    assert_eq!(whole, fs::read(folder.join("two/trials.csv")).unwrap());
    for name in ["robustness.json", "robustness.html"] {
        let [one, two] = ["one", "two"].map(|f| fs::read(folder.join(f).join(name)).unwrap());
        assert!(one == two, "{name}");
    }
    let table = rows(&folder.join("one/trials.csv"));
    assert_eq!(table.len(), 28);
    one_factor_at_a_time(&table);
    counted(&folder.join("one"), &table);

    run(&folder, &robustness(&["-o=two"])).refused(&["already contains a sweep"]);
    let fewer = robustness(&["--resume", "-o=two", "--group=tuning"]);
    run(&folder, &fewer).refused(&["number of trials is 28, not 16"]);
    let wider = RANGES.replace("uniform(0.2, 0.5)", "uniform(0.1, 0.5)");
    fs::write(folder.join("ranges.toml"), wider).unwrap();
    run(&folder, &robustness(&["--resume", "-o=two"]))
        .refused(&["its ranges or its design differ"]);
}

/// Trials 14 to 27 are two pairs, each with one factor swapped: 4 parameters, the seed, 2 groups.
fn one_factor_at_a_time(table: &[HashMap<String, String>]) {
    const NAMES: [&str; 5] = ["stiffness", "shear by normal", "speed", "start", "seed"];
    for pair in 0..2 {
        let (a, b) = (&table[2 * pair], &table[2 * pair + 1]);
        for factor in 0..7 {
            let own = &table[14 + 7 * pair + factor];
            for (index, name) in NAMES.iter().enumerate() {
                let swapped = match factor {
                    5 => index < 2,
                    6 => index == 2 || index == 3,
                    single => index == single,
                };
                assert_eq!(
                    own[*name],
                    if swapped { b } else { a }[*name],
                    "{factor} {name}"
                );
            }
        }
    }
    let (nominal, tuned) = (&table[8], &table[12]);
    assert_eq!(nominal["seed"], table[0]["seed"]);
    assert_eq!(tuned["stiffness"], nominal["stiffness"]);
    assert_eq!(tuned["speed"], table[0]["speed"]);
    assert!(number(nominal, "start") > 0.0);
}

fn counted(folder: &std::path::Path, table: &[HashMap<String, String>]) {
    let text = fs::read_to_string(folder.join("robustness.json")).unwrap();
    let page: Value = serde_json::from_str(&text).unwrap();
    let hands = table[..8]
        .iter()
        .filter(|row| row["outcome"] != "invalid")
        .count();
    assert!(0 < hands && hands < 8, "{hands}");
    assert_eq!(page["hands"], hands);
    let measures = page["measures"].as_array().unwrap();
    let claims = table[0]
        .keys()
        .filter(|k| k.starts_with("claim.") && k.matches('.').count() == 1)
        .filter(|k| !k.starts_with("claim.hand-"));
    // The claims themselves, all about the hand, and all together.
    assert_eq!(measures.len(), claims.count() + 2);
    let by = |what: &str| measures.iter().filter(|m| m["decided_by"] == what).count();
    assert_eq!((by("hand"), by("hand_and_bottle")), (9, 3));
    for measure in measures {
        assert_eq!(measure["shares"][0]["hands"], hands);
        assert_eq!(measure["holds"].as_array().unwrap().len(), 7);
    }
    let html = fs::read_to_string(folder.join("robustness.html")).unwrap();
    for word in [
        "Sobol",
        "Total-effect",
        "not a valid hand",
        "farther out",
        "shifted(-0.001, 0.16)",
    ] {
        assert!(html.contains(word), "no {word:?}");
    }
}

#[test]
fn point_can_be_rerun_bit_for_bit() {
    let folder = folder("robustness-again");
    fs::write(folder.join("ranges.toml"), RANGES).unwrap();
    run(&folder, &robustness(&["-o=r", "--group=apparatus"])).done();
    // A single group has no separate controls: 8 points, 2 controls of neither group, 2 pairs of 2 parameters and the
    // seed.
    let table = rows(&folder.join("r/trials.csv"));
    assert_eq!(table.len(), 8 + 2 + 6);
    let last = &table[15];
    run(&folder, &["run", "--trial", "r", "15", "--out", "again"]);
    let again = summary(&folder.join("again"));
    assert_eq!(last["seed"], again["seed"].to_string());
    for claim in again["claims"].as_array().unwrap() {
        let column = format!("claim.{}.value", claim["id"].as_str().unwrap());
        let value: Option<f64> = last[&column].parse().ok();
        assert_eq!(
            value.map(f64::to_bits),
            claim["value"].as_f64().map(f64::to_bits),
            "{column}"
        );
    }
    let text = fs::read_to_string(folder.join("again/report.html")).unwrap();
    assert!(
        text.contains(&last["stiffness"]),
        "the report does not show the drawn experiment"
    );
}

#[test]
fn invalid_arguments_are_refused_before_the_first_trial() {
    let folder = folder("robustness-refused");
    let ranges = |text: &str| fs::write(folder.join("ranges.toml"), text).unwrap();
    for (text, words) in [
        ("parameter = 3", ["ranges.toml", "parameter"]),
        (
            &RANGES.replace("log_uniform(200, 1500)", "normal(0,1)"),
            ["stiffness", "no bounds"],
        ),
        (
            &RANGES.replace("log_uniform(200, 1500)", "uniform(-1, 1500)"),
            ["stiffness", "normal_stiffness"],
        ),
        (
            &RANGES.replace("\"search_speed\"", "\"serch_speed\""),
            ["speed", "search_speed"],
        ),
        (
            &RANGES.replace("\"speed\"", "\"outcome\""),
            ["outcome", "already has this name"],
        ),
        (
            &RANGES.replace(", factor = -1.0", ""),
            ["start", "expected equal values"],
        ),
        (
            &RANGES.replace("\"search_speed\"", "\"sim.feeler.normal_stiffness\""),
            ["speed", "sets the same key as"],
        ),
    ] {
        ranges(text);
        run(&folder, &robustness(&["-o=r"])).refused(&words);
        assert!(!folder.join("r").exists(), "{words:?}");
    }
    ranges(RANGES);
    for (more, words) in [
        (&["--group=luck"][..], ["luck", "apparatus, tuning"]),
        (&["--sensitivity=5"], ["--sensitivity 5", "half as many"]),
        (&["--ranges=no.toml"], ["no.toml", "file of ranges"]),
        (&["--resume"], ["sweep.toml", "expected the folder"]),
    ] {
        let mut arguments = robustness(&["-o=r"]);
        arguments.retain(|a| {
            !more
                .iter()
                .any(|m| a.split('=').next() == m.split('=').next())
        });
        arguments.extend(more);
        run(&folder, &arguments).refused(&words);
    }
    run(&folder, &["robustness", "contour"])
        .refused(&["no built-in ranges for contour", "cap-closing"]);
    run(
        &folder,
        &[
            "sweep",
            "cap-closing",
            "--trials=1",
            "--set=time_limit=0.5",
            "--sensing=direct",
            "-o=s",
        ],
    )
    .done();
    run(&folder, &["robustness", "--resume", "-o=s"]).refused(&["contains a sweep"]);
}

#[test]
fn files_of_ranges_are_combined_and_add_the_varied_tables() {
    let folder = folder("robustness-together");
    fs::write(folder.join("ranges.toml"), RANGES).unwrap();
    let rubber = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../feeler-lab/experiments/cap-closing.rubber.toml"
    );
    let ranges = format!("--ranges={rubber}");
    let both = robustness(&[&ranges, "--group=shift,tuning", "-o=r"]);
    run(&folder, &both).done();
    let table = rows(&folder.join("r/trials.csv"));
    // 8 points, 2 controls of each group and of neither, 2 pairs of 2 + 3 parameters, the seed and 2 groups.
    assert_eq!(table.len(), 8 + 3 * 2 + 2 * 8);
    let run = &table[0];
    assert!(!run.contains_key("stiffness") && !run.contains_key("backlash"));
    assert!(number(run, "clamp stiffness") <= 1e5 && number(run, "speed") > 0.0);
    // After one second there are no four strokes to compare.
    assert!(table.iter().all(|row| row["fig8"].is_empty()));
    let plan = fs::read_to_string(folder.join("r/sweep.toml")).unwrap();
    for table in ["relaxation", "lateral"] {
        assert!(plan.contains(table), "{table}");
    }
}

/// Arguments that run the points of the design under each of `laws`, for one second.
fn side_by_side<'a>(laws: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let short = [
        "robustness",
        "cap-closing",
        "--ranges=ranges.toml",
        "--trials=8",
        "--set=time_limit=1.0",
        "--seed=3",
        laws,
    ];
    [&short, more].concat()
}

#[test]
fn laws_run_side_by_side_on_the_same_hands() {
    let folder = folder("robustness-laws");
    fs::write(folder.join("ranges.toml"), RANGES).unwrap();
    let arguments = side_by_side("--laws=best,tri-axial", &["-o=l"]);
    let said = run(&folder, &arguments).done();
    assert!(
        said.contains("all five") && said.contains("laws.html"),
        "{said}"
    );
    let [best, papers] =
        ["best", "tri-axial"].map(|law| rows(&folder.join("l").join(law).join("trials.csv")));
    assert_eq!((best.len(), papers.len()), (8, 8));
    for (best, papers) in best.iter().zip(&papers) {
        for name in ["seed", "stiffness", "shear by normal", "speed", "start"] {
            assert_eq!(best[name], papers[name], "{name}");
        }
    }
    let text = fs::read_to_string(folder.join("l/laws.json")).unwrap();
    let page: Value = serde_json::from_str(&text).unwrap();
    let hands = papers
        .iter()
        .filter(|row| row["outcome"] != "invalid")
        .count();
    assert!(0 < hands && hands < 8, "{hands}");
    assert_eq!(page["hands"], hands);
    for (law, name) in page["laws"]
        .as_array()
        .unwrap()
        .iter()
        .zip(["best", "tri-axial"])
    {
        assert_eq!((&law["law"], &law["refused"]), (&name.into(), &0.into()));
        let shares = law["shares"].as_array().unwrap();
        let of: Vec<_> = shares
            .iter()
            .map(|share| share["of"].as_str().unwrap())
            .collect();
        let five = [
            "follows cap",
            "path is curved",
            "grip is steady",
            "overloads nothing",
            "closes cap",
        ];
        assert_eq!(of, [&five[..], &["all five"]].concat());
        // After one second no stroke is complete, but nothing was overloaded.
        let holding: Vec<_> = shares
            .iter()
            .map(|share| share["holding"].as_u64().unwrap())
            .collect();
        assert_eq!(holding[0], 0);
        assert_eq!((holding[4], holding[5]), (0, 0));
    }
    let html = fs::read_to_string(folder.join("l/laws.html")).unwrap();
    for word in [
        "tri-axial",
        "overloads nothing",
        "Wilson",
        "farther out",
        "LAW TRIAL",
    ] {
        assert!(html.contains(word), "no {word:?}");
    }

    // State after an interruption, and a rerun of one of the hands.
    let whole = fs::read(folder.join("l/best/trials.csv")).unwrap();
    let lines: Vec<_> = whole.split_inclusive(|&b| b == b'\n').collect();
    fs::remove_file(folder.join("l/best/trials.csv")).unwrap();
    fs::write(
        folder.join("l/best/trials.csv.part"),
        [lines[0], lines[2]].concat(),
    )
    .unwrap();
    let again = side_by_side("--laws=best,tri-axial", &["-o=l", "--resume"]);
    run(&folder, &again).done();
    assert_eq!(whole, fs::read(folder.join("l/best/trials.csv")).unwrap());
    assert_eq!(
        text,
        fs::read_to_string(folder.join("l/laws.json")).unwrap()
    );
    let hand = papers
        .iter()
        .position(|row| row["outcome"] != "invalid")
        .unwrap();
    run(
        &folder,
        &["run", "--trial", "l/best", &hand.to_string(), "--out=again"],
    );
    assert_eq!(
        best[hand]["seed"],
        summary(&folder.join("again"))["seed"].to_string()
    );
}

#[test]
fn invalid_law_comparisons_are_refused_before_the_first_trial() {
    let folder = folder("robustness-laws-refused");
    fs::write(folder.join("ranges.toml"), RANGES).unwrap();
    for (laws, more, words) in [
        (
            "--laws=tri-axial,worst",
            &[][..],
            &[
                "\"worst\"",
                "tri-axial, tri-axial-missing-shear, normal-only, open-loop, best",
            ][..],
        ),
        ("--laws=best,best", &[], &["best", "twice"]),
        (
            "--laws=best",
            &["--controls=2"],
            &["--controls", "cannot be used with"],
        ),
        (
            "--laws=best",
            &["--group=luck"],
            &["luck", "apparatus, tuning"],
        ),
        (
            "--laws=best",
            &["--set=task.screw.strokes=2"],
            &["claims of any hand", "four strokes"],
        ),
    ] {
        let arguments = side_by_side(laws, &[more, &["-o=l"]].concat());
        run(&folder, &arguments).refused(words);
        assert!(!folder.join("l").exists(), "{words:?}");
    }
    let alone = ["robustness", "--laws=best", "--resume", "-o=l"];
    run(&folder, &alone).refused(&["--laws", "requires the experiment"]);
}
