//! Removes the keys of an experiment file that equal their defaults.

use super::experiment_config::ExperimentConfig;
use super::load::Experiment;
use toml_edit::{DocumentMut, Item};

/// Keys that are kept even if they equal their defaults because they are edited most often.
const USUAL: [&str; 22] = [
    "name",
    "seed",
    "sensing",
    "time_limit",
    "control.period",
    "control.touch_force",
    "control.over_force",
    "control.slip_threshold",
    "control.limits.fingertip_speed",
    "task.screw.strokes",
    "task.screw.search_speed",
    "task.screw.grasp_force",
    "task.screw.move_speed",
    "task.screw.travel",
    "task.contour.follow_speed",
    "task.contour.contact_force",
    "task.carry.carry_speed",
    "task.friction_scan.load",
    "task.friction_scan.slide_speed",
    "task.friction_scan.strokes",
    "sim.feeler.static_friction",
    "sim.feeler.kinetic_friction",
];

/// Comment inserted above the `[sim]` table.
const OVER_SIM: &str = "
# The simulated world. A real rig has none: leave out [sim] and all that follows.
";

impl Experiment {
    /// Returns an equivalent text that contains only required keys, keys that differ from their defaults, and the keys
    /// that are edited most often, with their comments. The text begins with the comment `heading`.
    pub fn in_short(&self, heading: &str) -> String {
        let Ok(mut document) = self.toml.parse::<DocumentMut>() else {
            return self.toml.clone();
        };
        for path in paths(&document) {
            let mut shorter = document.clone();
            let removed = !is_usual(&path) && remove(shorter.as_item_mut(), &path).is_some();
            let read = || toml::from_str::<ExperimentConfig>(&shorter.to_string());
            if removed && read().is_ok_and(|config| config == self.config) {
                document = shorter;
            }
        }
        if let Some(mut first) = document.key_mut("name") {
            first.leaf_decor_mut().set_prefix(heading);
        }
        if let Some(sim) = document.get_mut("sim").and_then(Item::as_table_mut) {
            sim.decor_mut().set_prefix(OVER_SIM);
        }
        document.to_string()
    }
}

/// Returns `true` if the key at `path`, or a key below it, is in [`USUAL`].
fn is_usual(path: &[String]) -> bool {
    let key = path.join(".");
    let below = |usual: &str| usual.strip_prefix(&key)?.chars().next().map(|c| c == '.');
    USUAL
        .iter()
        .any(|usual| *usual == key || below(usual) == Some(true))
}

/// Returns the paths of all keys, each table before its content. Lists are not descended into.
fn paths(document: &DocumentMut) -> Vec<Vec<String>> {
    let mut paths = Vec::new();
    collect(document.as_item(), &[], &mut paths);
    paths
}

fn collect(item: &Item, path: &[String], paths: &mut Vec<Vec<String>>) {
    for (key, below) in item
        .as_table_like()
        .into_iter()
        .flat_map(|table| table.iter())
    {
        let path = [path, &[key.to_string()]].concat();
        paths.push(path.clone());
        collect(below, &path, paths);
    }
}

