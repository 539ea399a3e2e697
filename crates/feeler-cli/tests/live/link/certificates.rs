//! The command `certificates`: creating, withdrawing and renewing the certificates of a lab.

use crate::program::run;
use crate::rig::{Setup, certificates};
use std::fs;

#[test]
fn existing_certificates_are_not_overwritten() {
    let folder = Setup::new("link-lab").folder;
    certificates(&folder, "lab", "127.0.0.1");
    let again = run(&folder, &["certificates", "lab", "127.0.0.1=rig"]);
    again.refused(&["already exists", "--renew"]);
    let strange = run(&folder, &["certificates", "lab", "b=fly"]);
    strange.refused(&["expected hand, rig, sense-0 to sense-4"]);
    let unknown = run(&folder, &["certificates", "lab", "--withdraw", "b"]);
    unknown.refused(&["b has no certificate"]);
    let nowhere = run(&folder, &["certificates", "nowhere", "--list"]);
    nowhere.refused(&["no certificate authority"]);
}

#[test]
fn withdrawn_certificates_are_listed_and_distributed() {
    let folder = Setup::new("link-withdrawn").folder;
    let lab = |arguments: &[&str]| run(&folder, &[&["certificates", "lab"], arguments].concat());
    let made = lab(&["a=hand,order", "b=sense-0", "c"]).done();
    assert!(
        made.contains("lab/a: hand.1, order.1, valid until 2"),
        "{made}"
    );
    assert!(
        made.contains("watch.1") && made.contains("all rights"),
        "{made}"
    );
    let renewed = lab(&["--renew", "b", "--days", "7"]).done();
    assert!(
        renewed.contains("not withdrawn, valid until they expire: sense-0.1"),
        "{renewed}"
    );
    let withdrawn = lab(&["--withdraw", "b=sense-0", "a=order"]).done();
    assert!(withdrawn.contains("sense-0.1, sense-0.3"), "{withdrawn}");
    let renewed = lab(&["--renew", "--withdraw", "c=watch"]).done();
    assert!(
        renewed.contains("lab/c: watch.2") && renewed.contains("withdrawn: watch.1"),
        "{renewed}"
    );

    let names = |text: &str| -> Vec<String> {
        let first = text.lines().filter_map(|line| line.split(' ').next());
        first.map(String::from).collect()
    };
    let expected = ["sense-0.1", "sense-0.3", "order.1", "watch.1"];
    for place in ["lab", "lab/a", "lab/b", "lab/c"] {
        let list = fs::read_to_string(folder.join(place).join("withdrawn.txt")).expect(place);
        assert_eq!(names(&list), expected, "{place}");
    }
    let listed = lab(&["--list"]).done();
    let line = |start: [&str; 3]| {
        let words = |l: &&str| l.split_whitespace().take(3).eq(start);
        listed.lines().find(words).expect(&listed).to_string()
    };
    assert!(line(["a", "hand", "1"]).ends_with("valid"), "{listed}");
    assert!(
        line(["b", "sense-0", "1"]).ends_with("withdrawn, replaced"),
        "{listed}"
    );
    assert!(line(["c", "watch", "2"]).ends_with("valid"), "{listed}");
}

#[test]
fn order_without_the_right_is_refused() {
    let setup = Setup::new("link-right");
    run(&setup.folder, &["certificates", "lab", "a=sense-0"]).done();
    let link = ["--certificates", "lab/a/sense-0"].map(String::from);
    setup
        .order("stop", &link)
        .refused(&["sense-0.1", "order, stop"]);
}
