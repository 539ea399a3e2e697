//! Vector with one value per joint of a finger.

mod operators;

use std::fmt::{self, Debug, Display, Formatter};

/// Maximum number of joints of a finger.
pub const MAX_JOINTS: usize = 7;

/// Vector with one value per joint of a finger, such as joint positions (rad or m) or velocities (rad/s or m/s), in the
/// order of the joints from the base to the fingertip. Does not allocate.
///
/// Missing values count as 0: the default, of length 0, equals zeros of any length. The result of an operation on two
/// vectors has the length of the longer one. For three joints, every result is bit-identical to that of
/// [`DVec3`](glam::DVec3).
///
/// ```
/// use feeler::hand::JointVector;
///
/// let angles = JointVector::from([0.1, 0.9, -0.95]);
/// let moved = angles + 0.01 * JointVector::from([1.0, 0.0, 0.0]);
/// assert_eq!(moved.as_slice(), [0.11, 0.9, -0.95]);
/// assert_eq!(angles + JointVector::default(), angles);
/// ```
#[derive(Clone, Copy, Default)]
pub struct JointVector {
    /// Values of the joints; those from index `len` on are 0.
    values: [f64; MAX_JOINTS],
    len: u8,
}

impl JointVector {
    /// Returns a vector of `len` zeros, at most [`MAX_JOINTS`].
    #[inline]
    pub const fn zeros(len: usize) -> Self {
        let len = if len < MAX_JOINTS { len } else { MAX_JOINTS };
        Self {
            values: [0.0; MAX_JOINTS],
            len: len as u8,
        }
    }

    /// Returns a vector of `len` elements `value`, at most [`MAX_JOINTS`].
    #[inline]
    pub fn splat(len: usize, value: f64) -> Self {
        Self::zeros(len).map(|_| value)
    }

    /// Copies `values` into a vector; `None` if there are more than [`MAX_JOINTS`].
    pub fn from_slice(values: &[f64]) -> Option<Self> {
        let mut vector = Self::zeros(values.len());
        vector
            .values
            .get_mut(..values.len())?
            .copy_from_slice(values);
        Some(vector)
    }

    /// Returns a vector of the first `len` of `values`.
    #[inline]
    pub(super) fn first(values: [f64; MAX_JOINTS], len: usize) -> Self {
        let mut vector = Self::zeros(len);
        for (own, value) in vector.values[..vector.len as usize].iter_mut().zip(values) {
            *own = value;
        }
        vector
    }

    /// Appends zeros until there are at least `len` values, at most [`MAX_JOINTS`].
    #[inline]
    #[must_use]
    pub fn padded(mut self, len: usize) -> Self {
        self.len = self.len.max(len.min(MAX_JOINTS) as u8);
        self
    }

    /// Number of joints.
    #[inline(always)]
    pub const fn len(&self) -> usize {
        // The compiler then knows the bound, and omits checks of indices.
        let len = self.len as usize;
        if len < MAX_JOINTS { len } else { MAX_JOINTS }
    }

    /// `true` if the length is 0.
    #[inline]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Values as a slice, one per joint.
    #[inline(always)]
    pub fn as_slice(&self) -> &[f64] {
        &self.values[..self.len()]
    }

