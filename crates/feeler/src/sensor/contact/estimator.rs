//! Contact from the forces of one frame.

use super::ellipse::{CELL, ContactEllipse, Share, ellipse};
use super::friction::{FrictionEstimator, parts};
use crate::sensor::fingertip::layout::SensingElement;
use glam::{DVec2, DVec3};

/// Maximum squared distance of neighbours, over that of the nearest one: a square's diagonal, and tolerance.
const NEIGHBOURS: f64 = 2.3;

/// Number of times that the normal of the contact is computed from compressions along the previous one, which are affected
/// less and less by shear.
const WEIGHINGS: usize = 4;
/// Ratio of shear to compression, over the coefficient of friction, from which an element counts as sliding.
const SLIDING: f64 = 0.95;

/// Contact of one fingertip with an object. Vectors are in the fingertip frame `T`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Centre of pressure, m: mean position of the elements, weighted by their compression along `normal`. On a dome, it is projected
    /// onto the dome.
    pub centre: DVec3,
    /// Standard error of the centre along each tangent, m.
    pub centre_error: f64,
    /// Outward normal of the fingertip, a unit vector: mean normal of the elements, weighted by their compression.
    pub normal: DVec3,
    /// Force on the fingertip by the object, N.
    pub force: DVec3,
    /// Standard error of each component of the force, N.
    pub force_error: f64,
    /// Torque on the fingertip by the object about `normal` through `centre`, N m; positive counterclockwise when
    /// looking at the fingertip from outside.
    pub torsion: f64,
    /// Standard error of the torsion, N m.
    pub torsion_error: f64,
    /// Extent of the contact, or `None` if the elements do not resolve it.
    pub ellipse: Option<ContactEllipse>,
    /// Number of touching elements.
    pub touching: usize,
    /// Coefficient of friction, or `None` if it is unknown.
    pub friction: Option<f64>,
    /// Number of touching elements that slide, or `None` if the coefficient of friction is unknown.
    pub sliding: Option<usize>,
}

impl Contact {
    /// Fraction of the touching elements that slide, 0 to 1, or `None` if the coefficient of friction is unknown.
    pub fn sliding_share(&self) -> Option<f64> {
        Some(self.sliding? as f64 / self.touching as f64)
    }
}

/// Estimates the contact of a fingertip from the forces on its elements.
///
/// An element touches if its compression exceeds a threshold, unless it is alone and another one is pressed harder. The forces on its neighbours also count, although they
/// may be noise: without them, the weakly loaded edge would be missing. The standard error of each force component is
/// assumed to be a third of the threshold; stated errors include the spacing of the elements.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEstimator {
    elements: Vec<Place>,
    /// Radius of the dome, m, or `None` if the elements do not lie on a dome.
    dome_radius: Option<f64>,
    touch: f64,
    friction: Friction,
    /// Touching elements and their neighbours in the current frame.
    loaded: Vec<Loaded>,
}

