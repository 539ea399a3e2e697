//! Readings of an emulated skin.

use feeler::sensor::skin::SkinProtocol;
use feeler::sensor::taxel::TaxelLayout;
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64;

/// Radius at which the effect of a press has decreased to 1/e, m: about the distance of the chips of a magnetic skin.
const RADIUS: f64 = 0.007;
/// Tangential part of a press, along x of the element, as a fraction of the press.
const SHEAR: f64 = 0.2;
/// Maximum magnitude of noise, counts.
const NOISE: f64 = 1.0;

/// Skin that reports a constant background, noise, a press in its middle and a uniform field.
#[derive(Debug)]
pub struct SimulatedSkin {
    protocol: SkinProtocol,
    /// Values of each taxel at rest, in the taxel's columns x, y, z.
    rest: Vec<DVec3>,
    /// Values of each taxel for a press of 1 count, in the taxel's columns.
    pressed: Vec<DVec3>,
    /// Values of each taxel in a uniform field of 1 µT along x, y and z, in the taxel's columns.
    fields: Vec<[DVec3; 3]>,
    /// Strength of the press: its contribution to the reading of the nearest taxel, counts.
    pub press: f64,
    /// Uniform field, µT.
    pub field: DVec3,
}

impl SimulatedSkin {
    pub fn new(layout: &TaxelLayout, protocol: SkinProtocol) -> Self {
        let places: Vec<_> = layout.elements().map(|(_, place)| place).collect();
        let middle = places.iter().sum::<DVec3>() / places.len().max(1) as f64;
        let nearest = places.iter().map(|place| place.distance(middle));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        let share = |place: &DVec3| {
            let distance = (place.distance(middle) - nearest) / RADIUS;
            (-distance * distance).exp()
        };
        let shear = if protocol.has_shear() { SHEAR } else { 0.0 };
        let taxels = || places.iter().enumerate();
        Self {
            protocol,
            rest: taxels()
                .map(|(taxel, _)| at_rest(protocol, taxel))
                .collect(),
            pressed: taxels()
                .map(|(taxel, place)| {
                    layout.in_columns(taxel, share(place) * DVec3::new(shear, 0.0, 1.0))
                })
                .collect(),
            fields: taxels()
                .map(|(taxel, _)| DVec3::AXES.map(|axis| layout.in_columns(taxel, axis)))
                .collect(),
            press: 0.0,
            field: DVec3::ZERO,
        }
    }

    /// Writes the current values of each taxel to `values`, in the taxel's columns.
    pub fn read(&self, random: &mut Pcg64, values: &mut Vec<DVec3>) {
        values.clear();
        for ((&rest, &pressed), [x, y, z]) in self.rest.iter().zip(&self.pressed).zip(&self.fields)
        {
            let field = match self.protocol {
                SkinProtocol::Magnetometers => {
                    *x * self.field.x + *y * self.field.y + *z * self.field.z
                }
                SkinProtocol::Flexitac | SkinProtocol::Paxini => DVec3::ZERO,
            };
            let noise = match self.protocol {
                // Their modules filter it.
                SkinProtocol::Paxini => DVec3::ZERO,
                _ => DVec3::from_array([(); 3].map(|()| random.random_range(-NOISE..NOISE))),
            };
            values.push(rest + self.press * pressed + field + noise);
        }
    }
}

/// Returns the values of an untouched taxel: the flux of the magnets, or a small pressure.
fn at_rest(protocol: SkinProtocol, taxel: usize) -> DVec3 {
    let step = taxel as f64;
    match protocol {
        SkinProtocol::Magnetometers => DVec3::new(120.0 - 35.0 * step, 60.0 * step - 90.0, 900.0),
        SkinProtocol::Flexitac => DVec3::new(0.0, 0.0, 10.0 + (7 * taxel % 20) as f64),
        SkinProtocol::Paxini => DVec3::ZERO,
    }
}
