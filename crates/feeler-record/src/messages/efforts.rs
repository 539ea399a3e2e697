//! Message with the efforts of one finger's drives.

use super::channels::stamped;
use crate::message;
use feeler::hand::{JointEfforts, JointVector, MAX_JOINTS};
use serde::{Deserialize, Serialize};

/// Efforts of one finger's drives, estimated from the motors' currents.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Efforts {
    /// Time of the encoder readings that were measured with them (s).
    pub stamp: f64,
    /// Effort on each joint by its motor (N m or N); NaN if unknown, empty if the finger's drives measure none.
    pub effort: Vec<f64>,
    /// Uncertainty of each effort (N m or N).
    pub uncertainty: Vec<f64>,
}

message!(
    Efforts,
    "Efforts",
    "# Efforts of the drives of one finger, estimated from the motors' currents",
    "float64 stamp  # s",
    "float64[] effort  # N m or N on each joint, positive if it increases the position; NaN if unknown",
    "float64[] uncertainty  # N m or N",
);

impl Efforts {
    /// Copies the efforts at `stamp` (s).
    pub fn set(&mut self, stamp: f64, efforts: &JointEfforts) {
        self.stamp = stamp;
        self.effort.clear();
        self.effort.extend(efforts.effort);
        self.uncertainty.clear();
        self.uncertainty.extend(efforts.uncertainty);
    }

    /// Checks that there are as many uncertainties as efforts.
    pub(super) fn check(&self) -> Result<(), String> {
        let (efforts, uncertainties) = (self.effort.len(), self.uncertainty.len());
        if efforts > MAX_JOINTS || uncertainties != efforts {
            return Err(format!(
                "expected efforts of at most {MAX_JOINTS} joints with as many uncertainties, got {efforts} and {uncertainties}"
            ));
        }
        Ok(())
    }

    /// The efforts, or empty vectors if there are too many joints.
    pub fn joints(&self) -> JointEfforts {
        let vector = |values: &[f64]| JointVector::from_slice(values).unwrap_or_default();
        JointEfforts {
            effort: vector(&self.effort),
            uncertainty: vector(&self.uncertainty),
        }
    }
}

stamped!(Efforts);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_numbers_of_joints_are_refused() {
        let check = |efforts: usize, uncertainties: usize| {
            let message = Efforts {
                stamp: 1.0,
                effort: vec![f64::NAN; efforts],
                uncertainty: vec![0.5; uncertainties],
            };
            message.check()
        };
        assert_eq!(check(0, 0), Ok(()));
        assert_eq!(check(MAX_JOINTS, MAX_JOINTS), Ok(()));
        for (efforts, uncertainties) in [(1, 0), (0, 1), (MAX_JOINTS + 1, MAX_JOINTS + 1)] {
            let refused = check(efforts, uncertainties).expect_err("other numbers");
            assert!(refused.contains("as many uncertainties"), "{refused}");
        }
    }
}
