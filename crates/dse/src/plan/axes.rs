//! Axes of a plan: parameters, and the values that they take.

use crate::Cell;
use basrelief_input::{TextFormat, plain_message};
use basrelief_parameters::{FieldPositions, TomlFault};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeSet;
use toml::{Table, Value};

/// Maximum number of values of an axis.
pub(super) const MOST_VALUES: usize = 1 << 12;

/// Parameters that take their values together: one, or several that are zipped.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Parameters, as `--set` names them.
    pub keys: Vec<String>,
    /// For each value of the axis, the values of its parameters, as they are written in TOML. None where the parameters are as in the
    /// rest of the plan: that is the first place of an axis that is changed one at a time.
    pub values: Vec<Vec<String>>,
    /// The same as cells of a table.
    pub cells: Vec<Vec<Cell>>,
}

/// A range as it is written. It rises by a step or by a factor.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RangeSteps {
    /// First value.
    from: f64,
    /// Last value at most.
    to: f64,
    /// Difference of neighbours.
    step: Option<f64>,
    /// Quotient of neighbours.
    factor: Option<f64>,
}

/// Parameter of an axis, with its values.
struct AxisParameter {
    /// Path in the plan.
    path: Vec<String>,
    key: String,
    values: Vec<Value>,
}

/// The axes of `[axes]`, in the order in which they are written, then those of each `[[zip]]`.
pub(super) fn axes(axes: &Table, zips: &[Table], positions: &FieldPositions<'_>) -> Result<Vec<Axis>, TomlFault> {
    let mut seen = BTreeSet::new();
    let mut single = parameters(axes, &["axes"])?;
    single.sort_by_cached_key(|parameter| positions.start_of(&parameter.path));
    check_new(&single, &mut seen)?;
    let mut all = single.into_iter().map(|parameter| axis(&[parameter])).collect::<Vec<_>>();
    for (number, zip) in zips.iter().enumerate() {
        let block = ["zip", &number.to_string()];
        let zipped = parameters(zip, &block)?;
        check_new(&zipped, &mut seen)?;
        check_lengths(&zipped, &block)?;
        all.push(axis(&zipped));
    }
    Ok(all)
}

/// Checks that no parameter is on an axis that has been seen.
fn check_new(parameters: &[AxisParameter], seen: &mut BTreeSet<String>) -> Result<(), TomlFault> {
    match parameters.iter().find(|parameter| !seen.insert(parameter.key.clone())) {
        Some(twice) => Err(TomlFault::new(&twice.path, format!("axes: `{}` is on two axes; expected it on one", twice.key))),
        None => Ok(()),
    }
}

/// Checks that zipped parameters have equally many values.
fn check_lengths(zipped: &[AxisParameter], block: &[&str]) -> Result<(), TomlFault> {
    let Some(first) = zipped.first() else {
        return Err(TomlFault::new(block, "zip: names no parameter; expected two or more"));
    };
    let count = first.values.len();
    match zipped.iter().find(|other| other.values.len() != count) {
        Some(AxisParameter { path, key, values }) => {
            let (first, [count, others]) = (&first.key, [count, values.len()].map(values_in_words));
            let message = format!("zip: `{first}` has {count} and `{key}` has {others}; expected as many of each");
            Err(TomlFault::new(path, message))
        }
        None => Ok(()),
    }
}

fn values_in_words(count: usize) -> String {
    format!("{count} value{}", if count == 1 { "" } else { "s" })
}

/// Returns the axis of parameters with equally many values.
fn axis(parameters: &[AxisParameter]) -> Axis {
    let keys = parameters.iter().map(|parameter| parameter.key.clone()).collect();
    let row = |n: usize| parameters.iter().map(move |parameter| &parameter.values[n]);
    let count = parameters.first().map_or(0, |first| first.values.len());
    let values = (0..count).map(|n| row(n).map(Value::to_string).collect()).collect();
    let cells = (0..count).map(|n| row(n).map(cell).collect()).collect();
    Axis { keys, values, cells }
}

/// Parameters of a block and of the groups in it, each with its values. `block` is the path of the block in the plan.
fn parameters(table: &Table, block: &[&str]) -> Result<Vec<AxisParameter>, TomlFault> {
    let mut found = Vec::new();
    parameters_in(table, block, block.len(), &mut found)?;
    Ok(found)
}

