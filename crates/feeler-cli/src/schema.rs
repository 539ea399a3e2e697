//! The `feeler schema` subcommand.

use super::{CommandError, Outcome};
use feeler_link::messages::message as linked;
use feeler_link::transport::{ProgramRole, Topic};
use feeler_record::sensed::MOMENTS;
use feeler_record::wire::Message;
use feeler_record::{RecordedTopic, topics};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Message to print, e.g. TactileUpdate or feeler_msgs/msg/TactileUpdate [default: all]
    ///
    /// A single message is printed without a heading, for use by other programs. Without a name, each message follows
    /// a line with its name and topic.
    name: Option<String>,
}

/// Name, text and topic of a message type.
struct Schema {
    name: &'static str,
    text: &'static str,
    place: String,
}

impl Schema {
    fn recorded<M: Message>(topic: RecordedTopic<M>) -> Self {
        Self {
            name: M::SCHEMA_NAME,
            text: M::SCHEMA,
            place: format!("recorded as {}", of_any_finger(&topic.name())),
        }
    }

    fn linked<M: Message>(topic: Topic) -> Self {
        Self {
            name: M::SCHEMA_NAME,
            text: M::SCHEMA,
            place: format!("linked as {}", of_any_finger(&topic.key("RIG"))),
        }
    }

    fn is_called(&self, name: &str) -> bool {
        let short = self.name.rsplit('/').next();
        self.name == name || short == Some(name)
    }
}

/// Prints the ROS 2 definitions of recorded and network messages.
pub fn schema(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let schemas = recorded().into_iter().chain(linked());
    let Some(name) = &arguments.name else {
        for Schema { name, text, place } in schemas {
            writeln!(out, "#### {name}, {place}\n{text}")?;
        }
        return Ok(Outcome::Done);
    };
    let schemas: Vec<_> = schemas.collect();
    let Some(schema) = schemas.iter().find(|schema| schema.is_called(name)) else {
        let names: Vec<_> = schemas.iter().map(|schema| schema.name).collect();
        return Err(format!(
            "unknown message {name:?}; expected one of {}",
            names.join(", ")
        )
        .into());
    };
    write!(out, "{}", schema.text)?;
    Ok(Outcome::Done)
}

fn recorded() -> [Schema; 24] {
    [
        Schema::recorded(topics::tactile(0)),
        Schema::recorded(topics::samples(0)),
        Schema::recorded(topics::flags(0)),
        Schema::recorded(topics::joints(0)),
        Schema::recorded(topics::efforts(0)),
        Schema::recorded(topics::command(0)),
        Schema::recorded(topics::fingertip(0)),
        Schema::recorded(topics::TORQUE_SENSOR),
        Schema::recorded(topics::CAP),
        Schema::recorded(topics::TASK),
        Schema::recorded(topics::FINDINGS),
        Schema::recorded(topics::OBJECT),
        Schema::recorded(topics::TRUE_SLIP),
        Schema::recorded(topics::FELT),
        Schema::recorded(topics::RECORDING_GAP),
        Schema::recorded(topics::image(0)),
        Schema::recorded(topics::TF),
        Schema::recorded(topics::TF_STATIC),
        Schema::recorded(topics::ROBOT_DESCRIPTION),
        Schema::recorded(topics::JOINT_STATES),
        Schema::recorded(topics::SCENE),
        Schema::recorded(topics::wrench(0)),
        Schema::recorded(topics::taxels(0)),
        Schema::recorded(MOMENTS),
    ]
}

fn linked() -> [Schema; 9] {
    [
        Schema::linked::<linked::TactileUpdate>(Topic::Tactile(0)),
        Schema::linked::<linked::PictureMessage>(Topic::Picture(0)),
        Schema::linked::<linked::DirectForces>(Topic::DirectForces(0)),
        Schema::linked::<linked::HandMode>(Topic::Mode),
        Schema::linked::<linked::CommandMessage>(Topic::Command),
        Schema::linked::<linked::StateMessage>(Topic::State),
        Schema::linked::<linked::Heartbeat>(Topic::Heartbeat(ProgramRole::Hand)),
        Schema::linked::<linked::StopMessage>(Topic::Stop),
        Schema::linked::<linked::ResumeMessage>(Topic::Resume),
    ]
}

/// Replaces the finger's number 0 in `topic` by N, and the name of the program's role by PLACE.
fn of_any_finger(topic: &str) -> String {
    let topic = topic.replace("finger/0/", "finger/N/");
    topic.replace("heartbeat/hand", "heartbeat/PLACE")
}
