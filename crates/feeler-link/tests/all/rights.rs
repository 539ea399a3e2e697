//! Messages that certificates permit, over real connections.
#![cfg(feature = "zenoh")]

use crate::lab::{HERE, connecting, heard, lab, listening, of, until_heard};
use feeler_link::security::{
    Authority, OwnCertificate, OwnCertificateError, Right, Role, Validity, access_control,
};
use feeler_link::transport::{LinkConfig, Topic};
use std::fs;
use std::path::Path;
use std::time::Instant;

const ALL: [Topic; 6] = [
    Topic::State,
    Topic::Tactile(1),
    Topic::Command,
    Topic::Resume,
    Topic::Stop,
    Topic::Tactile(0),
];

#[test]
fn a_sensor_may_send_only_the_forces_of_its_finger() {
    let lab = lab("sense", &["hand", "sense-0", "order"]);
    let (hand, endpoint) = listening(&of(&lab, "hand"));
    let at_hand = heard(&hand, &ALL);
    let sense = connecting(&of(&lab, "sense-0"), &endpoint);
    let got = until_heard(&[(&sense, &ALL)], &at_hand, Topic::Tactile(0));
    assert!(got.iter().all(|t| *t == Topic::Tactile(0)), "{got:?}");

    // The same messages arrive if sent with the required rights.
    let order = connecting(&of(&lab, "order"), &endpoint);
    let got = until_heard(&[(&order, &ALL)], &at_hand, Topic::Stop);
    assert!(got.contains(&Topic::Resume), "{got:?}");
    let its_own = |t: &Topic| matches!(t, Topic::Stop | Topic::Resume);
    assert!(got.iter().all(its_own), "{got:?}");
}

#[test]
fn a_sensor_may_receive_only_data_of_its_finger() {
    let lab = lab("reads", &["hand", "sense-0", "watch"]);
    let (hand, endpoint) = listening(&of(&lab, "hand"));
    let sense = connecting(&of(&lab, "sense-0"), &endpoint);
    let watch = connecting(&of(&lab, "watch"), &endpoint);
    let said = [Topic::Command, Topic::Picture(1), Topic::Mode];
    let [at_sense, at_watch] = [&sense, &watch].map(|link| heard(link, &said));
    let got = until_heard(&[(&hand, &said)], &at_sense, Topic::Mode);
    assert!(got.iter().all(|t| *t == Topic::Mode), "{got:?}");
    let got = until_heard(&[(&hand, &said)], &at_watch, Topic::Mode);
    assert!(said.iter().all(|topic| got.contains(topic)), "{got:?}");
}

#[test]
fn a_stop_certificate_cannot_resume() {
    let lab = lab("button", &["hand", "stop"]);
    let (hand, endpoint) = listening(&of(&lab, "hand"));
    let at_hand = heard(&hand, &ALL);
    let button = connecting(&of(&lab, "stop"), &endpoint);
    let got = until_heard(&[(&button, &ALL)], &at_hand, Topic::Stop);
    assert!(got.iter().all(|t| *t == Topic::Stop), "{got:?}");
}

#[test]
fn foreign_expired_and_withdrawn_certificates_are_rejected() {
    let lab = lab("refused", &["hand", "sense-0", "sense-1"]);
    let strangers = crate::lab::lab("strangers", &["sense-1"]);
    // A certificate of another lab, whose holder trusts this lab's authority and so accepts the hand.
    fs::copy(lab.join("ca.pem"), of(&strangers, "sense-1").join("ca.pem")).unwrap();
    let mut authority = Authority::open(&lab).unwrap();
    authority
        .certify("old", &[Right::Sense(1)], Validity::that_ended(1))
        .unwrap();
    authority.withdraw(HERE, &[Right::Sense(1)]).unwrap();

    let (hand, endpoint) = listening(&of(&lab, "hand"));
    let at_hand = heard(&hand, &ALL);
    let stranger = connecting(&of(&strangers, "sense-1"), &endpoint);
    let expired = connecting(&lab.join("old/sense-1"), &endpoint);
    let withdrawn = connecting(&of(&lab, "sense-1"), &endpoint);
    let sense = connecting(&of(&lab, "sense-0"), &endpoint);
    let refused = [Topic::Tactile(1)];
    let talkers: [(_, &[Topic]); 4] = [
        (&stranger, &refused),
        (&expired, &refused),
        (&withdrawn, &refused),
        (&sense, &[Topic::Tactile(0)]),
    ];
    let got = until_heard(&talkers, &at_hand, Topic::Tactile(0));
    assert!(got.iter().all(|t| *t == Topic::Tactile(0)), "{got:?}");
    drop(withdrawn);

    // A renewed certificate for the same right is accepted.
    authority
        .renew(HERE, &[Right::Sense(1)], Validity::days(1))
        .unwrap();
    let renewed = connecting(&of(&lab, "sense-1"), &endpoint);
    let got = until_heard(&[(&renewed, &refused)], &at_hand, Topic::Tactile(1));
    assert!(got.contains(&Topic::Tactile(1)));
}

