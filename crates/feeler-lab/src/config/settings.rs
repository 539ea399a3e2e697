//! Applies settings from the command line, such as `control.slip_threshold=2.5`, to the text of an experiment.

use super::error::ConfigError;
use super::experiment_config::ExperimentConfig;
use toml_edit::{DocumentMut, Item, Value};

/// Sets `key.path=value` in a document. Numbers in the path index arrays. A list that is missing in `document` is first
/// copied from `full`, the document with all defaults, so that one entry of it can be set.
/// Unknown keys are detected later, when the document is deserialized.
pub(super) fn put(
    document: &mut DocumentMut,
    full: Option<&DocumentMut>,
    setting: &str,
) -> Result<(), ConfigError> {
    let error = |message: String| ConfigError::Setting {
        setting: setting.to_string(),
        message,
    };
    let (key, value) = setting
        .split_once('=')
        .ok_or_else(|| error("expected key=value, as in control.slip_threshold=2.5".into()))?;
    let mut item = document.as_item_mut();
    let mut full = full.map(DocumentMut::as_item);
    let mut path = String::new();
    for part in key.trim().split('.').map(str::trim) {
        full = full.and_then(|full| full.get(part));
        if let Some(list) = full.filter(|full| full.is_array() || full.is_array_of_tables()) {
            insert_missing(item, part, list);
        }
        item = step_into(item, part).map_err(|problem| error(format!("{path}{problem}")))?;
        path = format!("{path}{part}.");
    }
    let value = value.trim();
    // A value that is not TOML is taken as a string, so that --set sensing=direct needs no quotes.
    let parsed = value.parse().unwrap_or_else(|_| Value::from(value));
    let comment = item.as_value().map(|old| old.decor().clone());
    *item = Item::Value(parsed);
    if let (Some(value), Some(decor)) = (item.as_value_mut(), comment) {
        *value.decor_mut() = decor;
    }
    Ok(())
}

/// Inserts `value` into a table under the key `part` unless the key exists.
fn insert_missing(item: &mut Item, part: &str, value: &Item) {
    if item.is_none() {
        *item = Item::Table(toml_edit::Table::new());
    }
    let Some(table) = item.as_table_like_mut() else {
        return;
    };
    if !table.contains_key(part) {
        table.insert(part, value.clone());
    }
}

/// Returns the item under key `part` of a table or at index `part` of an array, or an error message.
fn step_into<'a>(item: &'a mut Item, part: &str) -> Result<&'a mut Item, String> {
    let count = match &*item {
        Item::ArrayOfTables(tables) => Some(tables.len()),
        other => other.as_array().map(toml_edit::Array::len),
    };
    if let Some(count) = count {
        let found = part.parse::<usize>().ok().and_then(|i| item.get_mut(i));
        let last = count.saturating_sub(1);
        return found
            .ok_or_else(|| format!("{part}: there is no such entry; expected 0 to {last}"));
    }
    // A missing key may be one that has a default.
    if item.is_none() {
        *item = Item::Table(toml_edit::Table::new());
    }
    let table = item.as_table_like_mut();
    let entry = table.map(|table| table.entry(part).or_insert(Item::None));
    entry.ok_or_else(|| format!("{part}: there is no such key; its parent is a single value"))
}

/// Returns a valid `text` with all defaults spelled out if any of `settings` indexes a list, else `None`.
pub(super) fn with_defaults(text: &str, settings: &[String]) -> Option<DocumentMut> {
    let is_index = |part: &str| part.trim().parse::<usize>().is_ok();
    let key = |setting: &'_ String| setting.split('=').next().map(str::to_string);
    let mut keys = settings.iter().filter_map(key);
    keys.any(|key| key.split('.').any(is_index)).then_some(())?;
    let config: ExperimentConfig = toml::from_str(text).ok()?;
    toml::to_string(&config).ok()?.parse().ok()
}
