//! Regression features of a camera's sensor.

use super::modes::{self, add_modes, fill_modes};
use super::standard::{ElementStandard, common_gain, standards};
use super::{Growth, MIN_FOR_GAIN, PER_ELEMENT, Terms};
use crate::sensor::moments::kernel::ElementMoments;
use crate::sensor::wrench::WrenchError;
use crate::sensor::wrench::basis::{Basis, MAX_FEATURE, zero_if_nan};
use crate::sensor::wrench::calibration::check_count;
use serde::{Deserialize, Serialize};

/// Value at which the square of a standardised feature saturates. Squares model curvature within the calibrated range;
/// beyond it they would diverge.
const FARTHEST_SQUARED: f64 = 4.0;

/// Reference and statistics of each element of a camera's sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MomentBasis(pub Vec<ElementStandard>);

impl Basis for MomentBasis {
    const KIND: &'static str = "wrench";
    const MAX_ROWS: usize = 400;
    /// Moments of the elements in one image; `None` for elements that are dark or saturated.
    type Input = Vec<Option<ElementMoments>>;
    type Terms = Terms;

    fn elements_of(input: &Self::Input) -> usize {
        input.len()
    }

    fn from_inputs(elements: usize, inputs: &[&Self::Input]) -> Self {
        let mut standards = standards(elements, inputs);
        add_modes(&mut standards, inputs);
        Self(standards)
    }

    fn missing_input(&self) -> Self::Input {
        vec![None; self.0.len()]
    }

    fn feature_count(&self) -> usize {
        PER_ELEMENT * self.0.len() + self.modes()
    }

    fn standardise(&self, input: &Self::Input, features: &mut [f64]) -> f64 {
        features.fill(f64::NAN);
        let Some(gain) = common_gain(&self.0, input) else {
            return 1.0;
        };
        let (mut used, mut missing) = (0.0, 0.0);
        let (features, modes) = features.split_at_mut(PER_ELEMENT * self.0.len());
        fill_modes(&self.0, input, modes);
        modes
            .iter_mut()
            .for_each(|mode| *mode = mode.clamp(-MAX_FEATURE, MAX_FEATURE));
        let (features, _) = features.as_chunks_mut::<PER_ELEMENT>();
        for ((standard, moments), features) in self.0.iter().zip(input).zip(features) {
            if !standard.used {
                continue;
            }
            used += 1.0;
            match moments {
                Some(moments) => *features = standard.standardised(standard.raw(moments, gain)),
                None => missing += 1.0,
            }
        }
        missing / used
    }

    fn candidates(&self) -> Vec<Terms> {
        let terms = |growth, displacement, squares| Terms {
            growth,
            displacement,
            squares,
            modes: false,
        };
        let with_modes = |growth| Terms {
            modes: true,
            ..terms(growth, false, false)
        };
        let kinds = [
            (Growth::GainFree, false),
            (Growth::Ignored, true),
            (Growth::GainFree, true),
            (Growth::Plain, false),
            (Growth::Plain, true),
        ];
        let separable = self.used() >= MIN_FOR_GAIN;
        let kinds = kinds
            .into_iter()
            .filter(|(growth, _)| separable || *growth != Growth::GainFree);
        let candidates = kinds.flat_map(|(growth, displacement)| {
            [false, true].map(|squares| terms(growth, displacement, squares))
        });
        let of_modes = [Growth::Ignored, Growth::GainFree].map(with_modes);
        let of_modes = of_modes
            .into_iter()
            .filter(|terms| self.modes() > 0 && (separable || terms.growth == Growth::Ignored));
        candidates.chain(of_modes).collect()
    }

    /// Returns `true` if only `terms` depends on the overall brightness, which drifts with the lamp.
    fn is_prone_to_overfitting(terms: Terms, other: Terms) -> bool {
        terms.growth == Growth::Plain && other.growth != Growth::Plain
    }

    /// Uses growth and displacement of each element, independently of the terms of the components, because under an
    /// unusual load, spots may brighten as usual but move differently. Includes overall brightness if a component
    /// depends on it, or if there are too few elements to separate it from growth.
    fn novelty_terms(&self, chosen: &[Terms]) -> Terms {
        let plain = chosen.iter().any(|terms| terms.growth == Growth::Plain);
        Terms {
            growth: match plain || self.used() < MIN_FOR_GAIN {
                true => Growth::Plain,
                false => Growth::GainFree,
            },
            displacement: true,
            squares: false,
            modes: false,
        }
    }

    fn supports_novelty(terms: Terms) -> bool {
        !terms.squares && !terms.modes
    }

    fn describe(terms: Terms) -> String {
        let growth = match terms.growth {
            Growth::Ignored => None,
            Growth::GainFree => Some("growth"),
            Growth::Plain => Some("growth and overall brightness"),
        };
        let displacement = terms.displacement.then_some("displacement");
        let squares = terms.squares.then_some("their squares");
        let modes = terms
            .modes
            .then_some("modes of displacement and their products");
        let parts = [growth, displacement, squares, modes].into_iter().flatten();
        parts.collect::<Vec<_>>().join(", ")
    }

    fn term_count(&self, terms: Terms) -> usize {
        let orders = if terms.squares { 2 } else { 1 };
        let modes = if terms.modes { self.modes() } else { 0 };
        orders * terms.kinds().count() * self.0.len() + modes::term_count(modes)
    }

    /// Order of the terms: for each element its features, then their squares; then the modes and their products.
    fn terms<'a>(&'a self, terms: Terms, features: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let (features, modes) = features.split_at(PER_ELEMENT * self.0.len());
        let modes = if terms.modes { modes } else { &[] };
        let (features, _) = features.as_chunks::<PER_ELEMENT>();
        let of_elements = features.iter().flat_map(move |features| {
            let linear = terms.kinds().map(move |kind| zero_if_nan(features[kind]));
            let squares = terms.kinds().filter(move |_| terms.squares);
            linear.chain(squares.map(move |kind| square(features[kind])))
        });
        of_elements.chain(modes::terms(modes))
    }

    fn keep_only(&mut self, terms: &[Terms]) {
        if terms.iter().all(|terms| !terms.modes) {
            self.0
                .iter_mut()
                .for_each(|element| element.loadings.clear());
        }
    }

    fn check(&self, elements: usize) -> Result<(), WrenchError> {
        check_count("model.elements", elements, self.0.len())?;
        for (index, element) in self.0.iter().enumerate() {
            element.check(index)?;
            let name = format!("model.elements[{index}].modes");
            check_count(&name, self.modes(), element.loadings.len())?;
        }
        Ok(())
    }
}

impl MomentBasis {
    /// Number of modes of deformation.
    fn modes(&self) -> usize {
        self.0.first().map_or(0, |standard| standard.loadings.len())
    }

    /// Number of elements that are used.
    fn used(&self) -> usize {
        self.0.iter().filter(|standard| standard.used).count()
    }
}

/// Square of a standardised feature, scaled to mean 0 and variance 1 for a normally distributed feature.
fn square(feature: f64) -> f64 {
    if feature.is_nan() {
        return 0.0;
    }
    let near = feature.clamp(-FARTHEST_SQUARED, FARTHEST_SQUARED);
    (near * near - 1.0) * std::f64::consts::FRAC_1_SQRT_2
}
