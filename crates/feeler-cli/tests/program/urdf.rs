//! `feeler urdf`, which describes the hand of any experiment.

use crate::program::{folder, run};

#[test]
fn urdf_describes_every_hand() {
    let folder = folder("urdf");
    for (experiment, fingers) in [("cap-closing", 2), ("three-fingers", 3)] {
        let text = run(&folder, &["urdf", experiment]).done();
        let document = roxmltree::Document::parse(&text).unwrap();
        let robot = document.root_element();
        assert_eq!(robot.attribute("name"), Some(experiment));
        let joints = robot.children().filter(|node| node.has_tag_name("joint"));
        let turning = joints.filter(|joint| joint.attribute("type") == Some("revolute"));
        assert_eq!(turning.count(), 3 * fingers);
    }
    let turned = run(
        &folder,
        &["urdf", "cap-closing", "--set", "hand.finger.0.phi1_deg=90"],
    );
    assert!(turned.done().contains("rpy=\"0 1.5707963267948966 0\""));
}

#[test]
fn invalid_hands_are_refused() {
    let folder = folder("urdf-refused");
    let refused = run(&folder, &["urdf", "no-such.toml"]);
    refused.refused(&["no-such.toml"]);
    let setting = "--set=hand.finger.0.links=[0.03, -1.0, 0.055]";
    let refused = run(&folder, &["urdf", "cap-closing", setting]);
    refused.refused(&["links[1] = -1"]);
}
