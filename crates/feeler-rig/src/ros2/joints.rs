//! Serves the joints of a ROS 2 robot as the joints of a rig.

use feeler::hand::{Hand, HandCommand, HandError, HandState};
use feeler_console::Warnings;
use feeler_link::messages::message::InstrumentsMessage;
use feeler_link::programs::Rig;
use feeler_ros2::RosHand;
use std::time::{Duration, Instant};

/// Time to wait for the first joint states before a message is printed, and between two reports of failed commands.
const PATIENCE: Duration = Duration::from_secs(2);

/// A robot's joints. The rig's time is the graph's time since the first joint states. The age of a command follows
/// from the stamps of the joint states that it is based on.
pub struct RobotRig {
    hand: RosHand,
    /// Time of the ROS graph (s) at which the rig's time was 0.
    began: Option<f64>,
    warnings: Warnings,
    /// Start of the current gap in the joint states, and `true` if it was reported. `None` while joint states arrive.
    lost: Option<(Instant, bool)>,
    /// Latest failure of a command that is not reported yet.
    failure: Option<String>,
    /// Time of the last report of a failure.
    reported: Option<Instant>,
}

impl RobotRig {
    /// Serves the joints of `hand`, and reports when joint states stop or resume.
    pub fn new(hand: RosHand, warnings: Warnings) -> Self {
        Self {
            hand,
            began: None,
            warnings,
            lost: None,
            failure: None,
            reported: None,
        }
    }

    /// Prints a message when joint states stop or resume.
    fn tell(&mut self, read: &Result<(), HandError>) {
        let (since, is_told) = self.lost.unwrap_or((Instant::now(), false));
        self.lost = match read {
            Ok(()) => {
                if is_told {
                    self.warnings.queue("receiving the robot's joint states");
                }
                None
            }
            // Discovery in the graph takes a moment.
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
        // Without a clock nothing can be read, so nothing moves.
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
        let commanded = self.hand.command(command);
        // Lost joint states are reported when they are read.
        if let (Err(error), None) = (&commanded, self.lost) {
            self.failure = Some(error.to_string());
        }
        let is_early = self.reported.is_some_and(|at| at.elapsed() < PATIENCE);
        if let Some(error) = self.failure.take_if(|_| !is_early) {
            self.reported = Some(Instant::now());
            self.warnings
                .queue(&format!("the robot was not moved: {error}"));
        }
        commanded
    }
}
