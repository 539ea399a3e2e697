//! Chunks of an MCAP file, checked and unpacked.

use super::scan::{parse, split_record};
use ::mcap::records::{Record, op};
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Longest chunk, compressed or not, bytes.
pub(super) const MAX_CHUNK: u64 = 256 << 20;
/// Bytes of an uncompressed chunk before its records: two times, size, checksum, length of the empty compression
/// name, length.
const CHUNK_HEAD: usize = 8 + 8 + 8 + 4 + 4 + 8;

/// The records of a chunk.
pub(super) struct Unpacked<'a> {
    /// Their bytes.
    pub records: Cow<'a, [u8]>,
    /// Where they begin in the chunk's body; `None` if they are compressed there.
    pub start: Option<usize>,
}

/// Unpacks the chunk with this body, unless it is damaged.
///
/// # Errors
/// What was expected and what was found, in words.
pub(super) fn unpack(body: &[u8]) -> Result<Unpacked<'_>, String> {
    let Record::Chunk { header, data } = parse(op::CHUNK, body)? else {
        return Err("a chunk expected".into());
    };
    let unpacked = match header.compression.as_str() {
        "" => {
            let records = body.get(CHUNK_HEAD..CHUNK_HEAD + data.len());
            Unpacked {
                records: records.ok_or("a chunk ends before its records")?.into(),
                start: Some(CHUNK_HEAD),
            }
        }
        compression => Unpacked {
            records: decompress(compression, &data, header.uncompressed_size)?.into(),
            start: None,
        },
    };
    let (expected, actual) = (header.uncompressed_crc, crc32fast::hash(&unpacked.records));
    // No checksum is written as 0.
    if expected != 0 && expected != actual {
        return Err(format!(
            "a chunk with checksum {expected:08x} expected, {actual:08x} found"
        ));
    }
    let mut rest = &unpacked.records[..];
    while !rest.is_empty() {
        let (opcode, body, length) = split_record(rest).ok_or("a chunk ends within a record")?;
        parse(opcode, body)?;
        rest = &rest[length..];
    }
    Ok(unpacked)
}

/// Decompresses `data` to `length` bytes. Makes room only for what comes.
fn decompress(compression: &str, data: &[u8], length: u64) -> Result<Vec<u8>, String> {
    if length > MAX_CHUNK {
        return Err(format!(
            "a chunk of at most {MAX_CHUNK} bytes expected, one of {length} found"
        ));
    }
    let failed = |reason: String| format!("a chunk compressed by {compression}: {reason}");
    let mut bytes = Vec::new();
    // The byte more shows a chunk that is longer than it says.
    let read = match compression {
        "lz4" => (FrameDecoder::new(data).take(length + 1)).read_to_end(&mut bytes),
        "zstd" => {
            let decoder = StreamingDecoder::new(data).map_err(|e| failed(e.to_string()))?;
            decoder.take(length + 1).read_to_end(&mut bytes)
        }
        other => {
            return Err(format!(
                "a chunk uncompressed or compressed by lz4 or zstd expected, {other:?} found"
            ));
        }
    };
    read.map_err(|e| failed(e.to_string()))?;
    match bytes.len() as u64 {
        actual if actual == length => Ok(bytes),
        actual => Err(failed(format!(
            "{length} bytes expected, at least {actual} found"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lz4_flex::frame::FrameEncoder;
    use proptest::prelude::*;
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};
    use std::io::Write;

    /// A record of zeros, with its head: metadata of no name and no entries.
    fn record() -> Vec<u8> {
        let mut record = vec![op::METADATA];
        record.extend(8_u64.to_le_bytes());
        record.extend([0; 8]);
        record
    }

    /// The body of a chunk.
    fn chunk(compression: &str, length: u64, crc: u32, data: &[u8]) -> Vec<u8> {
        let mut body = vec![0; 16];
        body.extend(length.to_le_bytes());
        body.extend(crc.to_le_bytes());
        body.extend((compression.len() as u32).to_le_bytes());
        body.extend(compression.as_bytes());
        body.extend((data.len() as u64).to_le_bytes());
        body.extend(data);
        body
    }

    fn lz4(data: &[u8]) -> Vec<u8> {
        let mut encoder = FrameEncoder::new(Vec::new());
        encoder.write_all(data).expect("memory");
        encoder.finish().expect("a frame")
    }

    fn zstd(data: &[u8]) -> Vec<u8> {
        compress_to_vec(data, CompressionLevel::Fastest)
    }

    #[test]
    fn chunks_are_unpacked_whatever_their_compression() {
        let records = record().repeat(100);
        let (length, crc) = (records.len() as u64, crc32fast::hash(&records));
        for (compression, data) in [
            ("", records.clone()),
            ("lz4", lz4(&records)),
            ("zstd", zstd(&records)),
        ] {
            for crc in [0, crc] {
                let body = chunk(compression, length, crc, &data);
                let unpacked = unpack(&body).expect(compression);
                assert_eq!(unpacked.records, records, "{compression}");
                assert_eq!(unpacked.start.is_none(), !compression.is_empty());
            }
        }
    }

    #[test]
    fn what_a_chunk_says_of_itself_is_not_taken_at_its_word() {
        let records = record().repeat(100);
        let length = records.len() as u64;
        let zeros = vec![0; 1 << 20];
        let refused = |compression, length, crc, data: &[u8], words: &str| {
            let body = chunk(compression, length, crc, data);
            let reason = unpack(&body).map(|_| ()).expect_err(words);
            assert!(reason.contains(words), "{reason}");
        };
        for (compression, data, long) in [
            ("lz4", lz4(&records), lz4(&zeros)),
            ("zstd", zstd(&records), zstd(&zeros)),
        ] {
            refused(compression, length + 1, 0, &data, "bytes expected");
            refused(compression, length - 1, 0, &data, "bytes expected");
            refused(compression, length, 0, &long, "bytes expected");
            refused(compression, u64::MAX, 0, &data, "at most");
            refused(compression, length, 1, &data, "checksum");
            refused(compression, length, 0, &data[..data.len() / 2], compression);
            refused(compression, length, 0, b"neither of them", compression);
        }
        refused("brotli", length, 0, &records, "lz4 or zstd");
    }

    proptest! {
        #[test]
        fn a_flipped_bit_gives_no_other_records(place in 0_usize..200, bit in 0..8_u32, lz4_or_zstd in 0..2) {
            let records = record().repeat(100);
            let (length, crc) = (records.len() as u64, crc32fast::hash(&records));
            let mut body = match lz4_or_zstd {
                0 => chunk("lz4", length, crc, &lz4(&records)),
                _ => chunk("zstd", length, crc, &zstd(&records)),
            };
            let place = place % body.len();
            body[place] ^= 1 << bit;
            if let Ok(unpacked) = unpack(&body) {
                // Without its checksum a chunk is not checked.
                let unchecked = (24..28).contains(&place);
                prop_assert!(unchecked || unpacked.records == records);
            }
        }
    }
}
