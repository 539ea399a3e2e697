//! Checks and decompresses chunks of an MCAP file.

use super::record::{parse, split_record};
use ::mcap::records::{Record, op};
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Maximum size of a chunk in bytes, compressed or not.
pub(crate) const MAX_CHUNK: u64 = 256 << 20;
/// Size in bytes of an uncompressed chunk's header: two times, size, checksum, length of the empty compression name,
/// length.
const CHUNK_HEAD: usize = 8 + 8 + 8 + 4 + 4 + 8;

/// Records of a chunk.
pub(crate) struct Unpacked<'a> {
    /// Bytes of the records.
    pub records: Cow<'a, [u8]>,
    /// Offset of the records in the chunk's body, or `None` if they are compressed.
    pub start: Option<usize>,
}

/// Checks and decompresses the chunk with this body.
///
/// # Errors
/// If the chunk is damaged. Returns a description.
pub(crate) fn unpack(body: &[u8]) -> Result<Unpacked<'_>, String> {
    let Record::Chunk { header, data } = parse(op::CHUNK, body)? else {
        return Err("expected a chunk".into());
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
    // A checksum of 0 means that there is no checksum.
    if expected != 0 && expected != actual {
        return Err(format!(
            "expected a chunk with checksum {expected:08x}, got {actual:08x}"
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

/// Decompresses `data` to `length` bytes. Allocates only as much as is decompressed.
fn decompress(compression: &str, data: &[u8], length: u64) -> Result<Vec<u8>, String> {
    if length > MAX_CHUNK {
        return Err(format!(
            "expected a chunk of at most {MAX_CHUNK} bytes, got one of {length}"
        ));
    }
    let failed = |reason: String| format!("chunk compressed by {compression}: {reason}");
    let mut bytes = Vec::new();
    // One extra byte reveals a chunk that is longer than stated.
    let read = match compression {
        "lz4" => (FrameDecoder::new(data).take(length + 1)).read_to_end(&mut bytes),
        "zstd" => {
            let decoder = StreamingDecoder::new(data).map_err(|e| failed(e.to_string()))?;
            decoder.take(length + 1).read_to_end(&mut bytes)
        }
        other => {
            return Err(format!(
                "expected a chunk uncompressed or compressed by lz4 or zstd, got {other:?}"
            ));
        }
    };
    read.map_err(|e| failed(e.to_string()))?;
    match bytes.len() as u64 {
        actual if actual == length => Ok(bytes),
        actual => Err(failed(format!(
            "expected {length} bytes, got at least {actual}"
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

    /// A metadata record with an empty name and no entries.
    fn record() -> Vec<u8> {
        let mut record = vec![op::METADATA];
        record.extend(8_u64.to_le_bytes());
        record.extend([0; 8]);
        record
    }

    /// Body of a chunk.
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
    fn chunks_are_unpacked_with_each_compression() {
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
    fn chunk_headers_are_not_trusted() {
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
            refused(compression, length + 1, 0, &data, ", got at least");
            refused(compression, length - 1, 0, &data, ", got at least");
            refused(compression, length, 0, &long, ", got at least");
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
                // A chunk whose checksum became 0 is not checked.
                let unchecked = (24..28).contains(&place);
                prop_assert!(unchecked || unpacked.records == records);
            }
        }
    }
}
