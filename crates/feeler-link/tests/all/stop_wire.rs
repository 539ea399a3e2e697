//! Valid and hostile datagrams of the stop server.

use feeler_link::stop_server::wire::{Datagram, MAX_BYTES, Proof, StopAnswer, Verdict, parse};
use proptest::prelude::*;

fn proof() -> impl Strategy<Value = Option<Proof>> {
    let part = |most| prop::collection::vec(any::<u8>(), 1..most);
    let proof = (part(600), part(80)).prop_map(|(certificate, signature)| Proof {
        certificate,
        signature,
    });
    prop::option::of(proof)
}

fn datagram() -> impl Strategy<Value = Datagram> {
    let text = || ".{0,60}";
    let verdict = prop_oneof![
        (any::<u64>(), text())
            .prop_map(|(order, stopped)| { Verdict::Taken(StopAnswer { order, stopped }) }),
        text().prop_map(Verdict::Refused),
    ];
    prop_oneof![
        any::<[u8; 16]>().prop_map(|nonce| Datagram::Hello { nonce }),
        any::<([u8; 16], [u8; 32])>()
            .prop_map(|(nonce, cookie)| Datagram::Challenge { nonce, cookie }),
        (any::<([u8; 16], [u8; 32])>(), text(), text(), proof()).prop_map(
            |((nonce, cookie), rig, from, proof)| Datagram::Stop {
                nonce,
                cookie,
                rig,
                from,
                proof
            }
        ),
        (any::<[u8; 16]>(), verdict, proof()).prop_map(|(nonce, verdict, proof)| {
            Datagram::Answer {
                nonce,
                verdict,
                proof,
            }
        }),
    ]
}

proptest! {
    #[test]
    fn datagrams_round_trip(datagram in datagram()) {
        let bytes = datagram.bytes();
        prop_assert!(bytes.len() <= MAX_BYTES);
        prop_assert_eq!(parse(&bytes), Some(datagram));
    }

    #[test]
    fn truncated_and_extended_datagrams_are_rejected(datagram in datagram(), cut in any::<prop::sample::Index>()) {
        let mut bytes = datagram.bytes();
        prop_assert_eq!(parse(&bytes[..cut.index(bytes.len())]), None);
        bytes.push(0);
        prop_assert_eq!(parse(&bytes), None);
    }

    #[test]
    fn any_bytes_are_parsed_without_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..1500)) {
        // Random bytes hardly ever start with the magic bytes.
        let _ = parse(&bytes);
        for kind in 0..5 {
            let datagram = [b"feelstop\x01", &[kind][..], &bytes].concat();
            // A parsed datagram encodes to the same bytes.
            if let Some(read) = parse(&datagram) {
                prop_assert_eq!(read.bytes(), datagram);
            }
        }
    }

    #[test]
    fn a_changed_byte_changes_the_signed_content(datagram in datagram(), at in any::<prop::sample::Index>()) {
        let mut bytes = datagram.bytes();
        let at = at.index(bytes.len());
        bytes[at] ^= 1;
        let proof = |d: &Datagram| match d {
            Datagram::Stop { proof, .. } | Datagram::Answer { proof, .. } => proof.clone(),
            _ => None,
        };
        if let Some(read) = parse(&bytes) {
            let differs = read.signed() != datagram.signed() || proof(&read) != proof(&datagram);
            prop_assert!(differs);
        }
    }
}

#[test]
fn a_challenge_is_no_longer_than_the_hello() {
    let (nonce, cookie) = ([1; 16], [2; 32]);
    let hello = Datagram::Hello { nonce }.bytes();
    assert!(Datagram::Challenge { nonce, cookie }.bytes().len() <= hello.len());
}
