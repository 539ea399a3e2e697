//! Services that stop and resume the hand of a rig, like `feeler stop` and `feeler resume`.

use feeler_console::CommandError;
use feeler_link::hand::{Ack, HandClient, Order, stop_to_resume};
use feeler_link::messages::message::HandMode;
use feeler_ros2::Node;
use feeler_ros2::message::{Trigger, TriggerResponse};
use std::sync::Arc;
use std::time::Duration;

/// Time for which an unconfirmed order is repeated before it counts as failed.
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

/// Description of the result of an order.
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
            "the hand is stopped: {} (stop {number})",
            mode.stopped
        )),
        Ack::Reverted => Err("the hand stopped, but another client resumed it at once".into()),
        Ack::None => Err("the hand did not confirm the stop".into()),
    }
}

fn resume(client: &HandClient, by: &str) -> Answered {
    let mode = client.mode();
    let Some(stop) = stop_to_resume(&mode.stops, by) else {
        return Err(match mode.stops.first() {
            Some(stop) => format!(
                "stop {} is by {}, and can be resumed only by that caller or with feeler resume --number {0}",
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
                None => Ok(format!("stop {number} was resumed")),
                Some(other) => Ok(format!(
                    "stop {number} was resumed; stop {} by {} is still in force",
                    other.number, other.by
                )),
            }
        }
        Ack::None => Err(format!(
            "the hand did not confirm the resume of stop {number}"
        )),
    }
}
