//! The services that stop and resume the hand of a rig, as `feeler stop` and `feeler resume` do.

use feeler_console::CommandError;
use feeler_link::hand_client::{Ack, HandClient};
use feeler_link::message::HandMode;
use feeler_link::order::{Order, stop_to_resume};
use feeler_ros2::message::{Trigger, TriggerResponse};
use feeler_ros2::node::Node;
use std::sync::Arc;
use std::time::Duration;

/// How long an order is said before it is told that the hand does not heed it.
const LONGEST: Duration = Duration::from_secs(3);

/// Serves `/stop` and `/resume` of the hand that `client` calls.
pub fn serve_orders(node: &mut Node, client: HandClient) -> Result<(), CommandError> {
    let client = Arc::new(client);
    let by = format!("the ROS 2 node {}", node.name());
    let (stopping, stopped_by) = (Arc::clone(&client), by.clone());
    node.serve::<Trigger>("stop", move |_| response(stop(&stopping, &stopped_by)))?;
    node.serve::<Trigger>("resume", move |_| response(resume(&client, &by)))?;
    Ok(())
}

/// What came of an order, in words.
type Answered = Result<String, String>;

fn response(answered: Answered) -> TriggerResponse {
    let success = answered.is_ok();
    let (Ok(message) | Err(message)) = answered;
    TriggerResponse { success, message }
}

fn stop(client: &HandClient, by: &str) -> Answered {
    let (order, id) = Order::stop(by);
    let is_so = |mode: &HandMode| {
        let holds = mode.stops.iter().any(|stop| stop.id == id);
        holds && (mode.is_waiting() || !mode.stopped.is_empty())
    };
    let heeded = client
        .order(&order, LONGEST, is_so)
        .map_err(|e| e.to_string())?;
    let mode = client.mode();
    let number = mode
        .stops
        .iter()
        .find(|stop| stop.id == id)
        .map_or(0, |stop| stop.number);
    match heeded {
        Ack::Stable => Ok(format!(
            "the hand stands still: {} (stop {number})",
            mode.stopped
        )),
        Ack::Reverted => Err("the hand stood still, and somebody resumed it at once".into()),
        Ack::None => Err("the hand was told to stop, but does not say that it does".into()),
    }
}

fn resume(client: &HandClient, by: &str) -> Answered {
    let mode = client.mode();
    let Some(stop) = stop_to_resume(&mode.stops, by) else {
        return Err(match mode.stops.first() {
            Some(stop) => format!(
                "stop {} is by {}, who alone resumes it, or feeler resume --number {0}",
                stop.number, stop.by
            ),
            None => "the hand is not stopped".into(),
        });
    };
    let number = stop.number;
    let order = Order::resume(by, number);
    let is_so = |mode: &HandMode| mode.stops.iter().all(|stop| stop.number != number);
    match client
        .order(&order, LONGEST, is_so)
        .map_err(|e| e.to_string())?
    {
        Ack::Stable | Ack::Reverted => {
            let mode = client.mode();
            match mode.stops.first() {
                None => Ok(format!("stop {number} is resumed")),
                Some(other) => Ok(format!(
                    "stop {number} is resumed; stop {} by {} is in force",
                    other.number, other.by
                )),
            }
        }
        Ack::None => Err(format!(
            "the hand does not say that stop {number} is resumed"
        )),
    }
}
