//! Programs that the lab has not invited.

use crate::faults::DIRECT;
use crate::program::run;
use crate::rig::Rig;
use std::path::Path;

/// Makes certificates of the authority `lab` for `computer`; the arguments that name them.
pub fn certificates(folder: &Path, lab: &str, computer: &str) -> Vec<String> {
    let made = run(folder, &["certificates", lab, computer]).done();
    vec!["--certificates".into(), made.trim().into()]
}

#[test]
fn only_who_has_a_certificate_of_the_lab_takes_part() {
    let mut rig = Rig::new("strangers", "1").with(&[DIRECT, "--set=control.stale_periods=20"]);
    let plain = rig.endpoint.clone();
    rig.endpoint = plain.replace("tcp/", "tls/");
    let ours = certificates(&rig.folder, "lab", "127.0.0.1");
    let theirs = certificates(&rig.folder, "elsewhere", "127.0.0.1");
    rig.hand_link.clone_from(&ours);
    rig.joining.clone_from(&theirs);
    let strangers = rig.others(&[]);
    let mut hand = rig.hand(&[]);
    hand.wait_to_say("waiting for world, sense of finger 0, sense of finger 1");

    // An order is given up when nothing of the hand was heard for five seconds.
    let connect = format!("--connect={}", rig.endpoint);
    let link = [vec![connect.clone()], theirs].concat();
    rig.order_by(&link).refused(&["no hand of rig"]);
    rig.order_by(std::slice::from_ref(&connect))
        .refused(&["--certificates"]);
    assert!(hand.is_running() && !rig.folder.join("run").exists());
    strangers.interrupt();

    rig.joining.clone_from(&ours);
    let others = rig.others(&[]);
    rig.wait_for_record(100_000);
    rig.order_by(&link).refused(&["no hand of rig"]);
    rig.order_by(&[format!("--connect={plain}")])
        .refused(&["no hand of rig"]);
    rig.wait_for_more_record();
    let link = [vec![connect], ours].concat();
    assert_eq!(rig.order_by(&link).status, Some(0));
    hand.wait_to_warn("told to stop", 0);
    let ended = hand.interrupt();
    others.interrupt();
    assert_eq!(ended.stderr.matches("told to stop").count(), 1, "{ended:?}");
}

#[test]
fn nobody_listens_beyond_this_computer_without_certificates() {
    let mut rig = Rig::new("open", "1").with(&[DIRECT]);
    rig.endpoint = rig.endpoint.replace("127.0.0.1", "0.0.0.0");
    let said = rig
        .hand(&[])
        .end()
        .refused(&["--listen tcp/0.0.0.0", "--insecure"]);
    assert!(
        said.contains("anybody on the network could move the hand"),
        "{said}"
    );
}
