//! Plausible ranges of the largest force of a calibration.

/// Plausible range of the largest force on a single element, N. Smaller forces are hidden by image noise; larger ones,
/// at about 1 N/mm² on a few square millimetres of silicone, would flatten the element.
pub const ELEMENT_RANGE: [f64; 2] = [0.01, 20.0];
/// Like [`ELEMENT_RANGE`], but for a whole fingertip, with a contact area of a few square centimetres.
pub const FINGERTIP_RANGE: [f64; 2] = [0.05, 200.0];
