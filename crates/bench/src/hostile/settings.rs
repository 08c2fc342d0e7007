//! Parameters of a machine at values that are seldom thought of.

use super::chance::Chance;
use super::mutate::ODD_NUMBERS;
use basrelief_parameters::Parameter;
use basrelief_sim::MachineInfo;
use serde_json::Value;

/// What is no value of most parameters.
const WORDS: [&str; 11] = ["true", "[]", "[1, 2]", "[0]", "\"x\"", "", "{}", "inf", "-inf", "identical", "per_polygon"];

/// A parameter of this machine and a value: mostly within its range, at the ends of it more often than not.
pub fn setting(machine: &MachineInfo, chance: &mut Chance) -> (String, String) {
    let parameter = chance.one(&machine.parameters()).clone();
    let choices = choices(machine, &parameter.key);
    let value = if chance.once_in(6) { beyond(&parameter, chance) } else { within(&parameter, &choices, chance) };
    (parameter.key, value)
}

/// A configuration of this machine as TOML: a few settings, one a line. A file mostly ends at the first that is refused.
pub fn configuration(machine: &MachineInfo, chance: &mut Chance) -> String {
    let count = *chance.one(&[1, 1, 2, 3, 5]);
    let lines = (0..count).map(|_| setting(machine, chance));
    lines.map(|(key, value)| format!("{key} = {value}\n")).collect()
}

fn within(parameter: &Parameter, choices: &[String], chance: &mut Chance) -> String {
    if !choices.is_empty() {
        return format!("\"{}\"", chance.one(choices));
    }
    let whole = range(parameter).and_then(|[low, high]| Some([low.parse::<u64>().ok()?, high.parse().ok()?]));
    match (&parameter.default, whole, range(parameter)) {
        (Value::Bool(_), ..) => (*chance.one(&["true", "false"])).to_owned(),
        (_, Some(ends), _) => whole_number(ends, chance).to_string(),
        (_, None, Some(ends)) => (*chance.one(&ends)).to_owned(),
        _ => parameter.default.to_string(),
    }
}

/// An end of the range, or what lies beside it, or a power of two within.
fn whole_number([low, high]: [u64; 2], chance: &mut Chance) -> u64 {
    match chance.below(6) {
        0 => low,
        1 => high,
        2 => low.saturating_add(1).min(high),
        3 => high.saturating_sub(1).max(low),
        _ => (1 << chance.below(64)).clamp(low, high),
    }
}

/// Just out of the range, far out of it, or something else altogether.
fn beyond(parameter: &Parameter, chance: &mut Chance) -> String {
    let ends = range(parameter).and_then(|[low, high]| Some([low.parse::<i128>().ok()? - 1, high.parse::<i128>().ok()? + 1]));
    match (chance.below(3), ends) {
        (0, Some(ends)) => chance.one(&ends).to_string(),
        (1, _) => (*chance.one(&WORDS)).to_owned(),
        _ => (*chance.one(&ODD_NUMBERS)).to_owned(),
    }
}

/// The ends of a range, as the table of parameters says them.
fn range(parameter: &Parameter) -> Option<[&str; 2]> {
    let (low, rest) = parameter.range.split_once("..=")?;
    Some([low, rest.split(',').next().unwrap_or(rest)])
}

/// The names that a parameter may have as its value, where it has names.
fn choices(machine: &MachineInfo, key: &str) -> Vec<String> {
    if key == "ideal.units" {
        return machine.units().iter().map(|unit| unit.name.clone()).collect();
    }
    let schema = &machine.schema();
    let property = |at: &'_ Value, part: &str| resolved(schema, &at["properties"][part]);
    let found = key.split('.').fold(schema.clone(), |at, part| property(&at, part));
    let constants = found["oneOf"].as_array().into_iter().flatten().flat_map(|one| [&one["const"], &one["enum"][0]]);
    let names = found["enum"].as_array().into_iter().flatten().chain(constants);
    names.filter_map(|name| name.as_str().map(str::to_owned)).collect()
}

/// What a schema refers to.
fn resolved(schema: &Value, at: &Value) -> Value {
    let pointer = at["$ref"].as_str().and_then(|place| place.strip_prefix('#'));
    pointer.and_then(|pointer| schema.pointer(pointer)).unwrap_or(at).clone()
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_sim::MACHINES;

    #[test]
    fn most_settings_are_of_the_machine_and_within_its_ranges_and_some_are_not() {
        for machine in MACHINES {
            let mut chance = Chance::of(3, 0, 0);
            let taken = (0..300).filter(|_| {
                let (key, value) = setting(machine, &mut chance);
                assert!(machine.parameters().iter().any(|p| p.key == key), "{key}");
                let config = machine.load("", &[(&key, &value)]);
                config.is_ok_and(|config| config.check().is_ok())
            });
            let taken = taken.count();
            assert!((200..290).contains(&taken), "{}: {taken} of 300", machine.name);
        }
    }

    #[test]
    fn every_parameter_is_a_switch_or_has_choices_or_a_range() {
        for machine in MACHINES {
            for p in machine.parameters().iter().filter(|p| !p.default.is_boolean() && range(p).is_none()) {
                let choices = choices(machine, &p.key);
                let names = p.default.as_str().is_some_and(|name| name.is_empty() || choices.iter().any(|c| c == name));
                assert!(names && !choices.is_empty() || p.default.is_array(), "{} of {}: {choices:?}", p.key, machine.name);
            }
        }
    }
}
