//! Wire format of the stop server's datagrams.
//!
//! All datagrams start with `feelstop`, version and kind (one byte each) and the caller's nonce (16 bytes). Texts and
//! byte blocks are encoded as their length (2 bytes, little-endian) and their bytes. Trailing bytes are an error.

/// First bytes of each datagram.
const MAGIC: [u8; 8] = *b"feelstop";
const VERSION: u8 = 1;

/// Maximum size of a datagram in bytes, small enough to avoid fragmentation.
pub const MAX_BYTES: usize = 1400;

/// Maximum length of a text in bytes.
pub const MAX_TEXT: usize = 256;

/// Size of a [`Datagram::Hello`] in bytes. Larger than a challenge, to prevent traffic amplification.
const HELLO_BYTES: usize = 64;

/// Random number drawn by the caller, contained in all datagrams of a call.
pub type Nonce = [u8; 16];

/// HMAC of the caller's address and nonce under the stop server's secret.
pub type Cookie = [u8; 32];

/// Certificate, and a signature by its key.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// X.509 certificate in DER.
    pub certificate: Vec<u8>,
    /// ECDSA signature on P-256 with SHA-256, in ASN.1.
    pub signature: Vec<u8>,
}

/// State of the hand after a stop order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StopAnswer {
    /// Number of the stop.
    pub order: u64,
    /// Reason of the stop; empty if the hand has not stopped yet.
    pub stopped: String,
}

/// Result of a call.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The hand accepted the order.
    Taken(StopAnswer),
    /// The hand refused the order; contains the reason.
    Refused(String),
}

/// Datagram between a caller and the stop server.
#[derive(Debug, Clone, PartialEq)]
pub enum Datagram {
    /// Request of the caller for a challenge.
    Hello {
        /// Nonce of the call.
        nonce: Nonce,
    },
    /// Challenge to the caller, with which it proves its address.
    Challenge {
        /// Nonce of the call.
        nonce: Nonce,
        /// Cookie that the caller must return.
        cookie: Cookie,
    },
    /// Order to stop the hand.
    Stop {
        /// Nonce of the call.
        nonce: Nonce,
        /// Cookie from the challenge.
        cookie: Cookie,
        /// Name of the rig.
        rig: String,
        /// Name of the sender.
        from: String,
        /// Proof of the caller's right, over [`Datagram::signed`].
        proof: Option<Proof>,
    },
    /// Answer to the order.
    Answer {
        /// Nonce of the call.
        nonce: Nonce,
        /// Result of the call.
        verdict: Verdict,
        /// Proof that the answer is from the hand: a signature of [`Datagram::signed`].
        proof: Option<Proof>,
    },
}

impl Datagram {
    /// Encodes the datagram.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.unproven();
        match self {
            Self::Stop { proof, .. } | Self::Answer { proof, .. } => {
                let empty: &[u8] = &[];
                let parts = proof.as_ref().map(|p| [&p.certificate[..], &p.signature]);
                for part in parts.unwrap_or([empty; 2]) {
                    put(&mut bytes, part);
                }
            }
            Self::Hello { .. } => bytes.resize(HELLO_BYTES, 0),
            Self::Challenge { .. } => {}
        }
        bytes
    }

    /// Returns the bytes that a proof signs: everything but the proof, with a prefix that no TLS message has, because
    /// TLS uses the same keys.
    pub fn signed(&self) -> Vec<u8> {
        [b"feeler stop server\0", &self.unproven()[..]].concat()
    }

    fn unproven(&self) -> Vec<u8> {
        let (kind, nonce) = match self {
            Self::Hello { nonce } => (0, nonce),
            Self::Challenge { nonce, .. } => (1, nonce),
            Self::Stop { nonce, .. } => (2, nonce),
            Self::Answer { nonce, .. } => (3, nonce),
        };
        let mut bytes = [&MAGIC[..], &[VERSION, kind], nonce].concat();
        match self {
            Self::Hello { .. } => {}
            Self::Challenge { cookie, .. } => bytes.extend(cookie),
            Self::Stop {
                cookie, rig, from, ..
            } => {
                bytes.extend(cookie);
                put(&mut bytes, rig.as_bytes());
                put(&mut bytes, from.as_bytes());
            }
            Self::Answer { verdict, .. } => {
                let (is_taken, order, text) = match verdict {
                    Verdict::Taken(answer) => (1, answer.order, &answer.stopped),
                    Verdict::Refused(why) => (0, 0, why),
                };
                bytes.push(is_taken);
                bytes.extend(order.to_le_bytes());
                put(&mut bytes, text.as_bytes());
            }
        }
        bytes
    }
}

