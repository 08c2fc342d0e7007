//! Points of a plan that are left out.

use super::axes::Axis;
use super::fault::PlanFault;
use toml::{Table, Value};

/// Points that are left out: for each parameter, the values that it must have for that.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Exclusion(Vec<(usize, usize, Vec<String>)>);

impl Exclusion {
    /// Parses a block of the plan.
    pub(super) fn of(table: &Table, axes: &[Axis]) -> Result<Self, PlanFault> {
        let mut wanted = Vec::new();
        values_in(table, "", &mut wanted);
        let part = |(key, value): (String, &Value)| {
            let place = axes.iter().enumerate().find_map(|(n, axis)| Some((n, axis.keys.iter().position(|k| *k == key)?)));
            let (axis, at) = place.ok_or_else(|| {
                let keys = axes.iter().flat_map(|axis| &axis.keys).map(String::as_str);
                let near = basrelief_parameters::nearest(&key, keys);
                let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
                PlanFault::new(format!("exclude.{key}"), format!("exclude: `{key}` is on no axis{hint}"))
            })?;
            let values: Vec<String> = match value {
                // A list is several values, unless the axis has lists for values.
                Value::Array(values) if !is_value(&axes[axis], at, &value.to_string()) => {
                    values.iter().map(Value::to_string).collect()
                }
                value => vec![value.to_string()],
            };
            match values.iter().find(|value| !is_value(&axes[axis], at, value)) {
                Some(none) => {
                    let message = format!("exclude: `{key}` never is {none}: nothing would be left out");
                    Err(PlanFault::new(format!("exclude.{key}"), message))
                }
                None => Ok((axis, at, values)),
            }
        };
        if wanted.is_empty() {
            return Err(PlanFault::new("exclude", "exclude: names no parameter: everything would be left out"));
        }
        Ok(Self(wanted.into_iter().map(part).collect::<Result<_, _>>()?))
    }

    pub(super) fn leaves_out(&self, places: &[usize], axes: &[Axis]) -> bool {
        self.0
            .iter()
            .all(|(axis, at, values)| axes[*axis].values[places[*axis]].get(*at).is_some_and(|value| values.contains(value)))
    }
}

fn is_value(axis: &Axis, at: usize, value: &str) -> bool {
    axis.values.iter().any(|row| row.get(at).is_some_and(|given| given == value))
}

/// Dotted names and values, groups opened.
fn values_in<'a>(table: &'a Table, prefix: &str, found: &mut Vec<(String, &'a Value)>) {
    for (name, value) in table {
        let key = format!("{prefix}{name}");
        match value {
            Value::Table(group) => values_in(group, &format!("{key}."), found),
            _ => found.push((key, value)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::axes::{KeyPositions, axes};
    use super::*;

    #[test]
    fn exclusion_matches_all_named_values() {
        let table: Table = "a = [1, 2]\nb = [[1, 2], [3]]".parse().unwrap();
        let axes = axes(&table, &[], &KeyPositions::of("")).unwrap();
        let exclusion = |text: &str| Exclusion::of(&text.parse().unwrap(), &axes).map_err(|fault| fault.at_line(""));
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
