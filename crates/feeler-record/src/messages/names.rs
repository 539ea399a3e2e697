//! Names in recordings: tasks, kinds of sensing, outcomes and findings of tasks.
//!
//! They are written as text. User-defined tasks and later versions may write other names.

use crate::text_enum;

text_enum! {
    /// Task of a run, as named in an experiment file.
    TaskKind {
        /// Turns an object by strokes.
        Screw = "screw",
        /// Moves around an upright object and traces its outline.
        Contour = "contour",
        /// Slides or lifts an object along a path.
        Carry = "carry",
        /// Holds an object while an arm carries it.
        Grip = "grip",
        /// Slides over a flat specimen and measures its friction.
        FrictionScan = "friction_scan",
        /// Touches, presses, shears and slides on an object to identify hand and object.
        Probe = "probe",
    }
}

text_enum! {
    /// Source of the forces.
    SensingKind {
        /// Computed from camera images.
        Image = "image",
        /// Taken from the simulated contact, with noise.
        Direct = "direct",
    }
}

text_enum! {
    /// Outcome of a task.
    TaskOutcome {
        /// The cap or the outline is closed.
        Closed = "closed",
        /// The cap is open.
        Open = "open",
        /// The cap to be opened does not turn.
        Stuck = "stuck",
        /// The cap tightens too early or too softly.
        CrossThreaded = "cross-threaded",
        /// The cap turns without resistance.
        SpinningFreely = "spinning freely",
        /// No cap was found between the fingers.
        NoCap = "no cap",
        /// All strokes were made, but the state of the cap could not be determined.
        Undecided = "undecided",
        /// The object reached the end of its path.
        Carried = "carried",
        /// The object was put down and let go.
        PutDown = "put down",
        /// The object slipped out of the fingers.
        Lost = "lost",
        /// The object does not follow the fingers.
        Blocked = "blocked",
        /// The friction was measured.
        Measured = "measured",
        /// The finger never slipped on the specimen.
        NoSlip = "no slip",
        /// The finger lost the outline.
        ContactLost = "contact lost",
        /// The outline did not return to its start.
        NotClosed = "not closed",
    }
}

text_enum! {
    /// A finding of a task. Its text includes the unit, if any.
    FindingName {
        /// Displacement of the object along x since it was grasped (m).
        MovedX = "moved_x_m",
        /// Displacement of the object along y since it was grasped (m).
        MovedY = "moved_y_m",
        /// Displacement of the object along z since it was grasped (m).
        MovedZ = "moved_z_m",
        /// Rotation of the object, the cap or the finger's path (rad).
        Turned = "turned_rad",
        /// Force with which the fingers press (N).
        Pressing = "pressing_n",
        /// Force that a finger carries by friction (N).
        Load = "load_n",
        /// Coefficient of friction.
        Friction = "friction",
        /// Latest point of the outline along x, in `W` (m).
        SurfaceX = "surface_x_m",
        /// Latest point of the outline along y, in `W` (m).
        SurfaceY = "surface_y_m",
        /// Size of the outline along x (m).
        SizeX = "size_x_m",
        /// Size of the outline along y (m).
        SizeY = "size_y_m",
        /// Static coefficient of friction.
        StaticFriction = "static_friction",
        /// Kinetic coefficient of friction.
        KineticFriction = "kinetic_friction",
        /// Tilt of the specimen along the slide (rad).
        Tilt = "tilt",
        /// Number of slips.
        Slips = "slips",
        /// Torque on the cap (N·m).
        Torque = "torque_nm",
        /// Smallest grip of all fingers (N).
        Grip = "grip_n",
        /// Radius of the cap (m).
        Radius = "radius_m",
        /// Largest torque on the cap so far (N·m).
        LargestTorque = "largest_torque_nm",
        /// Slope of the torque over the cap's angle (N·m/rad).
        Stiffness = "stiffness_nm_per_rad",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn texts_are_kept_whether_known_or_not() {
        for (text, expected) in [
            ("no slip", TaskOutcome::NoSlip),
            ("closed", TaskOutcome::Closed),
            ("", TaskOutcome::Other(String::new())),
            ("Closed", TaskOutcome::Other("Closed".into())),
        ] {
            let outcome = TaskOutcome::from(text);
            assert!(
                matches!(outcome, TaskOutcome::Other(_))
                    == matches!(expected, TaskOutcome::Other(_))
            );
            assert_eq!(outcome, expected);
            assert_eq!(outcome.to_string(), text);
            assert_eq!(String::from(outcome.clone()), text);
            let json = serde_json::to_string(&outcome).expect("JSON");
            assert_eq!(json, format!("{text:?}"));
            let again: TaskOutcome = serde_json::from_str(&json).expect("an outcome");
            assert_eq!(again, outcome);
        }
    }

    #[test]
    fn findings_are_in_the_order_of_their_texts() {
        let found = BTreeMap::from([
            (FindingName::Turned, 1.0),
            (FindingName::from("apex"), 2.0),
            (FindingName::Torque, 3.0),
        ]);
        let json = serde_json::to_string(&found).expect("JSON");
        assert_eq!(json, r#"{"apex":2.0,"torque_nm":3.0,"turned_rad":1.0}"#);
    }
}