/// Removes and returns the item at `path`, if any.
fn remove(item: &mut Item, path: &[String]) -> Option<Item> {
    let table = item.as_table_like_mut()?;
    match path {
        [] => None,
        [key] => table.remove(key),
        [key, below @ ..] => remove(table.get_mut(key)?, below),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::BUILT_IN;

    fn load(name: &str) -> Experiment {
        Experiment::load(name, &[]).expect("a built-in experiment")
    }

    #[test]
    fn minimal_texts_of_built_in_experiments_are_equivalent() {
        for built_in in BUILT_IN {
            let whole = load(built_in.name);
            let text = whole.in_short("# Heading\n");
            let short = Experiment::parse(&text, "short", &[], None).expect("an experiment");
            assert_eq!(short.config, whole.config, "{}", built_in.name);
            assert_eq!(short.sha256(), whole.sha256());
            assert!(text.starts_with("# Heading\nname ="), "{text}");
            let lines = |text: &str| text.lines().count();
            // Experiments that spell out everything, including the hand, lose a third of their text. Experiments that
            // omit defaults, the template, and those whose arm follows a script, lose little more than their heading.
            let has_script = built_in.toml.contains("[[sim.arm]]");
            let says_all = built_in.toml.contains("[[hand.finger]]") && !has_script;
            let is_template = built_in.toml.contains("[drives]");
            let of_three = if says_all && !is_template { 2 } else { 3 };
            assert!(3 * lines(&text) < of_three * lines(built_in.toml), "{text}");
        }
        let text = load("cap-closing").in_short("");
        for word in [
            "[sim]",
            "A real rig has none",
            "touch_force = 0.1       # N, F1",
        ] {
            assert!(text.contains(word), "no {word} in {text}");
        }
        assert!(text.lines().count() <= 60, "{text}");
    }

    /// All keys default to the values of the reference experiment.
    #[test]
    fn defaults_equal_the_reference_experiment() {
        let text = r#"
            name = "cap-closing"
            description = "Two fingers close a bottle cap in four touch-and-release strokes (paper, section V)."
            sensor.calibration = "reference-fingertip.coupled.calibration.toml"
            [[task.screw.finger]]
            home = [-0.038, 0.00195, 0.1]
            approach = [1.0, 0.0, 0.0]
            stroke = [0.0, -1.0, 0.0]
            [[task.screw.finger]]
            home = [0.038, -0.00195, 0.1]
            approach = [-1.0, 0.0, 0.0]
            stroke = [0.0, 1.0, 0.0]
            [sim.object.cap]
            position = [0.0, 0.0, 0.1]
            shape.cylinder = { radius = 0.014, height = 0.020 }
            [sim.object.cap.motion.thread]
            running_torque = 0.0021
            seat_angle = 0.59
            seat_stiffness = 0.42
            static_factor = 1.05
            lead = 0.00318
        "#;
        let least = Experiment::parse(text, "least", &[], None).expect("an experiment");
        assert_eq!(least.config, load("cap-closing").config);
    }

    /// Defaults of each task equal the values of the experiment that demonstrates it.
    #[test]
    fn task_defaults_equal_their_experiments() {
        let cases: [(&str, &str, &[&str]); 4] = [
            ("contour", "contour", &["home", "approach", "feeler"]),
            (
                "friction-scan",
                "friction_scan",
                &["home", "approach", "slide"],
            ),
            (
                "slide-box-two",
                "carry",
                &["grip_force", "crush_force", "waypoint", "finger", "feeler"],
            ),
            ("cap-closing", "screw", &["finger"]),
        ];
        for (name, task, needed) in cases {
            let whole = load(name);
            let mut document: DocumentMut = whole.toml.parse().expect("TOML");
            let table = document["task"][task].as_table_mut().expect("a table");
            table.retain(|key, _| needed.contains(&key));
            let least = Experiment::parse(&document.to_string(), "least", &[], None);
            assert_eq!(least.expect("an experiment").config.task, whole.config.task);
        }
    }

    /// Setting one entry of a list leaves the other entries at their defaults.
    #[test]
    fn an_entry_of_an_omitted_list_can_be_set() {
        let settings = [
            "hand.finger.1.joint_speed_limit.0=1.5".to_string(),
            "control.limits.workspace_lower.2=0.08".to_string(),
            "sensor.fingertip.layout.rings.3.elements=18".to_string(),
        ];
        let whole = load("cap-closing");
        let short = whole.in_short("");
        let load = |text| Experiment::parse(text, "text", &settings, None).expect("an experiment");
        assert_eq!(load(&short).config, load(&whole.toml).config);
        assert_ne!(load(&short).config, whole.config);
        let none = "hand.finger.2.joint_speed_limit.0=1.5".to_string();
        let error = Experiment::parse(&short, "text", &[none], None).expect_err("two fingers");
        assert!(error.to_string().contains("expected 0 to 1"), "{error}");
    }
}