/// Adds the parameters of a table at this path. The first `block` parts of the path belong to the block.
fn parameters_in(table: &Table, path: &[&str], block: usize, found: &mut Vec<AxisParameter>) -> Result<(), TomlFault> {
    for (name, value) in table {
        let path = [path, &[name]].concat();
        let key = path[block..].join(".");
        let fault = |message: String| TomlFault::new(&path, format!("{}.{key}: {message}", path[0]));
        let values = match value {
            Value::Array(values) => values.clone(),
            Value::Table(range) if range.contains_key("from") || range.contains_key("to") => {
                range_values(range).map_err(fault)?
            }
            Value::Table(group) if group.is_empty() => {
                return Err(fault("is empty; expected parameters with their values".into()));
            }
            Value::Table(group) => {
                parameters_in(group, &path, block, found)?;
                continue;
            }
            other => return Err(fault(format!("is {other}, expected a list of values, or {RANGE}"))),
        };
        if values.is_empty() {
            return Err(fault("has no values; expected one at least".into()));
        }
        if values.len() > MOST_VALUES {
            return Err(fault(too_many(&values.len().to_string())));
        }
        found.push(AxisParameter { path: path.into_iter().map(str::to_owned).collect(), key, values });
    }
    Ok(())
}

fn too_many(count: &str) -> String {
    format!("has {count} values; expected at most {MOST_VALUES}")
}

const RANGE: &str = "a range such as { from = 8, to = 64, step = 8 } or { from = 2, to = 64, factor = 2 }";

fn range_values(range: &Table) -> Result<Vec<Value>, String> {
    let wrong = |what: String| format!("{what}; expected {RANGE}");
    let RangeSteps { from, to, step, factor } =
        RangeSteps::deserialize(range.clone()).map_err(|error| wrong(plain_message(error.message().trim(), TextFormat::Toml)))?;
    let is_whole = range.values().all(|value| !value.is_float());
    let numbers = [("from", Some(from)), ("to", Some(to)), ("step", step), ("factor", factor)];
    let infinite = numbers.into_iter().find_map(|(name, x)| Some((name, x.filter(|x| !x.is_finite())?)));
    if let Some((name, x)) = infinite {
        return Err(wrong(format!("`{name}` is {x}, which is no finite number")));
    }
    if from > to {
        return Err(wrong(format!("it does not rise from its first value to its last: `from` is {from}, and `to` is {to}")));
    }
    check_growth(from, step, factor).map_err(wrong)?;
    let mut values = Vec::new();
    // The value follows from its number and not from the previous value, so rounding errors do not add up.
    for n in 0_u32.. {
        let x = match (step, factor) {
            (Some(step), _) => from + f64::from(n) * step,
            (_, factor) => (0..n).fold(from, |x, _| x * factor.unwrap_or(1.0)),
        };
        // Removes digits that come from rounding, as in 0.1 + 0.2.
        let x = (x * 1e9).round() / 1e9;
        if x > to {
            break;
        }
        if values.len() == MOST_VALUES {
            return Err(too_many(&format!("more than {MOST_VALUES}")));
        }
        values.push(if is_whole { Value::Integer(x as i64) } else { Value::Float(x) });
    }
    Ok(values)
}

/// Checks that the second value of a range is larger than the first.
fn check_growth(from: f64, step: Option<f64>, factor: Option<f64>) -> Result<(), String> {
    match (step, factor) {
        (Some(step), None) if from + step <= from => Err(format!("`step` is {step}, but must raise `from`, {from}")),
        (None, Some(factor)) if factor <= 1.0 => Err(format!("`factor` is {factor}, but must be above 1")),
        (None, Some(factor)) if from * factor <= from => Err(format!("`from` is {from}, but must be above 0 for a factor")),
        (Some(_), None) | (None, Some(_)) => Ok(()),
        _ => Err("a range goes by a step or by a factor".into()),
    }
}

