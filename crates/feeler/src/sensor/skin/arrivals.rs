//! Arrival times of the bytes of a serial stream.

/// Number of stored reads. A frame may arrive in many reads.
const READS: usize = 64;

/// One read operation on the stream.
#[derive(Debug, Clone, Copy, Default)]
struct Read {
    /// Total number of bytes of the stream up to the end of this read.
    end: u64,
    /// Time of the read, s.
    at: f64,
}

/// Estimates the arrival time of each byte of a stream from the times of the reads.
///
/// The last byte of a read is assumed to arrive at the time of the read. Each earlier byte is assumed to arrive one
/// transmission time before the following one, but not before the previous read. The latency of the port delays the
/// estimate; late reads delay it by at most the time between two reads. Does not allocate.
#[derive(Debug, Clone)]
pub struct Arrivals {
    /// Transmission time of a byte, s.
    byte_time: f64,
    /// Latest reads, in a ring buffer.
    reads: [Read; READS],
    /// Number of reads so far.
    count: usize,
}

impl Arrivals {
    /// Creates an estimator for a stream with this transmission time per byte (s). No byte arrives before time 0.
    pub fn new(byte_time: f64) -> Self {
        Self {
            byte_time,
            reads: [Read::default(); READS],
            count: 0,
        }
    }

    /// Adds a read of `bytes` bytes at time `at` (s).
    pub fn read(&mut self, bytes: usize, at: f64) {
        let newest = self.newest();
        self.count += 1;
        self.reads[self.count % READS] = Read {
            end: newest.end + bytes as u64,
            at: at.max(newest.at),
        };
    }

    /// Estimated arrival time (s) of the byte with index `byte`. For bytes read too long ago, the time of the oldest
    /// stored read; for bytes not read yet, the time of the latest read.
    pub fn of(&self, byte: u64) -> f64 {
        let mut later = self.newest();
        for back in 1..READS.min(self.count + 1) {
            let earlier = self.reads[(self.count - back) % READS];
            if byte >= earlier.end {
                let after = later.end.saturating_sub(byte + 1);
                return (later.at - self.byte_time * after as f64).max(earlier.at);
            }
            later = earlier;
        }
        later.at
    }

    fn newest(&self) -> Read {
        self.reads[self.count % READS]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_arrive_one_after_another() {
        let mut arrivals = Arrivals::new(0.001);
        arrivals.read(10, 1.0);
        arrivals.read(5, 1.002);
        arrivals.read(0, 1.5);
        arrivals.read(2, 2.0);
        // Ten bytes take 9 ms from the first to the last.
        assert!((arrivals.of(0) - 0.991).abs() < 1e-12);
        assert_eq!(arrivals.of(9), 1.0);
        // Not before the previous read.
        assert_eq!(arrivals.of(10), 1.0);
        assert!((arrivals.of(13) - 1.001).abs() < 1e-12);
        assert_eq!(arrivals.of(14), 1.002);
        assert!((arrivals.of(15) - 1.999).abs() < 1e-12);
        assert_eq!(arrivals.of(1000), 2.0);
    }

    #[test]
    fn old_reads_are_forgotten() {
        let mut arrivals = Arrivals::new(0.0);
        for read in 1..=1000 {
            arrivals.read(1, f64::from(read));
        }
        assert_eq!(arrivals.of(999), 1000.0);
        assert_eq!(arrivals.of(950), 951.0);
        let oldest = arrivals.of(0);
        assert!((900.0..=1000.0).contains(&oldest), "{oldest}");
    }
}