#[derive(Debug, Clone, PartialEq)]
struct Loaded {
    /// Number of the element.
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
struct Place {
    element: SensingElement,
    /// Position in `T`, m.
    position: DVec3,
    /// Squared distance to the nearest other element, m²; 0 for a single element.
    cell: f64,
    /// Numbers of the elements around it.
    neighbours: Vec<usize>,
}

impl ContactEstimator {
    /// Creates an estimator for elements at these positions (m, in `T`), from [`ElementLayout::places`] or
    /// [`TaxelLayout::elements`](crate::sensor::taxel::TaxelLayout::elements). Elements touch at compressions above
    /// `touch`, in N, or in counts if the forces are in counts.
    ///
    /// [`ElementLayout::places`]: crate::sensor::fingertip::ElementLayout::places
    pub fn new(elements: impl IntoIterator<Item = (SensingElement, DVec3)>, touch: f64) -> Self {
        let elements: Vec<_> = elements.into_iter().collect();
        let place = |(index, &(element, position)): (usize, &(SensingElement, DVec3))| {
            let others = elements
                .iter()
                .enumerate()
                .filter(|&(other, _)| other != index);
            let distances =
                others.map(|(other, (_, place))| (other, place.distance_squared(position)));
            let nearest = distances
                .clone()
                .map(|(_, distance)| distance)
                .fold(f64::INFINITY, f64::min);
            let neighbours = distances.filter(|&(_, distance)| distance <= NEIGHBOURS * nearest);
            Place {
                element,
                position,
                cell: if nearest.is_finite() { nearest } else { 0.0 },
                neighbours: neighbours.map(|(other, _)| other).collect(),
            }
        };
        Self {
            elements: elements.iter().enumerate().map(place).collect(),
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

    /// Forgets the estimated friction, for example because another object is touched.
    pub fn restart(&mut self) {
        if let Friction::Estimated(estimator) = &mut self.friction {
            estimator.restart();
        }
    }

    /// Estimates the contact from the forces of the next [`TactileFrame`](crate::sensor::forces::TactileFrame), or returns
    /// `None` if no element touches. Does not allocate.
    ///
    /// Elements without a valid force are ignored, as if they did not touch.
    pub fn estimate(&mut self, forces: &[DVec3]) -> Option<Contact> {
        self.load(forces);
        let normal = self.weigh()?;
        let mut contact = self.contact(normal)?;
        contact.friction = match &mut self.friction {
            Friction::Known(friction) => Some(*friction),
            Friction::Estimated(estimator) => {
                let touching = self.loaded.iter().filter(|loaded| loaded.touches);
                estimator.update(
                    normal,
                    touching.map(|loaded| (loaded.element, loaded.force)),
                )
            }
        };
        contact.sliding = contact.friction.map(|friction| {
            let touching = self.loaded.iter().filter(|loaded| loaded.touches);
            let slides = touching.filter(|loaded| {
                let (shear, compression) = parts(loaded.force, normal);
                shear.length() >= SLIDING * friction * compression
            });
            slides.count()
        });
        Some(contact)
    }

    /// Collects touching elements and their neighbours.
    fn load(&mut self, forces: &[DVec3]) {
        let valid = |index: usize| forces.get(index).filter(|force| force.is_finite());
        let compression = |index: usize| valid(index).map_or(f64::NEG_INFINITY, |force| force.z);
        let strongest =
            (0..self.elements.len()).max_by(|&a, &b| compression(a).total_cmp(&compression(b)));
        let pressed = |index: usize| compression(index) > self.touch;
        // An element that is pressed alone is noise, unless no other is pressed harder.
        let touches = |index: usize| {
            let neighbours = &self.elements[index].neighbours;
            pressed(index) && (Some(index) == strongest || neighbours.iter().any(|&n| pressed(n)))
        };
        self.loaded.clear();
        for (index, place) in self.elements.iter().enumerate() {
            let Some(&force) = valid(index) else { continue };
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

    /// Normal of the contact: the mean of the elements' normals, weighted by their compression along it. An object
    /// flattens the fingertip, so its surface faces this direction, not those of the unloaded elements.
    fn weigh(&mut self) -> Option<DVec3> {
        let mut normal = DVec3::ZERO;
        for _ in 0..WEIGHINGS {
            let of_elements = self
                .loaded
                .iter()
                .map(|l| l.compression * self.elements[l.element].element.normal());
            normal = of_elements.sum::<DVec3>().try_normalize()?;
            for loaded in &mut self.loaded {
                (_, loaded.compression) = parts(loaded.force, normal);
            }
        }
        Some(normal)
    }

    /// Contact of the collected elements, without friction.
    fn contact(&self, normal: DVec3) -> Option<Contact> {
        let touching = self.loaded.iter().filter(|loaded| loaded.touches).count();
        let pressed: f64 = self.loaded.iter().map(|loaded| loaded.compression).sum();
        if touching == 0 || pressed <= self.touch {
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
        let shares = self.loaded.iter().map(|loaded| {
            let off = position(loaded) - mean;
            Share {
                place: DVec2::new(off.dot(x), off.dot(y)),
                share: loaded.compression / pressed,
                cell: self.elements[loaded.element].cell,
            }
        });
        let noise = self.touch / 3.0;
        let arms: f64 = shares.clone().map(|s| s.place.length_squared()).sum();
        let cell: f64 = shares.clone().map(|s| s.share * s.cell).sum();
        // `arms` is the sum along both tangents, so half of it is that along each.
        let by_noise = 0.5 * arms * (noise / pressed) * (noise / pressed);
        let centre_variance = by_noise + CELL * cell.max(0.0) / touching as f64;
        let (shear, _) = parts(force, normal);
        let by_centre = shear.length_squared() * centre_variance;
        let ellipse = ellipse(shares, touching, noise / pressed);
        Some(Contact {
            centre: self.on_surface(mean),
            centre_error: libm::sqrt(centre_variance),
            normal,
            force,
            force_error: noise * libm::sqrt(self.loaded.len() as f64),
            torsion: torsion.sum(),
            torsion_error: libm::sqrt(noise * noise * arms + by_centre),
            ellipse: ellipse.map(|(semi_axes, errors, along)| ContactEllipse {
                semi_axes,
                errors,
                direction: along.x * x + along.y * y,
            }),
            touching,
            friction: None,
            sliding: None,
        })
    }

    /// Point of the fingertip's surface above the mean position of elements.
    fn on_surface(&self, mean: DVec3) -> DVec3 {
        match self.dome_radius {
            Some(radius) => mean
                .try_normalize()
                .map_or(mean, |direction| radius * direction),
            None => mean,
        }
    }
}

/// Radius of the dome around the origin of `T` on which all elements lie, m, or `None` if they lie on no such dome.
fn dome_radius(elements: &[(SensingElement, DVec3)]) -> Option<f64> {
    let radius = elements.first()?.1.length();
    let on_dome = |(element, place): &(SensingElement, DVec3)| {
        place.distance(radius * element.normal()) < 1e-6 * radius
    };
    elements.iter().all(on_dome).then_some(radius)
}
