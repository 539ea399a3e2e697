//! A hand that executes commands exactly.

use feeler::hand::{Hand, HandCommand, HandError, HandState, JointState, JointVector};

/// A hand that executes commands exactly. It keeps no record and does not allocate.
pub struct IdealHand {
    pub stamp: f64,
    pub period: f64,
    pub joints: Vec<JointState>,
}

impl IdealHand {
    /// Creates a hand at rest with the joint angles `home` (rad) that is commanded every `period` (s).
    pub fn new(home: Vec<JointVector>, period: f64) -> Self {
        let at_rest = |position| JointState {
            position,
            velocity: JointVector::zeros(3),
        };
        Self {
            stamp: 0.0,
            period,
            joints: home.into_iter().map(at_rest).collect(),
        }
    }
}

impl Hand for IdealHand {
    fn finger_count(&self) -> usize {
        self.joints.len()
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        state.stamp = self.stamp;
        state.joints.copy_from_slice(&self.joints);
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        for (joints, &velocity) in self.joints.iter_mut().zip(command.joint_velocity()) {
            joints.position += self.period * velocity;
            joints.velocity = velocity;
        }
        self.stamp += self.period;
        Ok(())
    }
}
