//! Settings as trees of TOML and JSON values.

use crate::suggestion::nearest;
use crate::{ConfigError, UserSettings};
use serde::de::Unexpected;
use serde_json::Value as Json;
use toml::{Table, Value};

/// Flattens the given values to dotted names.
pub(crate) fn settings_in<'a>(tree: &'a Table, prefix: &str, known: &[String]) -> Vec<(String, &'a Value)> {
    let leaf = |(name, value): (&String, &'a Value)| {
        let key = format!("{prefix}{name}");
        match value {
            Value::Table(inner) if !known.contains(&key) => settings_in(inner, &format!("{key}."), known),
            _ => vec![(key, value)],
        }
    };
    tree.iter().flat_map(leaf).collect()
}

pub(crate) fn merge(tree: &mut Json, given: Value) -> Result<(), serde_json::Error> {
    match given {
        Value::Table(given) if tree.is_object() => given.into_iter().try_for_each(|(key, value)| merge(&mut tree[key], value)),
        // JSON has no such numbers and would turn them into null.
        Value::Float(number) if !number.is_finite() => {
            Err(serde::de::Error::invalid_value(Unexpected::Float(number), &"a finite number"))
        }
        given => {
            *tree = serde_json::to_value(given)?;
            Ok(())
        }
    }
}

pub(crate) fn parse_value(text: &str) -> Value {
    format!("v = {text}")
        .parse::<Table>()
        .ok()
        .filter(|t| t.len() == 1)
        .and_then(|mut t| t.remove("v"))
        .unwrap_or_else(|| Value::String(text.into()))
}

pub(crate) fn insert_setting(tree: &mut Table, key: &str, value: Value) -> Result<(), ConfigError> {
    let (path, leaf) = key.rsplit_once('.').unwrap_or(("", key));
    let mut at = tree;
    for part in path.split('.').filter(|p| !p.is_empty()) {
        let next = at.entry(part).or_insert_with(|| Value::Table(Table::new()));
        at = next
            .as_table_mut()
            .ok_or_else(|| ConfigError::Type { key: key.into(), message: format!("`{part}` is a value, expected a table") })?;
    }
    at.insert(leaf.into(), value);
    Ok(())
}

pub(crate) fn check_tree(tree: &Table, prefix: &str, known: &[String]) -> Result<(), ConfigError> {
    for (name, value) in tree {
        let key = format!("{prefix}{name}");
        if name.contains('.') {
            let message = "has quotes around dots, which make one name of several; expected the name without quotes";
            return Err(ConfigError::Type { key, message: message.into() });
        }
        match value {
            Value::Table(inner) if !known.contains(&key) => {
                let group = format!("{key}.");
                if !known.iter().any(|k| k.starts_with(&group)) {
                    check_known(&key, known)?;
                }
                check_tree(inner, &group, known)?;
            }
            _ => check_known(&key, known)?,
        }
    }
    Ok(())
}

/// Replaces old names of parameters. A value under the new name takes precedence.
pub(crate) fn rename(tree: &mut Table, renamed: &[(&str, &str)]) -> Result<(), ConfigError> {
    for (old, new) in renamed {
        if let Some(value) = remove(tree, old)
            && !new.is_empty()
            && !UserSettings(tree).contains(new)
        {
            insert_setting(tree, new, value)?;
        }
    }
    Ok(())
}

/// Removes a setting, and its group if nothing is left in the group.
fn remove(tree: &mut Table, key: &str) -> Option<Value> {
    let Some((group, rest)) = key.split_once('.') else { return tree.remove(key) };
    let inner = tree.get_mut(group)?.as_table_mut()?;
    let value = remove(inner, rest)?;
    if inner.is_empty() {
        tree.remove(group);
    }
    Some(value)
}

pub(crate) fn check_known(key: &str, known: &[String]) -> Result<(), ConfigError> {
    if known.iter().any(|k| k == key) {
        return Ok(());
    }
    let nearest = nearest(key, known.iter().map(String::as_str)).map(str::to_owned);
    Err(ConfigError::Unknown { key: key.into(), nearest })
}
