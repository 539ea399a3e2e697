//! Reads a finger from a URDF file, the robot description format of ROS.
//!
//! A finger with the key `urdf` is replaced by the chain of joints from `base` (default: the root link) to the link `tip`
//! before the experiment is parsed, so that recordings contain the whole geometry.

mod robot;

use super::error::ConfigError;
use super::read::read;
use robot::chain;
use serde::Serialize;
use std::path::Path;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Replaces the key `urdf` of each finger in `document` by `joints` and `frames` of the chain in that file. Paths are
/// relative to `folder`. Returns `true` if any finger had this key.
///
/// # Errors
/// If a file cannot be read, is not URDF, or has no chain to the fingertip.
pub(super) fn resolve(
    document: &mut DocumentMut,
    folder: Option<&Path>,
) -> Result<bool, ConfigError> {
    let hand = document.get_mut("hand");
    let fingers: Vec<&mut dyn TableLike> = match hand.and_then(|hand| hand.get_mut("finger")) {
        Some(Item::ArrayOfTables(tables)) => tables
            .iter_mut()
            .map(|table| table as &mut dyn TableLike)
            .collect(),
        Some(Item::Value(Value::Array(values))) => {
            let tables = values.iter_mut().filter_map(Value::as_inline_table_mut);
            tables.map(|table| table as &mut dyn TableLike).collect()
        }
        _ => Vec::new(),
    };
    let mut any = false;
    for (index, finger) in fingers.into_iter().enumerate() {
        any |= resolve_finger(index, finger, folder)?;
    }
    Ok(any)
}

fn resolve_finger(
    index: usize,
    finger: &mut dyn TableLike,
    folder: Option<&Path>,
) -> Result<bool, ConfigError> {
    let refused = |message: String| ConfigError::Urdf {
        key: format!("hand.finger[{index}]"),
        message,
    };
    if !finger.contains_key("urdf") {
        return Ok(false);
    }
    let mut take = |name: &str| match finger.remove(name) {
        None => Ok(None),
        Some(item) => match item.as_str() {
            Some(text) => Ok(Some(text.to_string())),
            None => Err(refused(format!(
                "{name}: expected text, got {}",
                item.type_name()
            ))),
        },
    };
    let (file, base, tip) = (take("urdf")?, take("base")?, take("tip")?);
    let tip =
        tip.ok_or_else(|| refused("expected tip, the name of the fingertip's link".into()))?;
    let path = folder
        .unwrap_or(Path::new(""))
        .join(file.unwrap_or_default());
    let text = read(&path, "a robot description (URDF)")?;
    let chain = chain(&text, base.as_deref(), &tip);
    let chain = chain.map_err(|message| refused(format!("{}: {message}", path.display())))?;
    for (name, value) in [
        ("joints", toml(&chain.joints)),
        ("frames", toml(&chain.frames)),
    ] {
        if finger.contains_key(name) {
            return Err(refused(format!("expected either urdf or {name}, got both")));
        }
        finger.insert(name, Item::Value(value));
    }
    Ok(true)
}

/// Converts a list of tables.
fn toml(list: &impl Serialize) -> Value {
    // Every value has a TOML equivalent.
    let text = toml::Value::try_from(list).map(|value| value.to_string());
    let value = text.ok().and_then(|text| text.parse().ok());
    value.unwrap_or_else(|| Value::Array(Default::default()))
}
