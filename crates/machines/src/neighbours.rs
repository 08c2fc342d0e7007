//! Neighbouring values of a parameter, for sensitivity analysis.

use crate::configuration_schema::bounds;
use crate::parameter_info::{AllowedValues, ParameterChoice, ParameterInfo};
use basrelief_kernel::MemoryPart;
use serde_json::Value;

impl ParameterInfo {
    /// Returns the neighbouring values, at most one below and one above:
    ///
    /// * Numbers are halved and multiplied by 1.5, rounded, and changed by at least 1. All numbers of a list change alike. If 1.5 times a
    ///   power of two does not fit, the next power of two is used.
    /// * Choices have the previous and the next choice. An ideal memory part is no neighbour and has none: it cannot be built, so its area
    ///   has no meaning.
    /// * A switch has the other position.
    /// * A text has no neighbours.
    ///
    /// `fits` returns whether the machine can be built with a value.
    pub fn neighbours(&self, fits: &dyn Fn(&Value) -> bool) -> Vec<Value> {
        match &self.takes {
            AllowedValues::Switch => self.value.as_bool().map(|on| Value::Bool(!on)).into_iter().collect(),
            AllowedValues::Choice { choices } => {
                let is_buildable = |name: &str| name != MemoryPart::Ideal.name();
                let choices: Vec<&ParameterChoice> = choices.iter().filter(|choice| is_buildable(&choice.name)).collect();
                let at = choices.iter().position(|choice| self.value == choice.name);
                let beside = |at: usize| [at.checked_sub(1), Some(at + 1)].into_iter().flatten();
                let names = at.into_iter().flat_map(beside).filter_map(|at| choices.get(at));
                names.map(|choice| Value::String(choice.name.clone())).collect()
            }
            AllowedValues::Integer { min, max } | AllowedValues::Number { min, max } => numbers(&self.value, [*min, *max], fits),
            AllowedValues::Text => numbers(&self.value, bounds(&self.range).unwrap_or([0.0, f64::MAX]), fits),
        }
    }
}

/// Change of a number.
type NumberChange = fn(f64) -> f64;

/// Returns the neighbours of a number, or of a list of numbers.
fn numbers(value: &Value, bounds: [f64; 2], fits: &dyn Fn(&Value) -> bool) -> Vec<Value> {
    let half = changed(value, bounds, |x| x / 2.0, -1.0);
    let more = changed(value, bounds, |x| x * 1.5, 1.0);
    let twice =
        || all(value, &|x| x.as_u64().is_some_and(u64::is_power_of_two)).then(|| changed(value, bounds, |x| x * 2.0, 1.0));
    let more = match more {
        Some(more) if !fits(&more) => twice().flatten().filter(|twice| fits(twice)).or(Some(more)),
        more => more,
    };
    half.into_iter().chain(more).collect()
}

fn all(value: &Value, is: &dyn Fn(&Value) -> bool) -> bool {
    value.as_array().map_or_else(|| is(value), |list| list.iter().all(is))
}

/// Returns the changed value; `None` if it is not a number or does not change.
fn changed(value: &Value, bounds: [f64; 2], step: NumberChange, next: f64) -> Option<Value> {
    let changed = match value {
        Value::Array(list) => Value::Array(list.iter().map(|x| number(x, bounds, step, next)).collect::<Option<_>>()?),
        value => number(value, bounds, step, next)?,
    };
    (changed != *value).then_some(changed)
}

/// Rounds to 15 significant digits, so that 1.5 x 1.4 is 2.1 and not 2.0999999999999996.
fn to_15_digits(x: f64) -> f64 {
    format!("{x:.14e}").parse().unwrap_or(x)
}

fn number(value: &Value, [min, max]: [f64; 2], step: NumberChange, next: f64) -> Option<Value> {
    let x = value.as_f64()?;
    if value.is_f64() {
        return Some(to_15_digits(step(x)).clamp(min, max).into());
    }
    let rounded = step(x).round();
    let changed = if rounded == x { x + next } else { rounded };
    // Integer parameters are far below 2^53.
    Some((changed.clamp(min, max) as u64).into())
}
