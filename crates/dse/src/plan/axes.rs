//! Axes of a plan: parameters, and the values that they take.

use super::fault::PlanFault;
use crate::Cell;
use schemars::JsonSchema;
use serde::Deserialize;
use std::ops::Range;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

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

/// Values of parameters, by place: the order in the file is that of the axes.
type ParsedValues = Vec<(Option<usize>, String, Vec<Value>)>;

/// Positions of the parts of a plan in its text.
pub(super) struct KeyPositions<'a>(Option<Spanned<DeTable<'a>>>);

impl<'a> KeyPositions<'a> {
    pub(super) fn of(text: &'a str) -> Self {
        Self(DeTable::parse(text).ok())
    }

    /// Returns the position of the key at the end of this path.
    fn of_path(&self, path: &[String]) -> Option<usize> {
        let mut table = self.0.as_ref()?.get_ref();
        let mut found: Option<Range<usize>> = None;
        for part in path {
            if let Some((key, value)) = table.get_key_value(part.as_str()) {
                found = Some(key.span());
                match value.get_ref() {
                    DeValue::Table(inner) => table = inner,
                    _ => break,
                }
            }
        }
        found.map(|span| span.start)
    }
}

/// The axes of `[axes]`, in the order in which they are written, then those of each `[[zip]]`.
pub(super) fn axes(axes: &Table, zips: &[Table], places: &KeyPositions<'_>) -> Result<Vec<Axis>, PlanFault> {
    let mut parsed = Vec::new();
    parameters(axes, &["axes".to_owned()], places, &mut parsed)?;
    parsed.sort_by_key(|(place, ..)| *place);
    let single = parsed.into_iter().map(|(_, key, values)| axis(vec![(key, values)]));
    let zip_axis = |zip: &Table| {
        let mut parsed = Vec::new();
        parameters(zip, &["zip".to_owned()], places, &mut parsed)?;
        axis(parsed.into_iter().map(|(_, key, values)| (key, values)).collect())
    };
    let zipped = (0..).zip(zips).map(|(number, zip)| zip_axis(zip).map_err(|fault: PlanFault| fault.in_block(number)));
    single.chain(zipped).collect()
}

fn axis(parameters: Vec<(String, Vec<Value>)>) -> Result<Axis, PlanFault> {
    let Some((first, values)) = parameters.first() else {
        return Err(PlanFault::new("zip", "zip: names no parameter; expected two or more"));
    };
    let count = values.len();
    if let Some((other, values)) = parameters.iter().find(|(_, values)| values.len() != count) {
        let others = values.len();
        let message = format!("zip: `{first}` has {count} values and `{other}` has {others}; expected as many of each");
        return Err(PlanFault::new(format!("zip.{other}"), message));
    }
    let keys = parameters.iter().map(|(key, _)| key.clone()).collect();
    let row = |n: usize| parameters.iter().map(move |(_, values)| &values[n]);
    let values = (0..count).map(|n| row(n).map(Value::to_string).collect()).collect();
    let cells = (0..count).map(|n| row(n).map(cell).collect()).collect();
    Ok(Axis { keys, values, cells })
}

/// Parameters of a table and the groups in it, each with its values.
fn parameters(table: &Table, path: &[String], places: &KeyPositions<'_>, found: &mut ParsedValues) -> Result<(), PlanFault> {
    for (name, value) in table {
        let path = [path, std::slice::from_ref(name)].concat();
        let (place, key) = (path.join("."), path[1..].join("."));
        let values = match value {
            Value::Array(values) => values.clone(),
            Value::Table(range) if range.contains_key("from") || range.contains_key("to") => range_values(range, &place)?,
            Value::Table(group) => {
                parameters(group, &path, places, found)?;
                continue;
            }
            other => return Err(format!("{place}: is {other}, expected a list of values, or {RANGE}").into()),
        };
        if values.is_empty() {
            return Err(format!("{place}: has no values; expected one at least").into());
        }
        if values.len() > MOST_VALUES {
            return Err(too_many(&place, &values.len().to_string()).into());
        }
        found.push((places.of_path(&path), key, values));
    }
    Ok(())
}

fn too_many(place: &str, count: &str) -> String {
    format!("{place}: has {count} values; expected at most {MOST_VALUES}")
}

const RANGE: &str = "a range such as { from = 8, to = 64, step = 8 } or { from = 2, to = 64, factor = 2 }";

fn range_values(range: &Table, place: &str) -> Result<Vec<Value>, String> {
    let wrong = |what: String| format!("{place}: {what}; expected {RANGE}");
    let RangeSteps { from, to, step, factor } =
        RangeSteps::deserialize(range.clone()).map_err(|error| wrong(error.message().trim().to_owned()))?;
    let is_whole = range.values().all(|value| !value.is_float());
    let grows = |x: f64| match (step, factor) {
        (Some(step), None) => Ok(x + step),
        (None, Some(factor)) => Ok(x * factor),
        _ => Err(wrong("a range goes by a step or by a factor".into())),
    };
    let numbers = [("from", Some(from)), ("to", Some(to)), ("step", step), ("factor", factor)];
    let infinite = numbers.into_iter().find_map(|(name, x)| Some((name, x.filter(|x| !x.is_finite())?)));
    if let Some((name, x)) = infinite {
        return Err(wrong(format!("`{name}` is {x}, which is no finite number")));
    }
    if from > to || grows(from)? <= from {
        return Err(wrong("it does not rise from its first value to its last".into()));
    }
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
            return Err(too_many(place, &format!("more than {MOST_VALUES}")));
        }
        values.push(if is_whole { Value::Integer(x as i64) } else { Value::Float(x) });
    }
    Ok(values)
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
        axes(&group("axes"), &zips, &KeyPositions::of(text)).map_err(|fault| fault.at_line(text))
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
        says("[axes]\na = { from = 1, to = 4 }", "axes.a: a range goes by a step or by a factor; expected a range such as");
        says("[axes]\na = { from = 1, to = 4, step = 1, factor = 2 }", "a range goes by a step or by a factor");
        says("[axes]\na = { from = 1, to = 4, stp = 1 }", "axes.a: unknown field `stp`");
        says("[axes]\na = { from = 4, to = 1, step = 1 }", "it does not rise from its first value to its last");
        says("[axes]\na = { from = 0, to = 1, factor = 2 }", "it does not rise");
        says("[axes]\na = { from = 1, to = inf, step = 1 }", "axes.a: `to` is inf, which is no finite number; expected a range");
        says("[axes]\na = { from = -inf, to = 1, step = 1 }", "`from` is -inf, which is no finite number");
        says("[axes]\na = { from = 1, to = 2, step = nan }", "`step` is NaN, which is no finite number");
        says("[axes]\na = { from = 1, to = 2, factor = inf }", "`factor` is inf, which is no finite number");
        says("[axes]\na = { from = 1, to = 1e12, step = 1 }", "axes.a: has more than 4096 values; expected at most 4096");
        says(&format!("[axes]\na = [{}]", "1,".repeat(5000)), "axes.a: has 5000 values; expected at most 4096");
        says("[[zip]]\na = [1, 2]\nb = [1]", "zip: `a` has 2 values and `b` has 1; expected as many of each");
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
