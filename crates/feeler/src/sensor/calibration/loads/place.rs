//! Identifies the elements of a layout by position.

use super::LoadsError;
use crate::math::direction_at;
use crate::sensor::image::seen::ProjectedElement;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Element name and position as given in a row of the table.
pub struct NamedPlace<'a> {
    pub line: u64,
    /// Name of the element; may be empty.
    pub name: &'a str,
    pub place_px: DVec2,
}

/// Looks up the elements of a layout by position.
pub struct Places<'a> {
    seen: &'a [ProjectedElement],
    /// Maximum distance of a position from each element, px: half the distance to the nearest neighbour.
    limits: Vec<f64>,
    /// Index of the element with each name.
    elements: HashMap<String, usize>,
    names: Vec<Option<String>>,
}

impl<'a> Places<'a> {
    pub fn new(seen: &'a [ProjectedElement]) -> Self {
        let limit = |(own, element): (usize, &ProjectedElement)| {
            let others = seen.iter().enumerate().filter(|(other, _)| *other != own);
            let distances = others.map(|(_, other)| other.centre_px.distance(element.centre_px));
            0.5 * distances.fold(f64::INFINITY, f64::min)
        };
        Self {
            limits: seen.iter().enumerate().map(limit).collect(),
            elements: HashMap::new(),
            names: vec![None; seen.len()],
            seen,
        }
    }

    pub fn element_count(&self) -> usize {
        self.seen.len()
    }

    /// Returns the element at a position.
    ///
    /// # Errors
    /// If there is no element at the position, or if its name belongs to another element.
    pub fn find(
        &mut self,
        NamedPlace {
            line,
            name,
            place_px,
        }: NamedPlace,
    ) -> Result<usize, LoadsError> {
        let distance = |element: &ProjectedElement| element.centre_px.distance(place_px);
        let distances = self.seen.iter().map(distance).enumerate();
        let nearest = distances.min_by(|(_, a), (_, b)| a.total_cmp(b));
        let (nearest, distance) = nearest.unwrap_or((0, f64::INFINITY));
        let limit = self.limits.get(nearest).copied().unwrap_or(0.0);
        if distance.partial_cmp(&limit) != Some(std::cmp::Ordering::Less) {
            return Err(LoadsError::NoSuchPlace {
                line,
                name: name.into(),
                place_px,
                nearest,
                distance,
                limit,
            });
        }
        self.note_name(line, name, nearest)?;
        Ok(nearest)
    }

    /// Stores the name of an element. Rejects a name already used for another element, and a second name for the same
    /// element.
    fn note_name(&mut self, line: u64, name: &str, element: usize) -> Result<(), LoadsError> {
        if name.is_empty() {
            return Ok(());
        }
        let before = match (self.elements.get(name), &self.names[element]) {
            (Some(&other), _) if other != element => {
                format!("but was at that of element {other} before")
            }
            (_, Some(other)) if other != name => format!("where element {other:?} is"),
            (Some(_), _) => return Ok(()),
            (None, _) => {
                self.elements.insert(name.into(), element);
                self.names[element] = Some(name.into());
                return Ok(());
            }
        };
        Err(LoadsError::SamePlace {
            line,
            name: name.into(),
            element,
            before,
        })
    }

    /// Rotates `force` to the frame of `element`, from a frame whose x axis is at the angle `x_angle` in the image.
    pub fn turned(&self, element: usize, force: DVec3, x_angle: f64) -> DVec3 {
        let by = x_angle - self.seen[element].x_angle;
        direction_at(by).rotate(force.truncate()).extend(force.z)
    }
}
