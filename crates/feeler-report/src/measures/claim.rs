//! Claims: comparisons of measured values with bounds.

use serde::{Serialize, Serializer};

/// Comparison operator between a value and its bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// value >= bound.
    AtLeast,
    /// value <= bound.
    AtMost,
    /// value == bound.
    Equals,
    /// |value| <= bound.
    Within,
}

impl Relation {
    /// Symbol of the operator.
    pub fn sign(self) -> &'static str {
        match self {
            Self::AtLeast => ">=",
            Self::AtMost => "<=",
            Self::Equals => "=",
            Self::Within => "+-",
        }
    }

    fn holds(self, value: f64, bound: f64) -> bool {
        match self {
            Self::AtLeast => value >= bound,
            Self::AtMost => value <= bound,
            Self::Equals => value == bound,
            Self::Within => value.abs() <= bound,
        }
    }
}

impl Serialize for Relation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.sign())
    }
}

/// Result of a claim or of one of its parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Everything is measured and within its bounds.
    Holds,
    /// A measured value violates its bound.
    Fails,
    /// All measured values are within their bounds, but the recording does not define all values.
    NotMeasured,
}

/// One comparison of a claim.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClaimPart {
    /// Name of the compared quantity.
    pub name: &'static str,
    /// Measured value in `unit`; `None` (JSON null) if the recording does not define it.
    pub value: Option<f64>,
    /// Comparison operator.
    pub relation: Relation,
    /// Bound in `unit`.
    pub bound: f64,
    /// Unit of value and bound; empty for ratios and counts.
    pub unit: &'static str,
    /// `true` if the value is measured and within its bound.
    pub holds: bool,
}

/// Part of the apparatus on which a claim about screwing a cap depends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DecidedBy {
    /// Hand only (rubber, law and path), for any cap that turns at first and is closed at the end.
    Hand,
    /// Hand together with the paper's bottle and torque sensor.
    HandAndBottle,
}

/// A claim with its result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// Stable identifier.
    pub id: &'static str,
    /// Statement of the claim, with the undefined quantities, if any.
    pub text: String,
    /// Measured value of the first of `parts`; `None` (JSON null) if the recording does not define it.
    pub value: Option<f64>,
    /// All bounds, as text.
    pub bound: String,
    /// `true` if all parts hold; an unmeasured part does not hold.
    pub holds: bool,
    /// Like `holds`, but distinguishes unmeasured claims.
    pub verdict: Verdict,
    /// All comparisons of the claim.
    pub parts: Vec<ClaimPart>,
    /// Part of the apparatus that decides the claim, or `None` (no key in JSON) for tasks other than screwing a cap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decided_by: Option<DecidedBy>,
}

impl Verdict {
    fn of_parts(parts: &[ClaimPart]) -> Self {
        let any = |wanted| parts.iter().any(|part| part.verdict() == wanted);
        match (any(Self::Fails), any(Self::NotMeasured)) {
            (true, _) => Self::Fails,
            (false, true) => Self::NotMeasured,
            (false, false) => Self::Holds,
        }
    }
}

impl Claim {
    /// Distance to failure relative to the bounds: the minimum over all parts. Not negative if the claim holds, not
    /// positive if it does not. `None` if a part is not measured.
    pub fn margin(&self) -> Option<f64> {
        let margins = self.parts.iter().map(ClaimPart::margin);
        margins.reduce(|a, b| Some(a?.min(b?)))?
    }

    pub(crate) fn new(id: &'static str, text: &str, parts: Vec<ClaimPart>) -> Self {
        let undefined: Vec<_> = (parts.iter())
            .filter(|part| part.value.is_none())
            .map(|part| part.name)
            .collect();
        let mut text = text.to_string();
        if !undefined.is_empty() {
            text += &format!(" (not defined in this recording: {})", undefined.join(", "));
        }
        let bounds: Vec<_> = parts.iter().map(ClaimPart::bound_text).collect();
        Self {
            id,
            text,
            value: parts.first().and_then(|part| part.value),
            bound: bounds.join("; "),
            holds: parts.iter().all(|part| part.holds),
            verdict: Verdict::of_parts(&parts),
            parts,
            decided_by: None,
        }
    }

    pub(crate) fn decided_by(self, decided_by: DecidedBy) -> Self {
        Self {
            decided_by: Some(decided_by),
            ..self
        }
    }
}

