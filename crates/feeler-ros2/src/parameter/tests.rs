use super::*;

fn some() -> Parameters {
    let mut parameters = Parameters::new("it is fixed");
    let control = serde_json::json!({
        "law": "tri-axial", "touch_force": 0.1, "limits": { "speed": 2 }, "way": [1.0, 2.0],
        "finger": [{ "on": true }], "nothing": null,
    });
    parameters.add("control", &control);
    parameters
}

#[test]
fn tables_become_names_with_dots() {
    let all = some().list(&ListParametersRequest::default()).result;
    let names = [
        "control.finger.0.on",
        "control.law",
        "control.limits.speed",
        "control.touch_force",
        "control.way",
    ];
    assert_eq!(all.names, names);
    assert_eq!(
        all.prefixes,
        ["control", "control.finger.0", "control.limits"]
    );
    assert_eq!(some().types(&all.names).types, [1, 4, 2, 3, 8]);
    let values = some()
        .get(&["control.touch_force".into(), "other".into()])
        .values;
    assert_eq!((values[0].double_value, values[1].r#type), (0.1, 0));
}

#[test]
fn prefix_and_depth_filter_names() {
    let list = |prefix: &str, depth| {
        let prefixes = vec![prefix.to_string()];
        some()
            .list(&ListParametersRequest { prefixes, depth })
            .result
            .names
    };
    assert_eq!(
        list("control", 1),
        ["control.law", "control.touch_force", "control.way"]
    );
    assert_eq!(list("control.limits", 0), ["control.limits.speed"]);
    assert!(list("cont", 0).is_empty());
}

#[test]
fn parameters_cannot_be_set_and_the_reason_is_reported() {
    let wanted = |name: &str| Parameter {
        name: name.into(),
        ..Parameter::default()
    };
    let results = some().set(&[wanted("control.law"), wanted("x")]).results;
    assert_eq!(results[0].reason, "control.law cannot be set: it is fixed");
    assert_eq!(results[1].reason, "unknown parameter x");
    assert!(results.iter().all(|result| !result.successful));
    assert!(!some().set_atomically(&[wanted("x")]).result.successful);
    assert!(some().describe(&["control.law".into()]).descriptors[0].read_only);
}

#[test]
fn descriptors_contain_meanings_and_ranges_by_type() {
    let mut parameters = some();
    parameters.describe_by(|name| {
        name.starts_with("control.l").then(|| Meaning {
            description: "rad/s".into(),
            expected: "1 to 5".into(),
            range: Some([1.0, 5.0]),
        })
    });
    let names = ["control.limits.speed", "control.law", "control.touch_force"];
    let described = parameters.describe(&names.map(String::from)).descriptors;
    let speed = &described[0];
    assert_eq!(
        (&*speed.description, &*speed.additional_constraints),
        ("rad/s", "1 to 5; it is fixed")
    );
    assert_eq!(speed.integer_range[0].to_value, 5);
    assert!(speed.floating_point_range.is_empty());
    // Strings have no range.
    assert!(described[1].floating_point_range.is_empty());
    assert_eq!(described[2].additional_constraints, "it is fixed");
}
