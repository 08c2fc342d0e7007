//! Neighbouring values of a parameter, for sensitivity analysis.

use crate::configuration_schema::bounds;
use crate::parameter_info::{AllowedValues, ParameterInfo};
use serde_json::Value;

impl ParameterInfo {
    /// Returns the neighbouring values, at most one below and one above:
    ///
    /// * Numbers are halved and multiplied by 1.5, rounded, and changed by at least 1. All numbers of a list change alike. If 1.5 times a
    ///   power of two does not fit, the next power of two is used.
    /// * Choices have the previous and the next choice.
    /// * A switch has the other position.
    /// * A text has no neighbours.
    ///
    /// `fits` returns whether the machine can be built with a value.
    pub fn neighbours(&self, fits: &dyn Fn(&Value) -> bool) -> Vec<Value> {
        match &self.takes {
            AllowedValues::Switch => self.value.as_bool().map(|on| Value::Bool(!on)).into_iter().collect(),
            AllowedValues::Choice { choices } => {
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

fn number(value: &Value, [min, max]: [f64; 2], step: NumberChange, next: f64) -> Option<Value> {
    let x = value.as_f64()?;
    if value.is_f64() {
        return Some(step(x).clamp(min, max).into());
    }
    let rounded = step(x).round();
    let changed = if rounded == x { x + next } else { rounded };
    // Integer parameters are far below 2^53.
    Some((changed.clamp(min, max) as u64).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::MACHINES;
    use serde_json::json;

    fn of(machine: usize, key: &str, value: Value, fits: &dyn Fn(&Value) -> bool) -> Vec<Value> {
        let described = MACHINES[machine].load("", &[]).unwrap().described();
        ParameterInfo { value, ..described.into_iter().find(|p| p.key == key).unwrap() }.neighbours(fits)
    }

    #[test]
    fn numbers_are_halved_and_raised_by_half_within_range() {
        let depths = |n: u64| of(0, "fifo.shaded.depth", json!(n), &|_| true);
        assert_eq!(depths(64), [32, 96]);
        assert_eq!(depths(7), [4, 11]);
        assert_eq!(depths(2), [1, 3]);
        assert_eq!(depths(1), [2]);
        assert_eq!(depths(60_000), [30_000, 65_536]);
        assert_eq!(depths(65_536), [32_768]);
        assert_eq!(of(0, "memory.graphics.cap", json!(0), &|_| true), [1]);
        assert_eq!(of(1, "shade.ia", json!(1.0), &|_| true), [0.5, 1.5]);
        assert_eq!(of(1, "shade.ia", json!(12.0), &|_| true), [6.0, 16.0]);
        assert_eq!(of(1, "shade.ia", json!(0.0), &|_| true), [0.0; 0]);
    }

    #[test]
    fn powers_of_two_double_where_1_5_times_does_not_fit() {
        let is_power = |value: &Value| value.as_u64().is_some_and(u64::is_power_of_two);
        assert_eq!(of(0, "cache.clut.line_bytes", json!(64), &is_power), [32, 128]);
        // If neither value fits, 1.5 times is returned.
        assert_eq!(of(0, "cache.clut.line_bytes", json!(64), &|value| *value == 64), [32, 96]);
        assert_eq!(of(0, "cache.clut.line_bytes", json!(48), &is_power), [24, 72]);
    }

    #[test]
    fn choices_and_switches_have_neighbours_but_texts_do_not() {
        assert_eq!(of(0, "memory.graphics.part", json!("ddr-400"), &|_| true), ["sdr-133", "ddr2-667"]);
        assert_eq!(of(0, "reference.filter", json!("trilinear"), &|_| true), ["bilinear"]);
        assert_eq!(of(0, "rasterizer.early_z", json!(true), &|_| true), [false]);
        assert_eq!(of(0, "ideal.units", json!(""), &|_| true), [""; 0]);
        assert_eq!(of(3, "defer.left_at_ms", json!([]), &|_| true), [""; 0]);
        assert_eq!(of(3, "defer.left_at_tile", json!([4, 2]), &|_| true), [json!([2, 1]), json!([6, 3])]);
    }
}