    /// Values as a mutable slice, one per joint.
    #[inline(always)]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        let len = self.len();
        &mut self.values[..len]
    }

    /// Iterates over the values, one per joint.
    #[inline(always)]
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator {
        self.as_slice().iter().copied()
    }

    /// Values of a finger with `N` joints as an array; missing ones are 0. `None` if there are more than `N`. For
    /// formats and devices with a fixed number of joints.
    #[inline]
    pub fn to_array<const N: usize>(&self) -> Option<[f64; N]> {
        (self.len() <= N).then(|| std::array::from_fn(|joint| self[joint]))
    }

    /// Applies `f` to the value of each joint.
    #[inline(always)]
    pub fn map(mut self, mut f: impl FnMut(f64) -> f64) -> Self {
        if self.len == 3 {
            // The usual number, unrolled.
            for value in &mut self.values[..3] {
                *value = f(*value);
            }
            return self;
        }
        let len = self.len();
        for value in &mut self.values[..len] {
            *value = f(*value);
        }
        self
    }

    /// Combines the values of each joint with `f`, over the length of the longer vector.
    #[inline(always)]
    pub fn zip_with(mut self, other: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        self.len = self.len.max(other.len);
        if self.len == 3 {
            // The usual number, unrolled.
            for (value, other) in self.values[..3].iter_mut().zip(&other.values) {
                *value = f(*value, *other);
            }
            return self;
        }
        let len = self.len();
        for (value, other) in self.values[..len].iter_mut().zip(&other.values) {
            *value = f(*value, *other);
        }
        self
    }

    /// Absolute values.
    #[inline]
    pub fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// Element-wise minimum. If one of two values is NaN, the result is that of `other`.
    #[inline]
    pub fn min(self, other: Self) -> Self {
        self.zip_with(other, lesser)
    }

    /// Element-wise maximum. If one of two values is NaN, the result is that of `other`.
    #[inline]
    pub fn max(self, other: Self) -> Self {
        self.zip_with(other, greater)
    }

    /// Clamps each value to `lower`..`upper`. NaN becomes `lower`.
    #[inline]
    pub fn clamp(self, lower: Self, upper: Self) -> Self {
        self.max(lower).min(upper)
    }

    /// Smallest value; 0 if the length is 0.
    #[inline]
    pub fn min_element(self) -> f64 {
        self.iter()
            .rev()
            .reduce(|least, v| lesser(v, least))
            .unwrap_or(0.0)
    }

    /// Largest value; 0 if the length is 0.
    #[inline]
    pub fn max_element(self) -> f64 {
        self.iter()
            .rev()
            .reduce(|most, v| greater(v, most))
            .unwrap_or(0.0)
    }

    /// Dot product.
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        let joints = 1..self.len().max(other.len());
        joints.fold(self[0] * other[0], |sum, joint| {
            sum + self[joint] * other[joint]
        })
    }

    /// Euclidean norm. For the number of joints, see [`len`](Self::len).
    #[inline]
    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// Euclidean norm of the difference.
    #[inline]
    pub fn distance(self, other: Self) -> f64 {
        (self - other).length()
    }

    /// `true` if all values are finite.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.iter().all(f64::is_finite)
    }

    /// `true` if at least one value is NaN.
    #[inline]
    pub fn is_nan(&self) -> bool {
        self.iter().any(f64::is_nan)
    }
}

/// Smaller of two numbers, as in `DVec3::min`.
#[inline(always)]
pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Larger of two numbers, as in `DVec3::max`.
#[inline(always)]
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl<const N: usize> From<[f64; N]> for JointVector {
    /// Creates a vector from one number per joint. Does not compile for more than [`MAX_JOINTS`].
    #[inline]
    fn from(numbers: [f64; N]) -> Self {
        const { assert!(N <= MAX_JOINTS, "a finger has at most MAX_JOINTS joints") };
        let mut vector = Self::zeros(N);
        vector.values[..N].copy_from_slice(&numbers);
        vector
    }
}

/// Iterates over the values, one per joint.
impl IntoIterator for JointVector {
    type Item = f64;
    type IntoIter = std::iter::Take<std::array::IntoIter<f64, MAX_JOINTS>>;

    fn into_iter(self) -> Self::IntoIter {
        self.values.into_iter().take(self.len())
    }
}

/// Compares all values; missing ones count as 0.
impl PartialEq for JointVector {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values
    }
}

/// Formats the values as `[a, b, c]`, with the given precision.
impl Display for JointVector {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("[")?;
        for (joint, value) in self.iter().enumerate() {
            if joint > 0 {
                f.write_str(", ")?;
            }
            match f.precision() {
                Some(precision) => write!(f, "{value:.precision$}")?,
                None => write!(f, "{value}")?,
            }
        }
        f.write_str("]")
    }
}

impl Debug for JointVector {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut tuple = f.debug_tuple("JointVector");
        for value in self.as_slice() {
            tuple.field(value);
        }
        tuple.finish()
    }
}
