//! The datagrams of the stop door, byte by byte.
//!
//! All begin with `feelstop`, the version, the kind (one byte each) and the caller's number (16 bytes). A text or a
//! block of bytes is its length (2 bytes, little-endian) and its bytes. Nothing may follow.

/// How a datagram begins.
const MAGIC: [u8; 8] = *b"feelstop";
const VERSION: u8 = 1;

/// Most bytes of a datagram: networks carry it in one piece.
pub const MOST_BYTES: usize = 1400;

/// Most bytes of a text.
pub const MOST_TEXT: usize = 256;

/// Bytes of a [`Datagram::Hello`]: more than a challenge has, so that nobody gets more out of the door than he puts in.
const HELLO_BYTES: usize = 64;

/// A number that a caller draws, which all datagrams of its call have.
pub type Nonce = [u8; 16];

/// What the door makes of a caller's address and number, and nobody else can.
pub type Cookie = [u8; 32];

/// A certificate, and a signature by its key.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// X.509, in DER.
    pub certificate: Vec<u8>,
    /// ECDSA on P-256 with SHA-256, in ASN.1.
    pub signature: Vec<u8>,
}

/// What the hand is about after a stop.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StopAnswer {
    /// Number of the order.
    pub order: u64,
    /// Why the hand is stopped; empty if it is not yet.
    pub stopped: String,
}

/// What became of a call.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The hand has the order.
    Taken(StopAnswer),
    /// It has not, and why.
    Refused(String),
}

/// What door and callers send.
#[derive(Debug, Clone, PartialEq)]
pub enum Datagram {
    /// The caller asks for a challenge.
    Hello {
        /// The call's.
        nonce: Nonce,
    },
    /// The door's to the caller: where it arrives, the caller is.
    Challenge {
        /// The call's.
        nonce: Nonce,
        /// To be sent back.
        cookie: Cookie,
    },
    /// The hand is to stop.
    Stop {
        /// The call's.
        nonce: Nonce,
        /// As in the challenge.
        cookie: Cookie,
        /// The hand of which rig.
        rig: String,
        /// Who says so.
        from: String,
        /// That the caller may; over [`Datagram::signed`].
        proof: Option<Proof>,
    },
    /// The door's answer.
    Answer {
        /// The call's.
        nonce: Nonce,
        /// What became of it.
        verdict: Verdict,
        /// That it is the hand's; over [`Datagram::signed`].
        proof: Option<Proof>,
    },
}

impl Datagram {
    /// What it is on the wire.
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

    /// What a proof of it signs: all but the proof. It begins as no message of TLS does, whose keys are the same.
    pub fn signed(&self) -> Vec<u8> {
        [b"feeler stop door\0", &self.unproven()[..]].concat()
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

/// The datagram that these bytes are, if they are one.
pub fn parse(bytes: &[u8]) -> Option<Datagram> {
    if bytes.len() > MOST_BYTES {
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

/// The order that a call of this number is: [`super::message::StopMessage::id`].
pub fn id_of(nonce: &Nonce) -> u64 {
    let (id, _) = nonce.split_first_chunk().unwrap_or((&[0; 8], &[]));
    u64::from_le_bytes(*id)
}

fn put(bytes: &mut Vec<u8>, part: &[u8]) {
    // What is longer than that is longer than a datagram, and is not sent.
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
    let part = take_part(rest).filter(|part| part.len() <= MOST_TEXT)?;
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

/// Both parts of a proof, or neither.
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
