//! A taxel array behind its table, as a tactile sensor.

use super::{
    Place, TaxelChain, TaxelError, TaxelLayout, TaxelRow, TaxelRows, TaxelUnit, Trouble, Troubles,
};
use crate::sensor::reading::{SensorError, TactileFrame, TactileSensor};
use std::io::BufRead;

/// Reads a taxel array's table, row by row: each is a tactile frame. See [the module](super).
///
/// ```
/// use feeler::sensor::reading::{TactileFrame, TactileSensor};
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
/// assert_eq!(sensor.troubles().iter().count(), 1);
/// # Ok::<_, Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TaxelSensor<R> {
    rows: TaxelRows<R>,
    row: TaxelRow,
    chain: TaxelChain,
    unit: TaxelUnit,
    /// Whether it was said which taxels have no zero in this sequence.
    zero_told: bool,
}

impl<R: BufRead> TaxelSensor<R> {
    /// Reads the header of `stream`, a table as `layout` has it. A `rate` (Hz) stands before a column of time.
    ///
    /// # Errors
    /// When a value of the layout is out of range, the header is not as it says, nothing tells the time, or the
    /// stream cannot be read.
    pub fn open(stream: R, layout: &TaxelLayout, rate: Option<f64>) -> Result<Self, TaxelError> {
        let chain = TaxelChain::new(layout)?;
        Ok(Self {
            rows: TaxelRows::open(stream, layout, rate)?,
            row: TaxelRow::new(chain.element_count()),
            chain,
            unit: layout.force_unit(),
            zero_told: false,
        })
    }

    /// Unit of the forces. In counts, they are comparable with each other, and with thresholds in counts.
    pub fn unit(&self) -> TaxelUnit {
        self.unit
    }

    /// Whether a sequence begins with the newest frame: what was felt before has nothing to do with it, and shear
    /// rates do not reach across.
    pub fn starts_sequence(&self) -> bool {
        self.row.starts_sequence
    }

    /// The newest frame's sequence, as it is named in its column; empty without one.
    pub fn sequence(&self) -> &[u8] {
        self.rows.sequence()
    }

    /// Line of the newest frame's row, from 1.
    pub fn line(&self) -> u64 {
        self.rows.line()
    }

    /// What was not as it should be in the table so far.
    pub fn troubles(&self) -> &Troubles {
        self.rows.troubles()
    }

    /// Names of the table's columns.
    pub fn columns(&self) -> &[String] {
        self.rows.columns()
    }

    /// Counts the taxels without a zero, once it is clear that they have none.
    fn tell_zero(&mut self) {
        if self.zero_told || !self.chain.has_zeros() {
            return;
        }
        self.zero_told = true;
        let line = self.rows.line();
        for taxel in self.chain.without_zero() {
            let column = self.rows.column_of(taxel);
            let place = Place { line, column };
            self.rows.troubles_mut().count(Trouble::NoZero, place);
        }
    }
}

impl<R: BufRead> TactileSensor for TaxelSensor<R> {
    fn element_count(&self) -> usize {
        self.chain.element_count()
    }

    /// Waits for the next row. Neither allocates nor panics.
    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let (expected, actual) = (self.element_count(), reading.forces.len());
        if expected != actual {
            return Err(SensorError::ElementCount { expected, actual });
        }
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
