//! Parameters of a machine at unusual values.

use super::mutate::ODD_NUMBERS;
use super::random::RandomChoice as _;
use basrelief_dse::SplitMix64;
use basrelief_parameters::Parameter;
use basrelief_signals::resolve_reference;
use basrelief_sim::MachineInfo;
use serde_json::Value;

/// Values that are invalid for most parameters.
const WORDS: [&str; 11] = ["true", "[]", "[1, 2]", "[0]", "\"x\"", "", "{}", "inf", "-inf", "identical", "per_polygon"];

/// Returns a parameter of this machine and a value: mostly within its range, in most cases at its ends.
pub fn setting(machine: &MachineInfo, random: &mut SplitMix64) -> (String, String) {
    let parameter = random.one(&machine.parameters()).clone();
    let choices = choices(machine, &parameter.key);
    let value = if random.once_in(6) { beyond(&parameter, random) } else { within(&parameter, &choices, random) };
    (parameter.key, value)
}

/// Returns a configuration of this machine as TOML: a few settings, one per line. Most files end at the first invalid one.
pub fn configuration(machine: &MachineInfo, random: &mut SplitMix64) -> String {
    let count = *random.one(&[1, 1, 2, 3, 5]);
    let lines = (0..count).map(|_| setting(machine, random));
    lines.map(|(key, value)| format!("{key} = {value}\n")).collect()
}

fn within(parameter: &Parameter, choices: &[String], random: &mut SplitMix64) -> String {
    if !choices.is_empty() {
        return format!("\"{}\"", random.one(choices));
    }
    let whole = range(parameter).and_then(|[low, high]| Some([low.parse::<u64>().ok()?, high.parse().ok()?]));
    match (&parameter.default, whole, range(parameter)) {
        (Value::Bool(_), ..) => (*random.one(&["true", "false"])).to_owned(),
        (_, Some(ends), _) => whole_number(ends, random).to_string(),
        (_, None, Some(ends)) => (*random.one(&ends)).to_owned(),
        _ => parameter.default.to_string(),
    }
}

/// Returns an end of the range, a neighbour of it, or a power of two within.
fn whole_number([low, high]: [u64; 2], random: &mut SplitMix64) -> u64 {
    match random.below(6) {
        0 => low,
        1 => high,
        2 => low.saturating_add(1).min(high),
        3 => high.saturating_sub(1).max(low),
        _ => (1 << random.below(64)).clamp(low, high),
    }
}

/// Returns a value just out of the range, far out of it, or of another type.
fn beyond(parameter: &Parameter, random: &mut SplitMix64) -> String {
    let ends = range(parameter).and_then(|[low, high]| Some([low.parse::<i128>().ok()? - 1, high.parse::<i128>().ok()? + 1]));
    match (random.below(3), ends) {
        (0, Some(ends)) => random.one(&ends).to_string(),
        (1, _) => (*random.one(&WORDS)).to_owned(),
        _ => (*random.one(&ODD_NUMBERS)).to_owned(),
    }
}

/// Returns the ends of a range in the table of parameters.
fn range(parameter: &Parameter) -> Option<[&str; 2]> {
    let (low, rest) = parameter.range.split_once("..=")?;
    Some([low, rest.split(',').next().unwrap_or(rest)])
}

/// Returns the names that are valid values of a parameter, if it has any.
fn choices(machine: &MachineInfo, key: &str) -> Vec<String> {
    if key == "ideal.units" {
        return machine.units().iter().map(|unit| unit.name.clone()).collect();
    }
    let schema = &machine.schema();
    let found = key.split('.').fold(schema, |at, part| resolve_reference(&at["properties"][part], schema));
    let constants = found["oneOf"].as_array().into_iter().flatten().flat_map(|one| [&one["const"], &one["enum"][0]]);
    let names = found["enum"].as_array().into_iter().flatten().chain(constants);
    names.filter_map(|name| name.as_str().map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::random::random_of;
    use super::*;
    use basrelief_sim::MACHINES;

    #[test]
    fn most_settings_are_valid_and_some_are_not() {
        for machine in MACHINES {
            let mut random = random_of(3, 0, 0);
            let taken = (0..300).filter(|_| {
                let (key, value) = setting(machine, &mut random);
                assert!(machine.parameters().iter().any(|p| p.key == key), "{key}");
                let config = machine.load("", &[(&key, &value)]);
                config.is_ok_and(|config| config.check().is_ok())
            });
            let taken = taken.count();
            assert!((200..290).contains(&taken), "{}: {taken} of 300", machine.name);
        }
    }

    #[test]
    fn every_parameter_has_choices_or_range() {
        for machine in MACHINES {
            for p in machine.parameters().iter().filter(|p| !p.default.is_boolean() && range(p).is_none()) {
                let choices = choices(machine, &p.key);
                let names = p.default.as_str().is_some_and(|name| name.is_empty() || choices.iter().any(|c| c == name));
                assert!(names && !choices.is_empty() || p.default.is_array(), "{} of {}: {choices:?}", p.key, machine.name);
            }
        }
    }
}
