//! Creates elements with sub-regions from grouped spots, and checks them for problems.

use super::{
    LocateConfig, LocateWarning, Located, LocatedElement, Polarity,
    ground::Ground,
    groups::Grouped,
    median, nearest,
    reference::ReferencePicture,
    spot::{FoundSpots, Spot},
};
use glam::DVec2;

/// Returns the pixels (column, row) of each element's sub-region, sorted by row and then by column.
///
/// A sub-region contains the pixels within the radius of its disc that are closest to its centre. Sub-regions do not
/// overlap and are clipped to the image of `size` px.
pub fn sub_regions(size: (usize, usize), discs: &[(DVec2, f64)]) -> Vec<Vec<(usize, usize)>> {
    let (width, height) = size;
    let mut owner = vec![(f64::INFINITY, usize::MAX); width * height];
    for (element, &(centre, radius)) in discs.iter().enumerate() {
        let (columns, rows) = bounding_box(size, centre, radius);
        for row in rows {
            for column in columns.clone() {
                let pixel = DVec2::new(column as f64, row as f64);
                let distance = pixel.distance_squared(centre);
                let owner = &mut owner[row * width + column];
                // The border between two overlapping discs is halfway between their centres.
                if distance < owner.0 && distance <= radius * radius {
                    *owner = (distance, element);
                }
            }
        }
    }
    let mut regions = vec![Vec::new(); discs.len()];
    for (index, &(_, element)) in owner.iter().enumerate() {
        if let Some(region) = regions.get_mut(element) {
            region.push((index % width, index / width));
        }
    }
    regions
}

pub(super) fn bounding_box(
    (width, height): (usize, usize),
    centre: DVec2,
    radius: f64,
) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
    // Casts to usize saturate at 0.
    let low = (centre - radius).floor();
    let high = (centre + radius).ceil() + 1.0;
    let range = |low: f64, high: f64, end: usize| (low as usize).min(end)..(high as usize).min(end);
    (range(low.x, high.x, width), range(low.y, high.y, height))
}

/// Creates elements from grouped spots.
///
/// Elements are bright in `reference`, which is inverted if `polarity` is dark.
pub(super) fn assemble(
    reference: &ReferencePicture,
    polarity: Polarity,
    config: &LocateConfig,
    found: FoundSpots,
    grouped: Grouped,
) -> Located {
    let FoundSpots {
        spots,
        mut left_out,
        cut: at_border,
        noise,
    } = found;
    left_out.extend(grouped.left_out.iter().map(|&i| spots[i].centre));
    let mut diameters: Vec<f64> = spots.iter().map(Spot::scale).collect();
    let spot_diameter_px = median(&mut diameters);
    let centre = |members: &Vec<usize>| {
        members.iter().map(|&i| spots[i].centre).sum::<DVec2>() / members.len().max(1) as f64
    };
    let centres: Vec<DVec2> = grouped.members.iter().map(centre).collect();
    let order = reading_order(&centres);
    let members: Vec<&Vec<usize>> = order.iter().map(|&i| &grouped.members[i]).collect();
    let centres: Vec<DVec2> = order.iter().map(|&i| centres[i]).collect();
    let neighbours = nearest(&centres, 6);
    let shorter = reference.width.min(reference.height) as f64;
    let gaps: Vec<f64> = centres
        .iter()
        .zip(&neighbours)
        .map(|(c, near)| near.first().map_or(shorter, |&i| centres[i].distance(*c)))
        .collect();
    // The spots of a group grow and move; leave a margin of one and a half spot diameters.
    let room = |i: usize| {
        let from_centre = |&s: &usize| spots[s].centre.distance(centres[i]);
        let farthest = members[i].iter().map(from_centre).fold(0.0, f64::max);
        if members[i].len() > 1 {
            farthest + 1.5 * spot_diameter_px
        } else {
            0.0
        }
    };
    let mut elements: Vec<LocatedElement> = (0..centres.len())
        .map(|i| LocatedElement {
            centre_px: centres[i],
            radius_px: (config.region_radius * local_spacing(&gaps, &neighbours[i], i))
                .max(room(i)),
            spots_px: members[i].iter().map(|&s| spots[s].centre).collect(),
            ground_level: 0,
        })
        .collect();
    let spacing_px = if centres.len() > 1 {
        median(&mut gaps.clone())
    } else {
        0.0
    };
    let size = (reference.width, reference.height);
    let discs: Vec<_> = elements
        .iter()
        .map(|e| (e.centre_px, e.radius_px))
        .collect();
    let regions = sub_regions(size, &discs);
    let mut warnings = size_warnings(&spots, &members, &neighbours, &centres, grouped.per_element);
    warnings.extend(light_warning(reference, &spots, &members));
    let cut = |disc: &(DVec2, f64)| {
        let (low, high) = (disc.0 - disc.1, disc.0 + disc.1);
        let last = DVec2::new(size.0 as f64, size.1 as f64) - 1.0;
        low.min_element() < -0.5 || (last - high).min_element() < -0.5
    };
    let cut_off = |(i, disc): (usize, &(DVec2, f64))| cut(disc).then_some(i);
    let cut_off: Vec<usize> = discs.iter().enumerate().filter_map(cut_off).collect();
    if !cut_off.is_empty() {
        warnings.push(LocateWarning::CutOff { elements: cut_off });
    }
    if !at_border.is_empty() {
        warnings.push(LocateWarning::AtBorder {
            spots_px: at_border,
        });
    }
    if !left_out.is_empty() {
        warnings.push(LocateWarning::LeftOut { spots_px: left_out });
    }
    let contrast = |members: &Vec<usize>| {
        let contrasts = members.iter().map(|&s| spots[s].contrast);
        contrasts.sum::<f64>() / members.len().max(1) as f64
    };
    let contrasts: Vec<f64> = members.iter().map(|m| contrast(m)).collect();
    let ground = Ground::new(reference, polarity, &regions, noise);
    for (element, level) in elements.iter_mut().zip(ground.of_elements(&contrasts)) {
        element.ground_level = level;
    }
    Located {
        polarity,
        size,
        two_level: reference.two_level,
        dark_level: ground.of_all(&contrasts),
        elements,
        spacing_px,
        spot_diameter_px,
        spot_area_diameter_px: median(
            &mut spots.iter().map(|spot| spot.diameter).collect::<Vec<_>>(),
        ),
        spots_per_element: grouped.per_element,
        warnings,
    }
}

