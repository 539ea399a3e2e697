//! Detects truncated JPEG files, whose missing part decoders fill in without an error.

const START_OF_IMAGE: u8 = 0xD8;
const END_OF_IMAGE: u8 = 0xD9;
const START_OF_SCAN: u8 = 0xDA;
const RESTARTS: std::ops::RangeInclusive<u8> = 0xD0..=0xD7;

/// Returns whether `bytes` start like a JPEG file.
pub fn is_jpeg(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0xFF, START_OF_IMAGE])
}

/// Returns whether the file contains the end marker of its image. Markers within a segment, such as those of an
/// embedded thumbnail, do not count.
pub fn is_whole(bytes: &[u8]) -> bool {
    let mut rest = bytes;
    while let Some((marker, after)) = next_marker(rest) {
        rest = match marker {
            END_OF_IMAGE => return true,
            START_OF_IMAGE | 0x01 => after,
            marker if RESTARTS.contains(&marker) => after,
            _ => match segment(after) {
                Some(after) if marker == START_OF_SCAN => &after[scan_length(after)..],
                Some(after) => after,
                None => return false,
            },
        };
    }
    false
}

/// Returns the next marker and the bytes after it.
fn next_marker(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let start = bytes.iter().position(|&byte| byte == 0xFF)?;
    let code = start + bytes[start..].iter().position(|&byte| byte != 0xFF)?;
    Some((bytes[code], &bytes[code + 1..]))
}

/// Returns the bytes after a segment, which starts with its length (including the length field).
fn segment(bytes: &[u8]) -> Option<&[u8]> {
    let length = u16::from_be_bytes(*bytes.first_chunk::<2>()?);
    bytes.get(usize::from(length.max(2))..)
}

/// Returns the length of the entropy-coded data up to the next marker. Within the data, 0xFF is followed by 0 or a
/// restart marker.
fn scan_length(bytes: &[u8]) -> usize {
    let ends = |pair: &[u8]| pair[0] == 0xFF && pair[1] != 0 && !RESTARTS.contains(&pair[1]);
    let marker = bytes.windows(2).position(ends);
    marker.unwrap_or(bytes.len())
}
