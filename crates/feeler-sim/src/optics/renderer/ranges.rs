//! Ranges of pixels.

use std::ops::Range;

/// Smallest range that contains both; empty ranges are ignored.
pub fn hull(one: Range<usize>, other: Range<usize>) -> Range<usize> {
    if one.is_empty() || other.is_empty() {
        return if one.is_empty() { other } else { one };
    }
    one.start.min(other.start)..one.end.max(other.end)
}

/// Returns `true` if the ranges overlap.
pub fn meet(one: &Range<usize>, other: &Range<usize>) -> bool {
    one.start.max(other.start) < one.end.min(other.end)
}
