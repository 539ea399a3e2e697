//! `feeler export parquet`

use super::python::read_by;
use super::short_run;
use crate::program::{folder, run};
use feeler_record::Recording;
use serde_json::{Value, json};

#[test]
fn data_frames_contain_the_recorded_data() {
    let folder = folder("export-tables");
    short_run(&folder, "one", "1");
    short_run(&folder, "two", "2");
    let said = run(
        &folder,
        &["export", "parquet", "one", "two", "-o", "tables"],
    )
    .done();
    assert_eq!(said, "tables/one.parquet\ntables/two.parquet\n");
    let modules = ["numpy", "pandas", "polars", "pyarrow"];
    let Some(found) = read_by("read_table.py", &modules, &folder.join("tables")) else {
        return;
    };
    let recordings = ["one", "two"].map(|name| {
        let path = folder.join(name).join("recording.mcap");
        Recording::read(path).unwrap()
    });
    let [one, two] = &recordings;
    assert_eq!(found["runs"], json!(["one", "two"]));
    assert_eq!(found["rows"], json!(one.task.len() + two.task.len()));
    assert_eq!(found["digest"], json!(one.digest.to_string()));
    // Bit-identical, because JSON contains the shortest text that parses to the same number.
    let times: Vec<_> = one.task.iter().map(|task| task.stamp).collect();
    assert_eq!(found["timestamp"], json!(times));
    let phases: Vec<_> = one.task.iter().map(|task| task.phase.to_string()).collect();
    assert_eq!(found["phase"], json!(phases));
    let slips: Vec<_> = one.fingers[0]
        .flags
        .iter()
        .map(|flags| flags.slip)
        .collect();
    assert_eq!(found["slip"], json!(slips));
    let commands = one.fingers[0].command.iter();
    let action: Vec<_> = commands
        .map(|command| command.joint_velocity.as_slice())
        .collect();
    assert_eq!(found["action"], json!(action));
    let forces: Vec<Vec<[f64; 3]>> = (one.fingers[1].tactile.iter())
        .map(|frame| frame.forces.iter().map(|f| [f.x, f.y, f.z]).collect())
        .collect();
    assert_eq!(found["forces"], json!(forces));
    every_column_has_type_and_meaning(&found);
}

fn every_column_has_type_and_meaning(found: &Value) {
    let types = found["types"].as_object().unwrap();
    for (name, of_type) in types {
        let description = &found["columns"][name];
        assert!(description["meaning"].as_str().unwrap().len() > 3, "{name}");
        let expected = ["string", "double", "int64", "bool"].contains(&of_type.as_str().unwrap());
        let list = of_type.as_str().unwrap().starts_with("list<");
        assert!(expected || list, "{name}: {of_type}");
    }
    assert_eq!(types.len(), found["columns"].as_object().unwrap().len());
    assert_eq!(found["columns"]["torque"]["unit"], "N m");
    assert_eq!(types["finger_0_largest_element"], "int64");
}
