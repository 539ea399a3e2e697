//! Digest of a recording: the content that determines it.

use feeler_record::reading::Digester;

/// Digest of one block and messages (topic, log time in ns, bytes).
fn digest(block: &[u8], messages: &[(&str, u64, &[u8])]) -> String {
    let mut digester = Digester::default();
    digester.block(block);
    for (topic, time, bytes) in messages {
        digester.message(topic, *time, bytes);
    }
    digester.finish().to_string()
}

const TIME: u64 = 1_500_000_000;

#[test]
fn a_digest_is_the_sha_256_of_lengths_and_content() {
    // In Python: block = lambda b: struct.pack('<Q', len(b)) + b;
    // message = lambda t, n, b: block(t) + struct.pack('<Q', n) + block(b); hashlib.sha256(block(b'facts')
    // + message(b'/cap', 1500000000, b'\x01\x02') + message(b'/task', 1510000000, b'')).hexdigest()
    let messages: [(&str, u64, &[u8]); 2] =
        [("/cap", TIME, &[1, 2]), ("/task", TIME + 10_000_000, &[])];
    assert_eq!(
        digest(b"facts", &messages),
        "0fb58a41e9914a2df1b4c8e5272c35df478fcf63f2cd3ef2d9836f99206958b9"
    );
}

#[test]
fn any_difference_changes_the_digest() {
    let cap: (&str, u64, &[u8]) = ("/cap", TIME, &[1, 2]);
    let task: (&str, u64, &[u8]) = ("/task", TIME, &[3]);
    let same = digest(b"facts", &[cap, task]);
    let others = [
        ("another block", digest(b"fact", &[cap, task])),
        ("another order", digest(b"facts", &[task, cap])),
        ("a message less", digest(b"facts", &[cap])),
        (
            "another time",
            digest(b"facts", &[("/cap", TIME + 1, &[1, 2]), task]),
        ),
        (
            "another topic",
            digest(b"facts", &[("/cup", TIME, &[1, 2]), task]),
        ),
        (
            "other bytes",
            digest(b"facts", &[("/cap", TIME, &[1, 3]), task]),
        ),
        (
            "a byte less",
            digest(b"facts", &[("/cap", TIME, &[1]), task]),
        ),
    ];
    assert_eq!(digest(b"facts", &[cap, task]), same);
    for (what, other) in others {
        assert_ne!(other, same, "{what}");
    }
}
