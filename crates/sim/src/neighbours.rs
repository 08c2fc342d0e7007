//! Values beside that of a parameter, for whoever asks how much hangs on it.

use crate::described::{Described, Takes, bounds};
use serde_json::Value;

impl Described {
    /// Values beside that of the parameter, at most one below and one above: of numbers half as much and half as much again, rounded,
    /// and the next whole number where that is the same; of choices the one before and the one after; of a switch the other. Of a list
    /// of numbers all are changed alike. Where half as much again does not fit, and a power of two stands there, it is the next power
    /// of two. A text has none.
    ///
    /// `fits` says whether the machine can be built with a value.
    pub fn neighbours(&self, fits: &dyn Fn(&Value) -> bool) -> Vec<Value> {
        match &self.takes {
            Takes::Switch => self.value.as_bool().map(|on| Value::Bool(!on)).into_iter().collect(),
            Takes::Choice { choices } => {
                let at = choices.iter().position(|choice| self.value == choice.name);
                let beside = |at: usize| [at.checked_sub(1), Some(at + 1)].into_iter().flatten();
                let names = at.into_iter().flat_map(beside).filter_map(|at| choices.get(at));
                names.map(|choice| Value::String(choice.name.clone())).collect()
            }
            Takes::Integer { min, max } | Takes::Number { min, max } => numbers(&self.value, [*min, *max], fits),
            Takes::Text => numbers(&self.value, bounds(&self.range).unwrap_or([0.0, f64::MAX]), fits),
        }
    }
}

/// How a number is changed.
type Step = fn(f64) -> f64;

/// Of a number, or of each of a list.
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

/// None where it is no number, or stays the same.
fn changed(value: &Value, bounds: [f64; 2], step: Step, next: f64) -> Option<Value> {
    let changed = match value {
        Value::Array(list) => Value::Array(list.iter().map(|x| number(x, bounds, step, next)).collect::<Option<_>>()?),
        value => number(value, bounds, step, next)?,
    };
    (changed != *value).then_some(changed)
}

fn number(value: &Value, [min, max]: [f64; 2], step: Step, next: f64) -> Option<Value> {
    let x = value.as_f64()?;
    if value.is_f64() {
        return Some(step(x).clamp(min, max).into());
    }
    let rounded = step(x).round();
    let changed = if rounded == x { x + next } else { rounded };
    // Whole numbers of parameters are far below 2^53.
    Some((changed.clamp(min, max) as u64).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::MACHINES;
    use serde_json::json;

    fn of(machine: usize, key: &str, value: Value, fits: &dyn Fn(&Value) -> bool) -> Vec<Value> {
        let described = MACHINES[machine].load("", &[]).unwrap().described();
        Described { value, ..described.into_iter().find(|p| p.key == key).unwrap() }.neighbours(fits)
    }

    #[test]
    fn numbers_are_halved_and_raised_by_half_within_what_the_parameter_takes() {
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
    fn powers_of_two_go_to_the_next_where_half_as_much_again_does_not_fit() {
        let is_power = |value: &Value| value.as_u64().is_some_and(u64::is_power_of_two);
        assert_eq!(of(0, "cache.clut.line_bytes", json!(64), &is_power), [32, 128]);
        // What fits neither way is said as it was asked for.
        assert_eq!(of(0, "cache.clut.line_bytes", json!(64), &|value| *value == 64), [32, 96]);
        assert_eq!(of(0, "cache.clut.line_bytes", json!(48), &is_power), [24, 72]);
    }

    #[test]
    fn choices_have_those_beside_them_switches_the_other_and_texts_none() {
        assert_eq!(of(0, "memory.graphics.part", json!("ddr-400"), &|_| true), ["sdr-133", "ddr2-667"]);
        assert_eq!(of(0, "reference.filter", json!("trilinear"), &|_| true), ["bilinear"]);
        assert_eq!(of(0, "rasterizer.early_z", json!(true), &|_| true), [false]);
        assert_eq!(of(0, "ideal.units", json!(""), &|_| true), [""; 0]);
        assert_eq!(of(3, "defer.left_at_ms", json!([]), &|_| true), [""; 0]);
        assert_eq!(of(3, "defer.left_at_tile", json!([4, 2]), &|_| true), [json!([2, 1]), json!([6, 3])]);
    }
}
