//! State of a rig for `/diagnostics`.

use feeler_ros2::message::{DiagnosticLevel, DiagnosticStatus, KeyValue};
use feeler_watch::{Program, ProgramState, Snapshot};

/// Returns one status for the hand and one for each program.
pub fn diagnostics(snapshot: &Snapshot, node: &str) -> Vec<DiagnosticStatus> {
    let programs = snapshot
        .programs
        .iter()
        .map(|program| of_program(program, node));
    std::iter::once(of_hand(snapshot, node))
        .chain(programs)
        .collect()
}

fn of_hand(snapshot: &Snapshot, node: &str) -> DiagnosticStatus {
    let fault = snapshot.fault.as_ref().filter(|fault| !fault.over);
    let (level, message) = match (fault, snapshot.task) {
        (Some(fault), _) => (DiagnosticLevel::Error, fault.words.clone()),
        (None, None) => (DiagnosticLevel::Stale, "no hand found".into()),
        (None, _) if !snapshot.notice.is_empty() => {
            (DiagnosticLevel::Warn, snapshot.notice.clone())
        }
        (None, Some(task)) => (DiagnosticLevel::Ok, task.phase.to_string()),
    };
    let task = snapshot.task.map(|task| {
        [
            ("phase", task.phase.to_string()),
            ("stroke", task.stroke.to_string()),
        ]
    });
    let torque = snapshot
        .torque
        .as_ref()
        .map(|t| ("torque, N m", t.newest.to_string()));
    let forces = snapshot.fingers.iter().map(|finger| {
        (
            ["grasp force of finger ", &finger.number.to_string(), ", N"].concat(),
            finger.flags.grasp_force,
        )
    });
    let values = task
        .into_iter()
        .flatten()
        .chain(torque)
        .map(|(key, value)| KeyValue {
            key: key.into(),
            value,
        });
    let forces = forces.map(|(key, value)| KeyValue {
        key,
        value: value.to_string(),
    });
    status(
        level,
        format!("{node}: hand"),
        message,
        values.chain(forces).collect(),
    )
}

fn of_program(program: &Program, node: &str) -> DiagnosticStatus {
    let name = match program.finger {
        Some(finger) => format!("{node}: {} of finger {finger}", program.name),
        None => format!("{node}: {} program", program.name),
    };
    let (level, message) = match &program.state {
        ProgramState::Alive => (DiagnosticLevel::Ok, "receiving data".to_string()),
        ProgramState::Silent => (DiagnosticLevel::Stale, "no data".to_string()),
        ProgramState::Refused { why } => (DiagnosticLevel::Error, format!("refused: {why}")),
    };
    let values = [
        ("version", program.version.clone()),
        ("rate, Hz", program.rate.to_string()),
        ("age, s", program.age.to_string()),
        ("messages lost", program.lost.to_string()),
    ];
    let values = values.map(|(key, value)| KeyValue {
        key: key.into(),
        value,
    });
    status(level, name, message, values.into())
}

/// Creates a status. Its name begins with that of the node, as aggregators expect.
pub fn status(
    level: DiagnosticLevel,
    name: String,
    message: String,
    values: Vec<KeyValue>,
) -> DiagnosticStatus {
    DiagnosticStatus {
        level: level as u8,
        name,
        message,
        hardware_id: String::new(),
        values,
    }
}
