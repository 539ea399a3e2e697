//! The joints of a robot as those of a rig.

use feeler::hand::{Hand, HandCommand, HandError, HandState};
use feeler_console::Warnings;
use feeler_link::message::InstrumentsMessage;
use feeler_link::programs::Rig;
use feeler_ros2::ros_hand::RosHand;
use std::time::{Duration, Instant};

/// Who waits for so long for a robot wants to know why.
const PATIENCE: Duration = Duration::from_secs(2);

/// A robot's joints. The rig's time is that of the graph, from when they were first read: a command is as old as the stamps of the joint
/// states say that it was made from.
pub struct RobotRig {
    hand: RosHand,
    /// The graph's time at the rig's time 0, s.
    began: Option<f64>,
    warnings: Warnings,
    /// Since when there are no joint states, and whether that was said; none while there are.
    lost: Option<(Instant, bool)>,
}

impl RobotRig {
    /// Serves the joints of `hand`; says when they are lost and found.
    pub fn new(hand: RosHand, warnings: Warnings) -> Self {
        Self {
            hand,
            began: None,
            warnings,
            lost: None,
        }
    }

    /// Says what is new of whether there are joint states.
    fn tell(&mut self, read: &Result<(), HandError>) {
        let (since, is_told) = self.lost.unwrap_or((Instant::now(), false));
        self.lost = match read {
            Ok(()) => {
                if is_told {
                    self.warnings.queue("the robot's joint states are there");
                }
                None
            }
            // Before the first ones, a graph needs a moment.
            Err(_) if self.began.is_none() && since.elapsed() < PATIENCE => Some((since, false)),
            Err(error) => {
                if !is_told {
                    self.warnings
                        .queue(&format!("waiting for the robot: {error}"));
                }
                Some((since, true))
            }
        };
    }
}

impl Rig for RobotRig {
    fn finger_count(&self) -> usize {
        self.hand.finger_count()
    }

    fn time(&self) -> f64 {
        // Without a clock nothing can be read, and so nothing moves.
        let now = self.hand.now().ok();
        now.zip(self.began).map_or(0.0, |(now, began)| now - began)
    }

    fn read(&mut self, state: &mut HandState) -> Result<Option<InstrumentsMessage>, HandError> {
        let read = self.hand.read(state);
        self.tell(&read);
        read?;
        state.stamp -= *self.began.get_or_insert(state.stamp);
        Ok(None)
    }

    fn advance(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.hand.command(command)
    }
}
