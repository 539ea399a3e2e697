//! Parquet tables, read back with the `parquet` crate.

use crate::support::{MadeUp, PERIOD, force, path, recording};
use feeler_export::table;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};
use std::collections::BTreeMap;
use std::fs::File;

/// Reads the rows of a file by column name, and its key-value metadata.
fn read(name: &str) -> (Vec<BTreeMap<String, Field>>, BTreeMap<String, String>) {
    let reader = SerializedFileReader::new(File::open(path(name)).unwrap()).unwrap();
    let about = reader.metadata().file_metadata().key_value_metadata();
    let about = about.unwrap().iter();
    let about = about.map(|entry| (entry.key.clone(), entry.value.clone().unwrap()));
    let by_name = |row: Row| row.into_columns().into_iter().collect();
    let rows = reader.get_row_iter(None).unwrap();
    (
        rows.map(|row| by_name(row.unwrap())).collect(),
        about.collect(),
    )
}

fn numbers(field: &Field) -> Vec<f64> {
    let Field::ListInternal(list) = field else {
        panic!("{field} is not a list");
    };
    let number = |field: &Field| match field {
        Field::Double(number) => *number,
        other => panic!("{other} is not a number"),
    };
    list.elements().iter().map(number).collect()
}

#[test]
fn each_control_step_is_a_row_of_recorded_values() {
    // Enough steps for more than one row group.
    let made_up = MadeUp {
        fingers: 2,
        elements: 3,
        steps: 8200,
        felt_from: 2,
        ..MadeUp::default()
    };
    let recording = recording(&made_up);
    let file = File::create(path("rows.parquet")).unwrap();
    table::write("my run", &recording, file).unwrap();
    let (rows, about) = read("rows.parquet");
    assert_eq!(rows.len(), made_up.steps);
    for (step, row) in rows.iter().enumerate() {
        assert_eq!(row["run"], Field::Str("my run".into()));
        assert_eq!(row["timestamp"], Field::Double((step + 1) as f64 * PERIOD));
        let phase = if step % 2 == 0 { "SEARCH" } else { "MOVE" };
        assert_eq!(row["phase"], Field::Str(phase.into()));
        let angles = numbers(&row["finger_1_joint_position"]);
        assert_eq!(angles[2], 3.0 + 0.001 * step as f64);
        assert_eq!(row["torque"], Field::Double(1e-3 * step as f64));
        if step < made_up.felt_from {
            for column in ["force_x", "shear_rate", "touch", "grasp_force", "sensed_at"] {
                assert_eq!(row[&format!("finger_0_{column}")], Field::Null, "{column}");
            }
            continue;
        }
        let forces = |axis| numbers(&row[&format!("finger_1_force_{axis}")]);
        let expected = [0, 1, 2].map(|element| force(step, 1, element));
        assert_eq!(forces("x"), expected.map(|force| force.x));
        assert_eq!(forces("y"), expected.map(|force| force.y));
        assert_eq!(forces("z"), expected.map(|force| force.z));
        assert_eq!(row["finger_0_slip"], Field::Bool(step % 3 == 0));
        let largest = if step % 2 == 0 {
            Field::Null
        } else {
            Field::Long(1)
        };
        assert_eq!(row["finger_0_largest_element"], largest);
    }
    let columns: serde_json::Value = serde_json::from_str(&about["feeler.columns"]).unwrap();
    assert_eq!(columns.as_object().unwrap().len(), rows[0].len());
    assert_eq!(columns["finger_0_force_z"]["unit"], "N");
    let run: serde_json::Value = serde_json::from_str(&about["feeler.run"]).unwrap();
    assert_eq!(run["seed"], 5);
}

#[test]
fn defects_of_a_recording_appear_in_its_table() {
    let mut odd = recording(&MadeUp::default());
    let finger = &mut odd.fingers[0];
    // An unknown force, a frame without elements, and a missing flags message.
    finger.tactile[3].forces[1].x = f64::NAN;
    finger.tactile[4].forces.clear();
    finger.flags.remove(5);
    odd.problem = Some("it was cut off".into());
    let file = File::create(path("odd.parquet")).unwrap();
    table::write("odd", &odd, file).unwrap();
    let (rows, about) = read("odd.parquet");
    let forces = |row: usize| numbers(&rows[row]["finger_0_force_x"]);
    assert!(forces(3)[1].is_nan() && forces(3)[2] == force(3, 0, 2).x);
    assert!(forces(4).is_empty());
    assert_eq!(forces(5).len(), 3);
    // Without a flags message, the row contains the flags of the previous step.
    assert_eq!(rows[5]["finger_0_slip"], rows[4]["finger_0_slip"]);
    assert_eq!(about["feeler.problem"], "it was cut off");
}

#[test]
fn a_recording_without_steps_is_a_table_without_rows() {
    let steps = MadeUp {
        steps: 0,
        ..MadeUp::default()
    };
    let file = File::create(path("empty.parquet")).unwrap();
    table::write("empty", &recording(&steps), file).unwrap();
    let (rows, about) = read("empty.parquet");
    assert!(rows.is_empty());
    assert!(about["feeler.columns"].contains("finger_0_force_z"));
}
