//! Points of a plan that are left out.

use super::axes::Axis;
use basrelief_parameters::{TomlFault, nearest};
use toml::{Table, Value};

/// Points that are left out: for each parameter, the values that it must have for that.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Exclusion(Vec<(usize, usize, Vec<String>)>);

impl Exclusion {
    /// Parses the block of this number.
    pub(super) fn of(number: usize, table: &Table, axes: &[Axis]) -> Result<Self, TomlFault> {
        let number = number.to_string();
        let mut wanted = Vec::new();
        values_in(table, &["exclude", &number], &mut wanted);
        if wanted.is_empty() {
            let message = "exclude: names no parameter: everything would be left out";
            return Err(TomlFault::new(&["exclude", &number], message));
        }
        let part = |(path, value): (Vec<&str>, &Value)| {
            excluded(&path[2..].join("."), value, axes).map_err(|message| TomlFault::new(&path, format!("exclude: {message}")))
        };
        Ok(Self(wanted.into_iter().map(part).collect::<Result<_, _>>()?))
    }

    pub(super) fn leaves_out(&self, places: &[usize], axes: &[Axis]) -> bool {
        self.0
            .iter()
            .all(|(axis, at, values)| axes[*axis].values[places[*axis]].get(*at).is_some_and(|value| values.contains(value)))
    }
}

/// Returns the axis and the place of a parameter on it, and the values that are left out.
fn excluded(key: &str, value: &Value, axes: &[Axis]) -> Result<(usize, usize, Vec<String>), String> {
    let place = axes.iter().enumerate().find_map(|(n, axis)| Some((n, axis.keys.iter().position(|k| *k == key)?)));
    let (axis, at) = place.ok_or_else(|| {
        let near = nearest(key, axes.iter().flat_map(|axis| &axis.keys).map(String::as_str));
        let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        format!("`{key}` is on no axis{hint}")
    })?;
    let values: Vec<String> = match value {
        // A list is several values, unless the axis has lists for values.
        Value::Array(values) if !is_value(&axes[axis], at, &value.to_string()) => values.iter().map(Value::to_string).collect(),
        value => vec![value.to_string()],
    };
    match values.iter().find(|value| !is_value(&axes[axis], at, value)) {
        Some(none) => Err(format!("`{key}` never is {none}: nothing would be left out")),
        None => Ok((axis, at, values)),
    }
}

fn is_value(axis: &Axis, at: usize, value: &str) -> bool {
    axis.values.iter().any(|row| row.get(at).is_some_and(|given| given == value))
}

/// Paths and values, groups opened.
fn values_in<'a>(table: &'a Table, path: &[&'a str], found: &mut Vec<(Vec<&'a str>, &'a Value)>) {
    for (name, value) in table {
        let path = [path, &[name]].concat();
        match value {
            Value::Table(group) => values_in(group, &path, found),
            _ => found.push((path, value)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::axes::axes;
    use super::*;
    use basrelief_parameters::FieldPositions;

    #[test]
    fn exclusion_matches_all_named_values() {
        let table: Table = "a = [1, 2]\nb = [[1, 2], [3]]".parse().unwrap();
        let axes = axes(&table, &[], &FieldPositions::of("")).unwrap();
        let exclusion = |text: &str| Exclusion::of(0, &text.parse().unwrap(), &axes).map_err(TomlFault::into_message);
        let left_out = |text: &str| {
            let exclusion = exclusion(text).unwrap();
            [[0, 0], [0, 1], [1, 0], [1, 1]].map(|places| exclusion.leaves_out(&places, &axes))
        };
        assert_eq!(left_out("a = 2\nb = [1, 2]"), [false, false, true, false]);
        assert_eq!(left_out("a = [1, 2]\nb = [[3]]"), [false, true, false, true]);
        assert!(exclusion("c = 1").unwrap_err().contains("`c` is on no axis"));
        assert_eq!(exclusion("a = 3").unwrap_err(), "exclude: `a` never is 3: nothing would be left out");
        assert!(exclusion("").unwrap_err().contains("everything"));
    }
}