/// Distance from an element to the nearest one, clamped to 0.75 to 1.5 times the typical distance of the neighbours, to
/// limit the effect of a wrongly located element.
fn local_spacing(gaps: &[f64], neighbours: &[usize], own: usize) -> f64 {
    let mut about: Vec<f64> = neighbours.iter().map(|&i| gaps[i]).collect();
    if about.is_empty() {
        // A single element may fill the image.
        return 0.5 * gaps[own];
    }
    let typical = median(&mut about);
    gaps[own].clamp(0.75 * typical, 1.5 * typical)
}

/// Returns indices in reading order: rows are bands with the height of half the spacing, each sorted from left to
/// right.
fn reading_order(centres: &[DVec2]) -> Vec<usize> {
    let mut gaps: Vec<f64> = nearest(centres, 1)
        .iter()
        .zip(centres)
        .filter_map(|(near, c)| near.first().map(|&i| centres[i].distance(*c)))
        .collect();
    let band = (0.5 * median(&mut gaps)).max(1.0);
    let mut order: Vec<usize> = (0..centres.len()).collect();
    order.sort_by(|&a, &b| centres[a].y.total_cmp(&centres[b].y));
    let (mut rows, mut start) = (Vec::<Vec<usize>>::new(), f64::NEG_INFINITY);
    for index in order {
        if centres[index].y - start > band {
            start = centres[index].y;
            rows.push(Vec::new());
        }
        if let Some(row) = rows.last_mut() {
            row.push(index);
        }
    }
    for row in &mut rows {
        row.sort_by(|&a, &b| centres[a].x.total_cmp(&centres[b].x));
    }
    rows.concat()
}

/// Creates warnings for elements that are too large or have too many or too few spots.
fn size_warnings(
    spots: &[Spot],
    members: &[&Vec<usize>],
    neighbours: &[Vec<usize>],
    centres: &[DVec2],
    per_element: usize,
) -> Vec<LocateWarning> {
    /// Minimum ratio of an element's area to that of its neighbours for a warning.
    const LARGE: f64 = 1.9;
    let area = |i: usize| {
        members[i]
            .iter()
            .map(|&s| spots[s].sigma.powi(2))
            .sum::<f64>()
    };
    let warning = |element: usize| {
        let actual = members[element].len();
        let merged = |times: f64| LocateWarning::Merged {
            element,
            centre_px: centres[element],
            times,
        };
        if per_element > 1 {
            let times = actual as f64 / per_element as f64;
            return if actual > per_element {
                Some(merged(times))
            } else {
                (actual < per_element).then_some(LocateWarning::Incomplete {
                    element,
                    expected: per_element,
                    actual,
                })
            };
        }
        let mut about: Vec<f64> = neighbours[element].iter().map(|&i| area(i)).collect();
        let times = area(element) / median(&mut about);
        (about.len() >= 3 && times >= LARGE).then(|| merged(times))
    };
    (0..members.len()).filter_map(warning).collect()
}

/// Creates a warning for saturated spots, or for an image with two gray levels, in which saturation cannot be detected.
fn light_warning(
    reference: &ReferencePicture,
    spots: &[Spot],
    members: &[&Vec<usize>],
) -> Option<LocateWarning> {
    if reference.two_level {
        return Some(LocateWarning::TwoLevels);
    }
    let size = (reference.width, reference.height);
    let saturated = |spot: &usize| {
        let Spot { centre, .. } = spots[*spot];
        let radius = 0.35 * spots[*spot].scale();
        let (columns, rows) = bounding_box(size, centre, radius);
        let (mut inside, mut full) = (0, 0);
        for row in rows {
            for column in columns.clone() {
                let pixel = DVec2::new(column as f64, row as f64);
                if pixel.distance(centre) <= radius.max(0.71) {
                    inside += 1;
                    full += usize::from(reference.gray[row * size.0 + column] > 254.0);
                }
            }
        }
        2 * full > inside
    };
    let elements: Vec<usize> = (0..members.len())
        .filter(|&i| 2 * members[i].iter().filter(|s| saturated(s)).count() > members[i].len())
        .collect();
    (!elements.is_empty()).then_some(LocateWarning::Saturated { elements })
}
