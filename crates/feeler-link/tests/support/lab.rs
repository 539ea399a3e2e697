//! Labs with certificates for tests, and links that use them.

use super::ports::unused_endpoint;
use feeler_link::security::{Authority, Right, Validity};
use feeler_link::transport::{Link, LinkConfig, Network, Outlet, Topic};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// Name of the computer in all tests.
pub const HERE: &str = "127.0.0.1";

/// Creates the lab `name` with one certificate for each of `rights`, and returns its folder.
pub fn lab(name: &str, rights: &[&str]) -> PathBuf {
    let lab = std::env::temp_dir().join(format!("feeler-{name}-{}", std::process::id()));
    // Left over from a process with the same id.
    let _ = std::fs::remove_dir_all(&lab);
    let mut authority = Authority::open_or_make(&lab).expect("an authority");
    let rights: Vec<Right> = rights.iter().map(|r| r.parse().expect("a right")).collect();
    authority
        .certify(HERE, &rights, Validity::days(1))
        .expect("certificates");
    lab
}

/// Folder of the certificate for `right`.
pub fn of(lab: &Path, right: &str) -> PathBuf {
    lab.join(HERE).join(right)
}

/// Opens a link that listens with the certificate in `folder`, and returns its endpoint.
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

/// Opens a link to `endpoint` with the certificate in `folder`.
pub fn connecting(folder: &Path, endpoint: &str) -> Link {
    let config = LinkConfig {
        rig: "bench".into(),
        connect: vec![endpoint.into()],
        certificates: Some(folder.into()),
        ..LinkConfig::default()
    };
    Link::open(&config).expect("a link")
}

/// Subscribes `link` to `topics` and returns the topics of received messages.
pub fn heard(link: &Link, topics: &[Topic]) -> Receiver<Topic> {
    let (sender, receiver) = channel();
    for topic in topics {
        let sender = sender.clone();
        let note = move |topic: Topic, _: &[u8]| {
            // The receiver is gone once the test is over.
            let _ = sender.send(topic);
        };
        link.listen(*topic, Arc::new(note)).expect("a subscription");
    }
    receiver
}

/// Lets each of `talkers` send on its topics repeatedly, until a message on `last` has arrived in ten rounds. Returns
/// the topics of all received messages.
pub fn until_heard(
    talkers: &[(&Link, &[Topic])],
    receiver: &Receiver<Topic>,
    last: Topic,
) -> Vec<Topic> {
    // Ten rounds with pauses give other programs the time to connect.
    let (mut received, mut times) = (Vec::new(), 0);
    for _ in 0..6000 {
        for (link, topics) in talkers {
            for topic in *topics {
                link.send(*topic, vec![1]).expect("to send");
            }
        }
        std::thread::sleep(Duration::from_millis(100));
        let new: Vec<Topic> = receiver.try_iter().collect();
        times += usize::from(new.contains(&last));
        received.extend(new);
        if times >= 10 {
            return received;
        }
    }
    panic!("no message on {last}, only {received:?}");
}