/// A value as a cell of a table.
pub(super) fn cell(value: &Value) -> Cell {
    match value {
        Value::Integer(n) => u64::try_from(*n).map_or(Cell::Number(*n as f64), Cell::Whole),
        Value::Float(x) => Cell::Number(*x),
        Value::String(text) => Cell::Text(text.clone()),
        other => Cell::Text(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Vec<Axis>, String> {
        let table: Table = text.parse().unwrap();
        let group = |name: &str| table.get(name).and_then(Value::as_table).cloned().unwrap_or_default();
        let zips = table.get("zip").and_then(Value::as_array).cloned().unwrap_or_default();
        let zips: Vec<Table> = zips.into_iter().map(|zip| zip.as_table().cloned().unwrap()).collect();
        axes(&group("axes"), &zips, &FieldPositions::of(text)).map_err(|fault| fault.at_line(text))
    }

    fn values(text: &str) -> Vec<String> {
        of(&format!("[axes]\na = {text}")).unwrap().swap_remove(0).values.into_iter().flatten().collect()
    }

    #[test]
    fn axes_are_in_the_order_of_the_file_and_zips_behind_them() {
        let text = "[axes]\nz.y = [1]\na.b = [1, 2]\n[axes.m]\nn = [3]\n[[zip]]\nc.d = [1, 2]\nb = [\"x\", \"y\"]\n";
        let keys: Vec<Vec<String>> = of(text).unwrap().into_iter().map(|axis| axis.keys).collect();
        assert_eq!(keys, [vec!["z.y"], vec!["a.b"], vec!["m.n"], vec!["b", "c.d"]]);
    }

    #[test]
    fn ranges_rise_by_a_step_or_by_a_factor() {
        assert_eq!(values("{ from = 8, to = 30, step = 8 }"), ["8", "16", "24"]);
        assert_eq!(values("{ from = 2, to = 64, factor = 2 }"), ["2", "4", "8", "16", "32", "64"]);
        assert_eq!(values("{ from = 0.1, to = 0.5, step = 0.1 }"), ["0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(values("[[256, 128], [64, 64]]"), ["[256, 128]", "[64, 64]"]);
    }

    #[test]
    fn wrong_axes_are_named_with_what_was_expected() {
        let says = |text: &str, part: &str| {
            let error = of(text).unwrap_err();
            assert!(error.contains(part), "{error}");
        };
        says("[axes]\na.b = 3", "axes.a.b: is 3, expected a list of values, or a range such as");
        says("[axes]\na = []", "axes.a: has no values; expected one at least");
        says("[axes.a]\n[axes.b]\nc = [1]", "axes.a: is empty; expected parameters with their values");
        says("[axes]\na = { from = 1, to = 4 }", "axes.a: a range goes by a step or by a factor; expected a range such as");
        says("[axes]\na = { from = 1, to = 4, step = 1, factor = 2 }", "a range goes by a step or by a factor");
        says("[axes]\na = { from = 1, to = 4, stp = 1 }", "axes.a: unknown field `stp`");
        says("[axes]\na = { from = 4, to = 1, step = 1 }", "it does not rise from its first value to its last");
        says("[axes]\na = { from = 0, to = 1, factor = 2 }", "axes.a: `from` is 0, but must be above 0 for a factor; expected");
        says(
            "[axes]\na = { from = 2, to = 9, step = 0 }",
            "axes.a: `step` is 0, but must raise `from`, 2; expected a range such",
        );
        says("[axes]\na = { from = 2, to = 9, factor = 1 }", "axes.a: `factor` is 1, but must be above 1; expected a range such");
        says("[axes]\na = { from = 1, to = inf, step = 1 }", "axes.a: `to` is inf, which is no finite number; expected a range");
        says("[axes]\na = { from = -inf, to = 1, step = 1 }", "`from` is -inf, which is no finite number");
        says("[axes]\na = { from = 1, to = 2, step = nan }", "`step` is NaN, which is no finite number");
        says("[axes]\na = { from = 1, to = 2, factor = inf }", "`factor` is inf, which is no finite number");
        says("[axes]\na = { from = 1, to = 1e12, step = 1 }", "axes.a: has more than 4096 values; expected at most 4096");
        says(&format!("[axes]\na = [{}]", "1,".repeat(5000)), "axes.a: has 5000 values; expected at most 4096");
        says("[[zip]]\na = [1, 2]\nb = [1]", "zip: `a` has 2 values and `b` has 1 value; expected as many of each");
        says("[[zip]]\n", "zip: names no parameter");
    }

    /// A search through all keys for each key would compare five thousand million names.
    #[test]
    fn many_axes_take_linear_time() {
        use std::fmt::Write as _;
        let began = std::time::Instant::now();
        let text = (0..100_000).fold("[axes]\n".to_owned(), |mut text, n| {
            let _ = writeln!(text, "unknown_{n} = [1]");
            text
        });
        assert_eq!(of(&text).unwrap().len(), 100_000);
        assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
    }
}