#[test]
fn programs_connect_only_to_a_hand() {
    let lab = lab("false-hand", &["hand", "sense-0", "watch"]);
    let mut authority = Authority::open(&lab).unwrap();
    authority
        .certify("stolen", &[Right::Hand], Validity::days(1))
        .unwrap();
    // A program without the list of withdrawn certificates.
    let untold = lab.join("untold/watch");
    fs::create_dir_all(&untold).unwrap();
    for file in ["ca.pem", "cert.pem", "key.pem"] {
        fs::copy(of(&lab, "watch").join(file), untold.join(file)).unwrap();
    }
    authority.withdraw("stolen", &[Right::Hand]).unwrap();

    let (sense, false_endpoint) = listening(&of(&lab, "sense-0"));
    let (stolen, stolen_endpoint) = listening(&lab.join("stolen/hand"));
    let said: &[Topic] = &[Topic::Mode, Topic::Tactile(1)];
    let at_false = connecting(&of(&lab, "watch"), &false_endpoint);
    let at_stolen = connecting(&of(&lab, "watch"), &stolen_endpoint);
    let untold = connecting(&untold, &stolen_endpoint);
    let refusing = [heard(&at_false, said), heard(&at_stolen, said)];
    let talkers = [(&sense, said), (&stolen, said)];
    until_heard(&talkers, &heard(&untold, said), Topic::Mode);
    for receiver in refusing {
        let got: Vec<Topic> = receiver.try_iter().collect();
        assert!(got.is_empty(), "{got:?}");
    }
}

#[test]
fn errors_of_a_programs_own_certificate_are_reported() {
    let lab = lab("own", &["hand", "sense-0", "watch"]);
    let mut authority = Authority::open(&lab).unwrap();
    let read = |folder: &Path, right| OwnCertificate::read(folder, &[right]);
    let fine = read(&of(&lab, "hand"), Right::Hand).unwrap();
    assert_eq!(fine.name.to_string(), "hand.1");
    // The certificate is valid for one day, so a warning is due.
    let warning = fine.warning().unwrap();
    assert!(warning.contains("hand.1 expires on"), "{warning}");
    let other = read(&of(&lab, "sense-0"), Right::Sense(1)).unwrap_err();
    assert!(
        matches!(other, OwnCertificateError::Right { .. }),
        "{other}"
    );

    authority
        .certify("b", &[Right::Rig, Right::Watch], Validity::that_ended(2))
        .unwrap();
    let expired = read(&lab.join("b/rig"), Right::Rig).unwrap_err();
    assert!(
        matches!(expired, OwnCertificateError::Invalid { .. }),
        "{expired}"
    );
    authority
        .renew("b", &[Right::Rig], Validity::days(365))
        .unwrap();
    let renewed = read(&lab.join("b/rig"), Right::Rig).unwrap();
    assert_eq!((renewed.name.serial, renewed.warning()), (2, None));
    authority.withdraw("b", &[Right::Rig]).unwrap();
    let withdrawn = read(&lab.join("b/rig"), Right::Rig).unwrap_err();
    assert!(
        matches!(withdrawn, OwnCertificateError::Withdrawn { .. }),
        "{withdrawn}"
    );

    let listed = authority.list().unwrap();
    let of_b: Vec<_> = listed.iter().filter(|l| l.entry.computer == "b").collect();
    let state = |l: &&feeler_link::security::Listed| (l.withdrawn, l.expired, l.replaced);
    let states: Vec<_> = of_b.iter().map(state).collect();
    let expected = [
        (true, true, true),
        (false, true, false),
        (true, false, false),
    ];
    assert_eq!(states, expected);
}

#[cfg(unix)]
#[test]
fn keys_are_readable_by_their_owner_only() {
    use std::os::unix::fs::PermissionsExt;
    let lab = lab("keys", &["hand", "stop"]);
    let mut authority = Authority::open(&lab).unwrap();
    authority
        .renew(HERE, &[Right::Stop], Validity::days(1))
        .unwrap();
    let keys = ["hand", "stop"].map(|right| of(&lab, right).join("key.pem"));
    for key in keys.into_iter().chain([lab.join("ca-key.pem")]) {
        let mode = fs::metadata(&key).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600, "{}", key.display());
    }
}

#[test]
#[ignore = "a measurement"]
fn measure_the_duration_of_access_rules() {
    let lab = lab("time", &["hand", "watch"]);
    let config = |right: &str| LinkConfig {
        rig: "bench".into(),
        listen: vec!["tls/127.0.0.1:1".into()],
        certificates: Some(of(&lab, right)),
        ..LinkConfig::default()
    };
    let start = Instant::now();
    let rules = access_control(&config("hand"), Role::Hand)
        .unwrap()
        .unwrap();
    let made = start.elapsed();
    let bytes = rules.to_string().len();
    let start = Instant::now();
    let (hand, endpoint) = listening(&of(&lab, "hand"));
    let opened = start.elapsed();
    let at_hand = heard(&hand, &[Topic::Tactile(0)]);
    let start = Instant::now();
    let watch = connecting(&of(&lab, "watch"), &endpoint);
    let connected = start.elapsed();
    drop((watch, at_hand));
    println!("{bytes} bytes of rules in {made:?}, hand open in {opened:?}, watch in {connected:?}");
}
