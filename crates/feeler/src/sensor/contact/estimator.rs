//! Contact from the forces of one frame.

use super::ellipse::{CELL_VARIANCE, ContactEllipse, Sample, ellipse};
use super::friction::{FrictionEstimator, MIN_COMPRESSION, shear_and_compression};
use crate::sensor::fingertip::layout::SensingElement;
use glam::{DVec2, DVec3};

/// Maximum squared distance of a neighbour, relative to that of the nearest one: 2 for the diagonal of a square, plus
/// tolerance.
const NEIGHBOURS: f64 = 2.3;

/// Iterations that compute the contact normal; each reduces the influence of shear.
const NORMAL_ITERATIONS: usize = 4;
/// Minimum compression, relative to the threshold, for an isolated element to count as in contact while another element
/// is pressed harder.
const ISOLATED: f64 = 2.0;
/// Ratio of shear to compression, relative to the coefficient of friction, from which an element counts as sliding.
const SLIDING: f64 = 0.95;

/// Contact of one fingertip with an object. Vectors are in the fingertip frame `T`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Centre of pressure, m: mean position of the elements, weighted by their compression along `normal`. On a dome,
    /// it is projected onto the dome.
    pub centre: DVec3,
    /// Standard error of the centre along each tangent, m; NaN for a single element, whose size is unknown.
    pub centre_error: f64,
    /// Outward normal of the fingertip, a unit vector: mean normal of the elements, weighted by their compression.
    pub normal: DVec3,
    /// Force on the fingertip by the object, N.
    pub force: DVec3,
    /// Standard error of each component of the force, N.
    pub force_error: f64,
    /// Torque on the fingertip by the object about `normal` through `centre`, N·m; positive counterclockwise when
    /// looking at the fingertip from outside.
    pub torsion: f64,
    /// Standard error of the torsion, N·m.
    pub torsion_error: f64,
    /// Extent of the contact, or `None` if the elements do not resolve it.
    pub ellipse: Option<ContactEllipse>,
    /// Number of elements in contact.
    pub touching: usize,
    /// Coefficient of friction, or `None` if it is unknown.
    pub friction: Option<f64>,
    /// Fraction of the elements with a compression of three times the threshold or more that slide, 0 to 1, or `None` if
    /// there is no such element or the coefficient of friction is unknown.
    pub sliding: Option<f64>,
}

/// Estimates the contact of a fingertip from the forces on its elements.
///
/// An element is in contact if its compression exceeds a threshold. An isolated element between one and two thresholds
/// is ignored as noise, unless it is the most compressed one. Forces on neighbours of these elements are included,
/// because the edge of a contact is weakly loaded. The standard error of each force component is assumed to be a third
/// of the threshold; stated errors include the spacing of the elements, which should be about equal in all directions.
///
/// Shear and compression are measured relative to one plane: the object must be locally flat.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEstimator {
    elements: Vec<Site>,
    /// Radius of the dome, m, or `None` if the elements do not lie on a dome.
    dome_radius: Option<f64>,
    touch: f64,
    friction: Friction,
    /// Elements in contact and their neighbours in the current frame.
    loaded: Vec<Loaded>,
}