/// Starts a part of a claim: the quantity `name` to compare with a bound, without a unit until [`Quantity::in_unit`].
pub(crate) fn part(name: &'static str) -> Quantity {
    Quantity { name, unit: "" }
}

/// Name and unit of a quantity that a claim compares with a bound.
pub(crate) struct Quantity {
    name: &'static str,
    unit: &'static str,
}

impl Quantity {
    /// Sets the unit of value and bound.
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Requires `value >= bound`.
    pub fn at_least(self, value: Option<f64>, bound: f64) -> ClaimPart {
        self.compared(value, Relation::AtLeast, bound)
    }

    /// Requires `value <= bound`.
    pub fn at_most(self, value: Option<f64>, bound: f64) -> ClaimPart {
        self.compared(value, Relation::AtMost, bound)
    }

    /// Requires `|value| <= bound`.
    pub fn within(self, value: Option<f64>, bound: f64) -> ClaimPart {
        self.compared(value, Relation::Within, bound)
    }

    /// Requires `value == bound`.
    pub fn equals(self, value: Option<f64>, bound: f64) -> ClaimPart {
        self.compared(value, Relation::Equals, bound)
    }

    fn compared(self, value: Option<f64>, relation: Relation, bound: f64) -> ClaimPart {
        let value = value.filter(|value| value.is_finite());
        ClaimPart {
            name: self.name,
            value,
            relation,
            bound,
            unit: self.unit,
            holds: value.is_some_and(|value| relation.holds(value, bound)),
        }
    }
}

impl ClaimPart {
    /// Result of this part.
    pub fn verdict(&self) -> Verdict {
        match (self.value, self.holds) {
            (None, _) => Verdict::NotMeasured,
            (Some(_), true) => Verdict::Holds,
            (Some(_), false) => Verdict::Fails,
        }
    }

    /// Signed distance from the bound, relative to the bound's magnitude (in `unit` if the bound is 0); negative if
    /// violated. At most 0 for [`Relation::Equals`].
    fn margin(&self) -> Option<f64> {
        let value = self.value?;
        let above = match self.relation {
            Relation::AtLeast => value - self.bound,
            Relation::AtMost => self.bound - value,
            Relation::Equals => -(value - self.bound).abs(),
            Relation::Within => self.bound - value.abs(),
        };
        let size = if self.bound == 0.0 {
            1.0
        } else {
            self.bound.abs()
        };
        Some(above / size)
    }

    fn bound_text(&self) -> String {
        let text = format!(
            "{} {} {} {}",
            self.name,
            self.relation.sign(),
            self.bound,
            self.unit
        );
        text.trim_end().to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margin_is_the_smallest_relative_distance_to_a_bound() {
        use Relation::{AtLeast, AtMost, Equals, Within};
        let margin = |parts: &[(f64, Relation, f64)]| {
            let compared =
                |&(value, relation, bound)| part("").compared(Some(value), relation, bound);
            let claim = Claim::new("", "", parts.iter().map(compared).collect());
            let margin = claim.margin().unwrap();
            assert!(
                if claim.holds {
                    margin >= 0.0
                } else {
                    margin <= 0.0
                },
                "{claim:?}"
            );
            margin
        };
        assert_eq!(margin(&[(3.0, AtLeast, 2.0)]), 0.5);
        assert_eq!(margin(&[(0.0625, AtMost, 0.25)]), 0.75);
        assert_eq!(margin(&[(5.0, Equals, 4.0)]), -0.25);
        assert_eq!(margin(&[(4.0, Equals, 4.0)]), 0.0);
        assert_eq!(margin(&[(-0.75, Within, 0.5)]), -0.5);
        // Zero and negative bounds.
        assert_eq!(margin(&[(0.25, AtMost, 0.0)]), -0.25);
        assert_eq!(margin(&[(-3.0, AtMost, -2.0)]), 0.5);
        assert_eq!(
            margin(&[(3.0, AtLeast, 2.0), (1.0, AtMost, 4.0), (2.2, AtLeast, 2.0)]),
            (2.2 - 2.0) / 2.0
        );
        let parts = vec![
            part("").at_least(Some(3.0), 2.0),
            part("").at_least(None, 2.0),
        ];
        let claim = Claim::new("", "", parts);
        assert_eq!(
            (claim.margin(), claim.verdict),
            (None, Verdict::NotMeasured)
        );
        let fails = part("").at_least(Some(1.0), 2.0);
        let parts = [claim.parts, vec![fails]].concat();
        assert_eq!(Claim::new("", "", parts).verdict, Verdict::Fails);
    }
}
