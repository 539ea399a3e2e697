//! A lab of certificates for tests, and links by them.

use super::ports::unused_endpoint;
use feeler_link::security::Authority;
use feeler_link::security::Right;
use feeler_link::security::Validity;
use feeler_link::transport::Link;
use feeler_link::transport::LinkConfig;
use feeler_link::transport::Network;
use feeler_link::transport::Outlet;
use feeler_link::transport::Topic;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// The computer of all tests.
pub const HERE: &str = "127.0.0.1";

/// A new lab called `name` with certificates of `rights`; its folder.
pub fn lab(name: &str, rights: &[&str]) -> PathBuf {
    let lab = std::env::temp_dir().join(format!("feeler-{name}-{}", std::process::id()));
    // Of a process that had the same number.
    let _ = std::fs::remove_dir_all(&lab);
    let mut authority = Authority::open_or_make(&lab).expect("an authority");
    let rights: Vec<Right> = rights.iter().map(|r| r.parse().expect("a right")).collect();
    authority
        .certify(HERE, &rights, Validity::days(1))
        .expect("certificates");
    lab
}

/// Folder of the certificate that gives `right`.
pub fn of(lab: &Path, right: &str) -> PathBuf {
    lab.join(HERE).join(right)
}

/// A program that listens with the certificate in `folder`, and its endpoint.
pub fn listening(folder: &Path) -> (Link, String) {
    let endpoint = unused_endpoint().replace("tcp", "tls");
    let config = LinkConfig {
        rig: "bench".into(),
        is_hand: true,
        listen: vec![endpoint.clone()],
        certificates: Some(folder.into()),
        ..LinkConfig::default()
    };
    (Link::open(&config).expect("a link"), endpoint)
}

/// A program that connects to `endpoint` with the certificate in `folder`.
pub fn connecting(folder: &Path, endpoint: &str) -> Link {
    let config = LinkConfig {
        rig: "bench".into(),
        connect: vec![endpoint.into()],
        certificates: Some(folder.into()),
        ..LinkConfig::default()
    };
    Link::open(&config).expect("a link")
}

/// What `link` hears of `topics` from now on.
pub fn heard(link: &Link, topics: &[Topic]) -> Receiver<Topic> {
    let (sender, receiver) = channel();
    for topic in topics {
        let sender = sender.clone();
        let note = move |topic: Topic, _: &[u8]| {
            // Nobody hears it once the test is over.
            let _ = sender.send(topic);
        };
        link.listen(*topic, Arc::new(note)).expect("to hear");
    }
    receiver
}

/// Lets each of `talkers` say its topics, one after the other, again and again until `last` has been heard often; what
/// was heard until then.
pub fn until_heard(
    talkers: &[(&Link, &[Topic])],
    receiver: &Receiver<Topic>,
    last: Topic,
) -> Vec<Topic> {
    // Ten times, with a pause each time: another program has had the time to connect, too.
    let (mut heard, mut times) = (Vec::new(), 0);
    for _ in 0..6000 {
        for (link, topics) in talkers {
            for topic in *topics {
                link.send(*topic, vec![1]).expect("to send");
            }
        }
        std::thread::sleep(Duration::from_millis(100));
        let new: Vec<Topic> = receiver.try_iter().collect();
        times += usize::from(new.contains(&last));
        heard.extend(new);
        if times >= 10 {
            return heard;
        }
    }
    panic!("{last} is not heard, only {heard:?}");
}