#[derive(Debug, Clone, PartialEq)]
struct Loaded {
    /// Index of the element.
    element: usize,
    /// Force on the fingertip, N in `T`.
    force: DVec3,
    /// Compression along the normal of the contact, N.
    compression: f64,
    touches: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Friction {
    Known(f64),
    Estimated(FrictionEstimator),
}

#[derive(Debug, Clone, PartialEq)]
struct Site {
    element: SensingElement,
    /// Position in `T`, m.
    position: DVec3,
    /// Squared distance to the nearest other element, m²; NaN for a single element.
    cell_area: f64,
    /// Indices of the adjacent elements.
    neighbours: Vec<usize>,
}

impl ContactEstimator {
    /// Creates an estimator for elements at these positions (m, in `T`), from [`ElementLayout::places`] or
    /// [`TaxelLayout::elements`](crate::sensor::taxel::TaxelLayout::elements). Elements are in contact at compressions
    /// above `touch`, in N, or in counts if the forces are in counts.
    ///
    /// [`ElementLayout::places`]: crate::sensor::fingertip::ElementLayout::places
    pub fn new(elements: impl IntoIterator<Item = (SensingElement, DVec3)>, touch: f64) -> Self {
        let elements: Vec<_> = elements.into_iter().collect();
        let distance = |a: usize, b: usize| elements[a].1.distance_squared(elements[b].1);
        let others = |index: usize| (0..elements.len()).filter(move |&other| other != index);
        let nearest = |index| {
            others(index)
                .map(|other| distance(index, other))
                .fold(f64::INFINITY, f64::min)
        };
        let nearest: Vec<_> = (0..elements.len()).map(nearest).collect();
        let site = |(index, &(element, position)): (usize, &(SensingElement, DVec3))| {
            let limit = |other: usize| NEIGHBOURS * nearest[index].max(nearest[other]);
            let is_near = |&other: &usize| distance(index, other) <= limit(other);
            Site {
                element,
                position,
                cell_area: if nearest[index].is_finite() {
                    nearest[index]
                } else {
                    0.0
                },
                neighbours: others(index).filter(is_near).collect(),
            }
        };
        Self {
            elements: elements.iter().enumerate().map(site).collect(),
            dome_radius: dome_radius(&elements),
            friction: Friction::Estimated(FrictionEstimator::new(elements.len(), touch)),
            touch,
            loaded: Vec::with_capacity(elements.len()),
        }
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.elements.len()
    }

    /// Sets the coefficient of friction between elements and object. Otherwise it is estimated while the contact begins
    /// to slide.
    #[must_use]
    pub fn with_friction(self, friction: f64) -> Self {
        let friction = Friction::Known(friction);
        Self { friction, ..self }
    }

    /// Discards the estimated friction, for example because another object is touched.
    pub fn restart(&mut self) {
        if let Friction::Estimated(estimator) = &mut self.friction {
            estimator.restart();
        }
    }

    /// Estimates the contact from the forces of the next [`TactileFrame`](crate::sensor::forces::TactileFrame), or returns
    /// `None` if no element is in contact, or if the forces on the elements in contact cancel. Does not allocate.
    ///
    /// Elements without a valid force are ignored, as if they were not in contact.
    pub fn estimate(&mut self, forces: &[DVec3]) -> Option<Contact> {
        self.collect_loaded(forces);
        let contact = self
            .contact_normal()
            .and_then(|normal| self.contact(normal));
        let Some(mut contact) = contact else {
            if let Friction::Estimated(estimator) = &mut self.friction {
                estimator.end_contact();
            }
            return None;
        };
        let touching = touching(&self.loaded);
        contact.friction = match &mut self.friction {
            Friction::Known(friction) => Some(*friction),
            Friction::Estimated(estimator) => {
                let forces = touching
                    .clone()
                    .map(|loaded| (loaded.element, loaded.force));
                estimator.update(contact.normal, forces)
            }
        };
        contact.sliding = contact.friction.and_then(|friction| {
            let judged =
                touching.filter(|loaded| loaded.compression >= MIN_COMPRESSION * self.touch);
            let slides = |loaded: &&Loaded| {
                let (shear, compression) = shear_and_compression(loaded.force, contact.normal);
                shear.length() >= SLIDING * friction * compression
            };
            let count = judged.clone().count();
            (count > 0).then(|| judged.filter(slides).count() as f64 / count as f64)
        });
        Some(contact)
    }

    /// Collects the elements in contact and their neighbours.
    fn collect_loaded(&mut self, forces: &[DVec3]) {
        let valid = |index: usize| forces.get(index).filter(|force| force.is_finite());
        let compression = |index: usize| valid(index).map_or(f64::NEG_INFINITY, |force| force.z);
        let strongest =
            (0..self.elements.len()).max_by(|&a, &b| compression(a).total_cmp(&compression(b)));
        let pressed = |index: usize| compression(index) > self.touch;
        let touches = |index: usize| {
            let is_strong = Some(index) == strongest || compression(index) > ISOLATED * self.touch;
            let neighbours = &self.elements[index].neighbours;
            pressed(index) && (is_strong || neighbours.iter().any(|&n| pressed(n)))
        };
        self.loaded.clear();
        for (index, place) in self.elements.iter().enumerate() {
            // A pulled element does not belong to a contact.
            let Some(&force) = valid(index).filter(|force| force.z > -self.touch) else {
                continue;
            };
            let own = touches(index);
            if own || place.neighbours.iter().any(|&n| touches(n)) {
                self.loaded.push(Loaded {
                    element: index,
                    force: place.element.force_on_fingertip(force),
                    compression: force.z,
                    touches: own,
                });
            }
        }
    }