/// Parses a datagram. Returns `None` if `bytes` is not a valid one.
pub fn parse(bytes: &[u8]) -> Option<Datagram> {
    if bytes.len() > MAX_BYTES {
        return None;
    }
    let rest = &mut bytes.strip_prefix(&MAGIC)?.strip_prefix(&[VERSION])?;
    let [kind] = take(rest)?;
    let nonce = take(rest)?;
    let datagram = match kind {
        0 => {
            let padding = std::mem::take(rest);
            let sound = bytes.len() == HELLO_BYTES && padding.iter().all(|b| *b == 0);
            sound.then_some(Datagram::Hello { nonce })?
        }
        1 => Datagram::Challenge {
            nonce,
            cookie: take(rest)?,
        },
        2 => Datagram::Stop {
            nonce,
            cookie: take(rest)?,
            rig: take_text(rest)?,
            from: take_text(rest)?,
            proof: take_proof(rest)?,
        },
        3 => Datagram::Answer {
            nonce,
            verdict: take_verdict(rest)?,
            proof: take_proof(rest)?,
        },
        _ => return None,
    };
    rest.is_empty().then_some(datagram)
}

/// Returns the [`crate::messages::message::StopMessage::id`] of the order in a call with this nonce.
pub fn id_of(nonce: &Nonce) -> u64 {
    let (id, _) = nonce.split_first_chunk().unwrap_or((&[0; 8], &[]));
    u64::from_le_bytes(*id)
}

fn put(bytes: &mut Vec<u8>, part: &[u8]) {
    // A longer part exceeds the size of a datagram and is never sent.
    let length = u16::try_from(part.len()).unwrap_or(u16::MAX);
    bytes.extend(length.to_le_bytes());
    bytes.extend(part);
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, others) = rest.split_first_chunk()?;
    *rest = others;
    Some(*first)
}

fn take_part<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let length = usize::from(u16::from_le_bytes(take(rest)?));
    let (part, others) = rest.split_at_checked(length)?;
    *rest = others;
    Some(part)
}

fn take_text(rest: &mut &[u8]) -> Option<String> {
    let part = take_part(rest).filter(|part| part.len() <= MAX_TEXT)?;
    String::from_utf8(part.to_vec()).ok()
}

fn take_verdict(rest: &mut &[u8]) -> Option<Verdict> {
    let [is_taken] = take(rest)?;
    let order = u64::from_le_bytes(take(rest)?);
    let stopped = take_text(rest)?;
    match (is_taken, order) {
        (1, _) => Some(Verdict::Taken(StopAnswer { order, stopped })),
        (0, 0) => Some(Verdict::Refused(stopped)),
        _ => None,
    }
}

/// Parses an optional proof. Certificate and signature must both be present or both be missing.
fn take_proof(rest: &mut &[u8]) -> Option<Option<Proof>> {
    let [certificate, signature] = [take_part(rest)?, take_part(rest)?].map(<[u8]>::to_vec);
    match (certificate.is_empty(), signature.is_empty()) {
        (true, true) => Some(None),
        (false, false) => Some(Some(Proof {
            certificate,
            signature,
        })),
        _ => None,
    }
}
