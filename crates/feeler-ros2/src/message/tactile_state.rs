//! `feeler_msgs/TactileState`, installed by the package `ros2/feeler_msgs`.

use feeler_record::NO_ELEMENT;
use feeler_record::ros::Header;
use feeler_record::tactile_array::{
    ArrayError, CONTACT, OVERLOAD, SLIP, TactileArray, names, to_recorded,
};
use feeler_record::wire::Vector3;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Tactile state of one fingertip.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TactileState {
    /// Time of the image that the forces were computed from, and the dome's frame.
    pub header: Header,
    /// Sequence number of the image.
    pub sequence: u64,
    /// TOUCH: the compression of an element is above the threshold F1, or SLIP.
    pub touch: bool,
    /// SLIP: the shear rate of an element is above the threshold dr.
    pub slip: bool,
    /// OVER: the compression of an element is above the threshold F2.
    pub over: bool,
    /// Touching element with the largest F_z, or [`NO_ELEMENT`](feeler_record::NO_ELEMENT).
    pub largest_element: u32,
    /// Grasp force: sum of the positive F_z (N).
    pub grasp_force: f64,
    /// Force on each element in its frame `E_i` (N), or NaN if unknown. x and y are the tangential force on the feeler
    /// by the object; z is the compression, positive when pressed.
    pub forces: Vec<Vector3>,
    /// Shear rate |d(F_x, F_y)/dt| of each element (N/s).
    pub shear_rate: Vec<f64>,
    /// `true` for each element that slips.
    pub slips: Vec<bool>,
}

ros_message!(
    TactileState,
    "feeler_msgs/msg/TactileState",
    include_str!("../../msg/feeler_msgs/TactileState.msg"),
    "std_msgs/Header",
    "builtin_interfaces/Time",
    "geometry_msgs/Vector3",
);

impl TactileState {
    /// Converts an array to a tactile state. TOUCH, SLIP and OVER follow from the contact of the elements, and shear
    /// rates are 0 if the array contains none. Geometry, sensor, rate, thresholds, variances and saturation are lost;
    /// invalid forces become NaN.
    ///
    /// # Errors
    /// If the array is invalid or has no forces in newtons.
    pub fn from_array(array: &TactileArray) -> Result<Self, ArrayError> {
        let forces = to_recorded(array)?.forces;
        let has = |bit: u8| array.contact.iter().any(move |bits| bits & bit != 0);
        let is = |element: usize, bit| array.contact.get(element).is_some_and(|b| b & bit != 0);
        let touching = (0..forces.len())
            .filter(|&element| is(element, CONTACT | SLIP) && forces[element].z.is_finite());
        let largest = touching.max_by(|&a, &b| forces[a].z.total_cmp(&forces[b].z));
        let rates = array.channel(names::SHEAR_RATE);
        let rates = rates.map_or(&[][..], |channel| &channel.values);
        let rate = |element| rates.get(element).copied().unwrap_or_default();
        Ok(Self {
            header: array.header.clone(),
            sequence: array.sequence,
            touch: has(CONTACT | SLIP),
            slip: has(SLIP),
            over: has(OVERLOAD),
            largest_element: largest.map_or(NO_ELEMENT, |element| element as u32),
            grasp_force: forces.iter().map(|force| force.z.max(0.0)).sum(),
            shear_rate: (0..forces.len()).map(rate).collect(),
            slips: (0..forces.len()).map(|element| is(element, SLIP)).collect(),
            forces,
        })
    }

    /// Converts a tactile state to an array. Its geometry, rate and thresholds are those of `sensor`, such as
    /// [`of_finger`](feeler_record::tactile_array::of_finger).
    ///
    /// # Errors
    /// If the number of elements differs from that of `sensor`.
    pub fn to_array(&self, sensor: &TactileArray) -> Result<TactileArray, ArrayError> {
        let mut array = sensor.clone();
        let forces = self.forces.iter().map(|&force| DVec3::from(force));
        let Header { stamp, .. } = self.header;
        array.set_sample(stamp, self.sequence, forces, &self.shear_rate);
        array.header = self.header.clone();
        for (bits, slips) in array.contact.iter_mut().zip(&self.slips) {
            *bits = (*bits & !SLIP) | if *slips { SLIP } else { 0 };
        }
        array.check()?;
        Ok(array)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feeler_record::tactile_array::TactileChannel;
    use feeler_record::wire::Quaternion;

    fn sensor() -> TactileArray {
        let channel = |name: &str, unit: &str, components| TactileChannel {
            name: name.into(),
            unit: unit.into(),
            components,
            ..TactileChannel::default()
        };
        TactileArray {
            positions: vec![Vector3::default(); 3],
            orientations: vec![Quaternion::default(); 3],
            channels: vec![
                channel(names::FORCE, "N", 3),
                channel(names::SHEAR_RATE, "N/s", 1),
            ],
            contact_threshold: 0.1,
            slip_threshold: 2.0,
            overload_threshold: 0.5,
            ..TactileArray::default()
        }
    }

    fn state() -> TactileState {
        let force = |x, z| Vector3 { x, y: 0.25, z };
        TactileState {
            header: Header::of("finger_0_dome"),
            sequence: 9,
            touch: true,
            slip: true,
            over: true,
            largest_element: 2,
            grasp_force: 0.95,
            forces: vec![force(0.0, 0.05), force(-0.5, 0.2), force(0.5, 0.7)],
            shear_rate: vec![0.0, 3.0, 1.0],
            slips: vec![false, true, false],
        }
    }

    #[test]
    fn states_return_unchanged() {
        let array = state().to_array(&sensor()).expect("an array");
        assert_eq!(array.contact, [0, CONTACT | SLIP, CONTACT | OVERLOAD]);
        let mut back = TactileState::from_array(&array).expect("a state");
        assert!((back.grasp_force - 0.95).abs() < 1e-15);
        back.grasp_force = 0.95;
        assert_eq!(back, state());
    }

    #[test]
    fn untouched_states_have_no_largest_element() {
        let free = TactileState {
            forces: vec![Vector3::default(); 3],
            shear_rate: vec![0.0; 3],
            slips: vec![false; 3],
            largest_element: NO_ELEMENT,
            ..TactileState::default()
        };
        let array = free.to_array(&sensor()).expect("an array");
        assert_eq!(TactileState::from_array(&array), Ok(free));
    }

    #[test]
    fn states_of_other_sensors_are_rejected() {
        let mut state = state();
        state.forces.pop();
        assert!(state.to_array(&sensor()).is_err());
    }
}
