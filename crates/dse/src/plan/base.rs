//! Axes around a base: the configuration that a plan has without its axes, from which they are left one at a time.

use super::axes::{Axis, cell};
use crate::Cell;
use basrelief_parameters::Effect;
use basrelief_sim::{MachineConfig, ParameterInfo};
use serde_json::Value as Json;
use std::collections::BTreeMap;
use toml::Value;

/// Puts the base first on each axis. Without axes, it makes one for each assumed parameter and each coefficient of the area, with its neighbours. `with`
/// returns the configuration with one parameter changed to a value in TOML.
pub(super) fn with_base_first(
    axes: Vec<Axis>,
    base: &MachineConfig,
    with: &dyn Fn(&str, &str) -> Option<MachineConfig>,
) -> Result<Vec<Axis>, String> {
    let parameters: BTreeMap<String, ParameterInfo> = base.described().into_iter().map(|p| (p.key.clone(), p)).collect();
    if axes.is_empty() {
        return base.described().iter().filter(|p| is_varied(p)).map(|p| assumed(p, with)).collect();
    }
    let based = |mut axis: Axis| {
        let cells = axis.keys.iter().map(|key| parameters.get(key).map_or(Ok(Cell::Missing), |p| json_cell(&p.value)));
        axis.cells.insert(0, cells.collect::<Result<_, String>>()?);
        axis.values.insert(0, vec![]);
        Ok(axis)
    };
    axes.into_iter().map(based).collect()
}

/// Returns true for assumed parameters and for coefficients of the area.
fn is_varied(parameter: &ParameterInfo) -> bool {
    parameter.provenance.kind == "assumed" || parameter.effect == Effect::Cost.name()
}

fn assumed(parameter: &ParameterInfo, with: &dyn Fn(&str, &str) -> Option<MachineConfig>) -> Result<Axis, String> {
    let fits = |value: &Json| {
        let config = toml_of(value).ok().and_then(|value| with(&parameter.key, &value.to_string()));
        config.is_some_and(|config| config.check().is_ok())
    };
    let neighbours = parameter.neighbours(&fits).iter().map(toml_of).collect::<Result<Vec<_>, _>>()?;
    let mut axis =
        Axis { keys: vec![parameter.key.clone()], values: vec![vec![]], cells: vec![vec![json_cell(&parameter.value)?]] };
    axis.values.extend(neighbours.iter().map(|value| vec![value.to_string()]));
    axis.cells.extend(neighbours.iter().map(|value| vec![cell(value)]));
    Ok(axis)
}

fn toml_of(value: &Json) -> Result<Value, String> {
    Value::try_from(value).map_err(|error| error.to_string())
}

pub(super) fn json_cell(value: &Json) -> Result<Cell, String> {
    toml_of(value).map(|value| cell(&value))
}
