//! Tactile sensor that reads a taxel array's table.

use super::{
    TablePosition, TableProblem, TableProblems, TaxelChain, TaxelError, TaxelLayout, TaxelRow,
    TaxelRows,
};
use crate::sensor::forces::reading::{SensorError, TactileFrame, TactileSensor};
use std::io::BufRead;

/// Reads a taxel array's table; each row is a tactile frame. See [the module](super).
///
/// ```
/// use feeler::sensor::forces::{TactileFrame, TactileSensor};
/// use feeler::sensor::taxel::{TaxelLayout, TaxelSensor};
///
/// let layout = r#"
///     version = 1
///     name = "two pillars"
///     unit = "N"
///     rate = 100.0
///     columns = { x = "p{n}_x", y = "p{n}_y", z = "p{n}_z" }
///     taxel = [{ place = [0.0, -0.004, 0.0] }, { place = [0.0, 0.004, 0.0] }]
/// "#;
/// let table = "p0_x,p0_y,p0_z,p1_x,p1_y,p1_z\n0,0,0,0,0,0\n0.1,0,1.5,,0,0\n";
/// let layout = TaxelLayout::from_toml(layout)?;
/// let mut sensor = TaxelSensor::open(table.as_bytes(), &layout, None)?;
/// let mut frame = TactileFrame::unloaded(sensor.element_count());
/// sensor.read(&mut frame)?;
/// sensor.read(&mut frame)?;
/// assert_eq!((frame.stamp, frame.forces[0].z), (0.01, 1.5));
/// assert!(!frame.is_valid(1));
/// assert_eq!(sensor.problems().iter().count(), 1);
/// # Ok::<_, Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TaxelSensor<R> {
    rows: TaxelRows<R>,
    row: TaxelRow,
    chain: TaxelChain,
    /// `true` if taxels without a zero in this sequence have been reported.
    zero_told: bool,
}

impl<R: BufRead> TaxelSensor<R> {
    /// Reads the header of `stream`, a table with the columns of `layout`. A `rate` (Hz) overrides a time column.
    ///
    /// # Errors
    /// If a value of the layout is out of range, if the header does not match the layout, if there is neither a time
    /// column nor a rate, or if reading the stream fails.
    pub fn open(stream: R, layout: &TaxelLayout, rate: Option<f64>) -> Result<Self, TaxelError> {
        let chain = TaxelChain::new(layout)?;
        Ok(Self {
            rows: TaxelRows::open(stream, layout, rate)?,
            row: TaxelRow::new(chain.element_count()),
            chain,
            zero_told: false,
        })
    }

    /// Returns `true` if the current frame starts a sequence. Shear rates must not span two sequences.
    pub fn starts_sequence(&self) -> bool {
        self.row.starts_sequence
    }

    /// Name of the current frame's sequence; empty without a sequence column.
    pub fn sequence(&self) -> &[u8] {
        self.rows.sequence()
    }

    /// Line number of the current frame's row, from 1.
    pub fn line(&self) -> u64 {
        self.rows.line()
    }

    /// Problems found in the table so far.
    pub fn problems(&self) -> &TableProblems {
        self.rows.problems()
    }

    /// Names of the table's columns.
    pub fn columns(&self) -> &[String] {
        self.rows.columns()
    }

    /// Reports taxels without a zero, once per sequence after all unloaded rows.
    fn tell_zero(&mut self) {
        if self.zero_told || !self.chain.has_zeros() {
            return;
        }
        self.zero_told = true;
        let line = self.rows.line();
        for taxel in self.chain.without_zero() {
            let column = self.rows.column_of(taxel);
            let place = TablePosition { line, column };
            self.rows.problems_mut().count(TableProblem::NoZero, place);
        }
    }
}

impl<R: BufRead> TactileSensor for TaxelSensor<R> {
    fn element_count(&self) -> usize {
        self.chain.element_count()
    }

    /// Reads the next row; blocks until it is available. Neither allocates nor panics.
    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        reading.check_elements(self.element_count())?;
        match self.rows.next(&mut self.row) {
            Ok(true) => {}
            Ok(false) => {
                let count = self.rows.count_rows();
                return Err(SensorError::Ended { count });
            }
            Err(error) => return Err(SensorError::Table(error)),
        }
        if self.row.starts_sequence {
            self.chain.restart();
            self.zero_told = false;
        }
        let TaxelRow { stamp, values, .. } = &self.row;
        self.chain.sense(*stamp, values, &mut reading.forces);
        (reading.sequence, reading.stamp) = (self.row.number, *stamp);
        self.tell_zero();
        Ok(())
    }
}
