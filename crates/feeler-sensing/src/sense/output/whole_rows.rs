//! Buffers output so that only complete rows are written, even if the program is killed.

use std::io::{self, Write};

/// Maximum number of buffered bytes before a write.
const BUFFER: usize = 1 << 16;

/// Buffers output and writes complete rows only. A row ends with a line feed.
///
/// A flush writes all complete rows; an incomplete row remains in the buffer.
pub struct WholeRows<W> {
    writer: W,
    waiting: Vec<u8>,
    /// Length of the buffered data up to the end of the last complete row.
    whole: usize,
}

impl<W: Write> WholeRows<W> {
    /// Creates a buffer in front of `writer`.
    pub fn new(writer: W) -> Self {
        Self {
            writer,
            waiting: Vec::with_capacity(BUFFER),
            whole: 0,
        }
    }

    fn hand_on(&mut self) -> io::Result<()> {
        let written = self.writer.write_all(&self.waiting[..self.whole]);
        // Also after an error, so that nothing is written twice.
        self.waiting.drain(..self.whole);
        self.whole = 0;
        written
    }
}

impl<W: Write> Write for WholeRows<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(end) = bytes.iter().rposition(|&byte| byte == b'\n') {
            self.whole = self.waiting.len() + end + 1;
        }
        self.waiting.extend_from_slice(bytes);
        if self.waiting.len() >= BUFFER {
            self.hand_on()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.hand_on()?;
        self.writer.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::sync::{Arc, Mutex};

    /// Data passed to the operating system, write by write.
    #[derive(Clone, Default)]
    struct System(Arc<Mutex<Vec<Vec<u8>>>>);

    impl Write for System {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().push(bytes.to_vec());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    proptest! {
        /// Holds for any split of rows into writes and any flushes in between.
        #[test]
        fn the_system_is_handed_whole_rows(
            pieces in proptest::collection::vec(("[a-z\n]{0,40}", 1..600usize, any::<bool>()), 0..60)
        ) {
            let system = System::default();
            let mut rows = WholeRows::new(system.clone());
            let mut all = Vec::new();
            for (piece, times, flush) in pieces {
                for _ in 0..times {
                    rows.write_all(piece.as_bytes()).unwrap();
                    all.extend_from_slice(piece.as_bytes());
                }
                if flush {
                    rows.flush().unwrap();
                    let handed: usize = system.0.lock().unwrap().iter().map(Vec::len).sum();
                    let whole = all.iter().rposition(|&b| b == b'\n').map_or(0, |end| end + 1);
                    prop_assert_eq!(handed, whole);
                }
            }
            let handed = system.0.lock().unwrap();
            for write in handed.iter() {
                prop_assert!(write.last().is_none_or(|&byte| byte == b'\n'));
            }
            prop_assert!(all.starts_with(&handed.concat()));
        }
    }
}
