//! Contract between pages and their TypeScript program.
//!
//! `web/test/examples.ts` contains example data of each kind of page, which the TypeScript compiler checks against the
//! declarations in `web/src/page_data.ts`. `FEELER_WRITE_EXAMPLES=1` regenerates the file.

use crate::support;
use feeler_record::{Recording, Solid, SolidFrame, SolidShape};
use feeler_report::pages::{
    Live, LiveRig, Measured, OperatingPoint, Roc, SlipPage, SweepPage, TrialMeasure, Varied,
    live_page, slip_page, sweep_page,
};
use feeler_report::run::page_of;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Maximum number of entries of a list in the examples.
const SHOWN: usize = 4;
const KINDS: usize = 7;
/// Maximum number of characters of a text in the examples.
const LETTERS: usize = 60;

#[test]
fn pages_match_the_declarations_of_their_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web/test/examples.ts");
    let examples = [report(), sweep(), slip_detectors(), live()];
    let examples = examples.map(|page| shortened(data_of(&page)));
    let text = serde_json::to_string_pretty(&examples).expect("JSON");
    let text = format!(
        "/** Pages of each kind, as feeler-report makes them; its test `page_contract` wrote this. */\n\
         import type {{ PageData }} from \"../src/page_data\";\n\n\
         export const examples: PageData[] = {text};\n"
    );
    if env::var_os("FEELER_WRITE_EXAMPLES").is_some() {
        fs::write(&path, &text).expect("the examples");
    }
    let kept = fs::read_to_string(&path).expect("web/test/examples.ts");
    let differs = kept.lines().zip(text.lines()).position(|(a, b)| a != b);
    assert!(
        kept == text,
        "web/test/examples.ts differs from what pages hold, first in line {differs:?} (from 0); \
         FEELER_WRITE_EXAMPLES=1 writes it anew, and `npm test` in web says whether its program agrees"
    );
}

/// Data of a page.
fn data_of(page: &str) -> Value {
    let (_, data) = page.split_once(r#"id="page-data">"#).expect("page data");
    let (data, _) = data.split_once("</script>").expect("an end");
    serde_json::from_str(data).expect("JSON")
}

/// Copy of `value` with lists and texts shortened and numbers rounded to be portable.
fn shortened(value: Value) -> Value {
    match value {
        Value::Array(list) => {
            let has_fields = list.first().is_some_and(Value::is_object);
            let shown = if has_fields { KINDS } else { SHOWN };
            list.into_iter().take(shown).map(shortened).collect()
        }
        Value::Object(fields) => {
            let fields = fields.into_iter();
            fields
                .map(|(name, value)| (name, shortened(value)))
                .collect()
        }
        Value::String(text) => text.chars().take(LETTERS).collect::<String>().into(),
        Value::Number(number) if number.is_f64() => {
            let rounded = format!("{:.3e}", number.as_f64().expect("a number"));
            let rounded: f64 = rounded.parse().expect("a number");
            if rounded.abs() < 1e-9 {
                0.0.into()
            } else {
                rounded.into()
            }
        }
        other => other,
    }
}

fn report() -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join("page-contract.mcap");
    support::write_run(&path, 4).expect("a run");
    let mut recording = Recording::read(&path).expect("a recording");
    recording.facts.solids = solids();
    for model in &mut recording.facts.hand {
        model.element_tips.truncate(SHOWN);
    }
    page_of(&recording)
}

/// One of each shape.
fn solids() -> Vec<Solid> {
    let shapes = [
        (
            SolidFrame::World,
            SolidShape::Box {
                size: [0.1, 0.2, 0.01],
            },
        ),
        (SolidFrame::Cap, SolidShape::Sphere { radius: 0.01 }),
        (
            SolidFrame::Cap,
            SolidShape::Cylinder {
                radius: 0.014,
                length: 0.01,
            },
        ),
        (
            SolidFrame::World,
            SolidShape::Prism {
                outline: vec![[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]],
                length: 0.02,
            },
        ),
    ];
    let solid = |(frame, shape)| Solid {
        name: "made up".into(),
        frame,
        shape,
        position: [0.0; 3],
        orientation: [0.0, 0.0, 0.0, 1.0],
    };
    shapes.map(solid).to_vec()
}

fn sweep() -> String {
    let trials = (0..40).map(f64::from);
    sweep_page(&SweepPage {
        name: "made-up".into(),
        success: "it went well",
        counts: (40, 20),
        outcomes: Vec::new(),
        claims: Vec::new(),
        numbers: vec![Varied {
            name: "friction".into(),
            logarithmic: true,
            trials: trials.clone().map(|k| (0.5 + 0.02 * k, k > 19.0)).collect(),
        }],
        words: Vec::new(),
        measured: Some(TrialMeasure {
            name: "final torque (mN·m)".into(),
            trials: (0..40)
                .zip(trials.clone().map(|k| Some(20.0 + k)))
                .collect(),
        }),
        measures: vec![Measured {
            name: "1: peak torque (mN·m)".into(),
            values: trials.collect(),
        }],
        worst_header: Vec::new(),
        worst: Vec::new(),
        varied: String::new(),
        experiment: String::new(),
    })
}

fn slip_detectors() -> String {
    let share = |share: f64| Some([share - 0.01, share, share + 0.01]);
    slip_page(&SlipPage {
        name: "made-up".into(),
        seed: 0,
        trials: 2,
        touch_force: 0.1,
        counts: (100, 10),
        points: vec![OperatingPoint {
            name: "shear rate",
            threshold: 2.0,
            precision: share(0.9),
            recall: share(0.8),
            false_alarms: share(0.02),
            median_delay: Some(1),
            never_noticed: (1, 10),
        }],
        curves: vec![Roc {
            name: "shear rate",
            points: vec![(0.0, 0.0), (0.02, 0.8), (1.0, 1.0)],
        }],
    })
}

fn live() -> String {
    let facts = support::facts();
    let rig = LiveRig {
        facts: &facts,
        homes: &[[0.03, 0.0, 0.05], [-0.03, 0.0, 0.05]],
        cap: true,
        object: false,
    };
    let live = Live {
        socket: "/token/live".into(),
        keep: 2000,
        orders: true,
        felt: true,
    };
    live_page("made-up", &rig, live)
}
