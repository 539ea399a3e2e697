//! What recordings name: tasks, kinds of sensing, outcomes and findings of tasks.
//!
//! Each is written as a text. A task of a user's own, or a later version, may write others.

use crate::text_enum;

text_enum! {
    /// Which task a run was of, as an experiment file names it.
    TaskKind {
        /// Turns something by strokes.
        Screw = "screw",
        /// Goes round an upright object and draws its outline.
        Contour = "contour",
        /// Slides or lifts an object along a path.
        Carry = "carry",
        /// Slides over a flat specimen and measures its friction.
        FrictionScan = "friction_scan",
        /// Touches, presses, shears and slides, to identify hand and object.
        Probe = "probe",
    }
}

text_enum! {
    /// How forces are obtained.
    SensingKind {
        /// Through camera pictures.
        Image = "image",
        /// From the simulated contact, with noise.
        Direct = "direct",
    }
}

text_enum! {
    /// What came of a task.
    TaskOutcome {
        /// The cap is closed; the outline is closed.
        Closed = "closed",
        /// The cap is open.
        Open = "open",
        /// The cap that is to be opened does not turn.
        Stuck = "stuck",
        /// The cap tightens too early or too softly.
        CrossThreaded = "cross-threaded",
        /// The cap turns without resistance.
        SpinningFreely = "spinning freely",
        /// There is no cap between the fingers.
        NoCap = "no cap",
        /// All strokes were made, and nothing shows what became of the cap.
        Undecided = "undecided",
        /// The object is at its path's end.
        Carried = "carried",
        /// The object slipped out of the fingers.
        Lost = "lost",
        /// The object does not follow the fingers.
        Blocked = "blocked",
        /// The friction is measured.
        Measured = "measured",
        /// The finger never slipped on the specimen.
        NoSlip = "no slip",
        /// The finger lost the outline.
        ContactLost = "contact lost",
        /// The outline does not come back to its beginning.
        NotClosed = "not closed",
    }
}

text_enum! {
    /// What a task found out; its unit is part of its text, if it has one.
    FindingName {
        /// Way of the object along x since it was taken, m.
        MovedX = "moved_x_m",
        /// Way of the object along y since it was taken, m.
        MovedY = "moved_y_m",
        /// Way of the object along z since it was taken, m.
        MovedZ = "moved_z_m",
        /// Angle that the object, the cap or the finger's way has turned, rad.
        Turned = "turned_rad",
        /// Force with which the fingers press, N.
        Pressing = "pressing_n",
        /// Coefficient of friction.
        Friction = "friction",
        /// The outline's newest point along x, m in `W`.
        SurfaceX = "surface_x_m",
        /// The outline's newest point along y, m in `W`.
        SurfaceY = "surface_y_m",
        /// Size of the outline along x, m.
        SizeX = "size_x_m",
        /// Size of the outline along y, m.
        SizeY = "size_y_m",
        /// Static coefficient of friction.
        StaticFriction = "static_friction",
        /// Kinetic coefficient of friction.
        KineticFriction = "kinetic_friction",
        /// Tilt of the specimen along the slide, rad.
        Tilt = "tilt",
        /// Slips that were counted.
        Slips = "slips",
        /// Torque on the cap, N·m.
        Torque = "torque_nm",
        /// Grip of the finger that grips least, N.
        Grip = "grip_n",
        /// Radius of the cap, m.
        Radius = "radius_m",
        /// Largest torque on the cap so far, N·m.
        LargestTorque = "largest_torque_nm",
        /// How the torque rises with the cap's angle, N·m/rad.
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