    /// Normal of the contact: mean of the elements' normals, weighted by their compression. Stores each element's
    /// compression along the result, because an object flattens the fingertip, so that its surface faces this direction
    /// instead of those of the unloaded elements.
    fn contact_normal(&mut self) -> Option<DVec3> {
        let mut normal = DVec3::ZERO;
        for _ in 0..NORMAL_ITERATIONS {
            let of_elements = self
                .loaded
                .iter()
                .map(|l| l.compression * self.elements[l.element].element.normal());
            normal = of_elements.sum::<DVec3>().try_normalize()?;
            for loaded in &mut self.loaded {
                let (_, compression) = shear_and_compression(loaded.force, normal);
                loaded.compression = compression.max(-self.touch);
            }
        }
        Some(normal)
    }

    /// Computes the contact of the collected elements, without friction.
    fn contact(&self, normal: DVec3) -> Option<Contact> {
        let touching = touching(&self.loaded).count();
        let pressed: f64 = self.loaded.iter().map(|loaded| loaded.compression).sum();
        if touching == 0 || pressed <= 0.5 * self.touch {
            return None;
        }
        let position = |loaded: &Loaded| self.elements[loaded.element].position;
        let mean = self
            .loaded
            .iter()
            .map(|l| l.compression / pressed * position(l))
            .sum::<DVec3>();
        let force: DVec3 = self.loaded.iter().map(|loaded| loaded.force).sum();
        let torsion = self
            .loaded
            .iter()
            .map(|l| normal.dot((position(l) - mean).cross(l.force)));
        let (x, y) = normal.any_orthonormal_pair();
        let samples = self.loaded.iter().map(|loaded| {
            let offset = position(loaded) - mean;
            Sample {
                position: DVec2::new(offset.dot(x), offset.dot(y)),
                weight: loaded.compression / pressed,
                cell_area: self.elements[loaded.element].cell_area,
            }
        });
        let noise = self.touch / 3.0;
        let squared_arms: f64 = samples.clone().map(|s| s.position.length_squared()).sum();
        let cell_area: f64 = samples.clone().map(|s| s.weight * s.cell_area).sum();
        // `squared_arms` is the sum along both tangents, so half of it is that along each.
        let by_noise = 0.5 * squared_arms * (noise / pressed) * (noise / pressed);
        let centre_variance = by_noise + CELL_VARIANCE * cell_area.abs() / touching as f64;
        let (shear, _) = shear_and_compression(force, normal);
        let by_centre = shear.length_squared() * centre_variance;
        let centre = self.on_surface(mean);
        // The mean of elements all over a dome is far below its surface.
        let projected = match mean.length() {
            depth if depth > 0.0 => centre.length() / depth,
            _ => 1.0,
        };
        Some(Contact {
            centre,
            centre_error: projected * libm::sqrt(centre_variance),
            normal,
            force,
            force_error: noise * libm::sqrt(self.loaded.len() as f64),
            torsion: torsion.sum(),
            torsion_error: libm::sqrt(noise * noise * squared_arms + by_centre),
            ellipse: ellipse(samples, (x, y), touching, noise / pressed),
            touching,
            friction: None,
            sliding: None,
        })
    }

    /// Projects the mean position of elements onto the fingertip's surface.
    fn on_surface(&self, mean: DVec3) -> DVec3 {
        match self.dome_radius {
            Some(radius) => mean
                .try_normalize()
                .map_or(mean, |direction| radius * direction),
            None => mean,
        }
    }
}

/// Elements in contact among `loaded`.
fn touching(loaded: &[Loaded]) -> impl Iterator<Item = &Loaded> + Clone {
    loaded.iter().filter(|loaded| loaded.touches)
}

/// Radius (m) of the dome around the origin of `T` on which all elements lie; `None` if they do not lie on a dome.
fn dome_radius(elements: &[(SensingElement, DVec3)]) -> Option<f64> {
    let radius = elements.first()?.1.length();
    let on_dome = |(element, place): &(SensingElement, DVec3)| {
        place.distance(radius * element.normal()) < 1e-6 * radius
    };
    elements.iter().all(on_dome).then_some(radius)
}
