//! Reading of all servos in a control period.

use super::{Bus, BusError};
use crate::packet::instruction::{FAST_SYNC_READ, READ, SYNC_READ};
use crate::packet::{BROADCAST, Decoder, complete_blocks, fast_blocks, fast_status_length};

impl Bus {
    /// Reads the same `part` (address, length) of the servos `ids`: by a sync read, in a single response packet if `fast`,
    /// or one servo after the other if the protocol has no sync reads. Calls `each` with a servo's index in `ids`, its
    /// error byte and its data. Returns the time at which the oldest data had arrived, s of the clock.
    ///
    /// # Errors
    /// If one of them does not answer correctly.
    pub fn read_all(
        &mut self,
        part: (u16, usize),
        ids: &[u8],
        fast: bool,
        mut each: impl FnMut(usize, u8, &[u8]),
    ) -> Result<f64, BusError> {
        let length = part.1;
        if !self.protocol.has_sync_read() {
            return self.read_one_by_one(part, ids, each);
        }
        self.name_part(part);
        self.parameters.extend(ids);
        if fast {
            self.fast_sync_read(length, ids, each)?;
            return Ok(self.clock.now());
        }
        self.send(BROADCAST, SYNC_READ)?;
        let whole = self.protocol.status_length(length) * ids.len();
        let deadline = self.deadline(whole);
        for (index, &id) in ids.iter().enumerate() {
            let (error, bytes) = self.status(id, length, deadline)?;
            each(index, error, bytes);
        }
        Ok(self.clock.now())
    }

    /// Reads a `part` of the servos `ids`, one after the other. The first response is the oldest.
    fn read_one_by_one(
        &mut self,
        part: (u16, usize),
        ids: &[u8],
        mut each: impl FnMut(usize, u8, &[u8]),
    ) -> Result<f64, BusError> {
        let mut oldest = None;
        for (index, &id) in ids.iter().enumerate() {
            self.name_part(part);
            self.send(id, READ)?;
            let deadline = self.deadline(self.protocol.status_length(part.1));
            let (error, bytes) = self.status(id, part.1, deadline)?;
            each(index, error, bytes);
            oldest.get_or_insert(self.clock.now());
        }
        Ok(oldest.unwrap_or_else(|| self.clock.now()))
    }

    /// Performs a fast sync read of `length` bytes per servo. `parameters` already contains the request.
    fn fast_sync_read(
        &mut self,
        length: usize,
        ids: &[u8],
        mut each: impl FnMut(usize, u8, &[u8]),
    ) -> Result<(), BusError> {
        self.send(BROADCAST, FAST_SYNC_READ)?;
        let deadline = self.deadline(fast_status_length(ids.len(), length));
        let blamed = |decoder: &Decoder| {
            let arrived = complete_blocks(decoder.pending(), length);
            ids.get(arrived)
                .or(ids.last())
                .copied()
                .unwrap_or(BROADCAST)
        };
        self.packet(blamed, deadline)?;
        let parameters = self.decoder.parameters();
        let mut count = 0;
        for (index, (block, &id)) in fast_blocks(parameters, length).zip(ids).enumerate() {
            if block.id != id {
                return Err(BusError::Unexpected {
                    id,
                    expected: length,
                    actual_id: block.id,
                    actual: block.data.len(),
                });
            }
            each(index, block.error, block.data);
            count += 1;
        }
        match ids.get(count) {
            Some(&id) => Err(BusError::CutShort {
                id,
                received: parameters.len(),
            }),
            None => Ok(()),
        }
    }
}
