//! A plan and its points.

use super::axes::Axis;
use super::base::json_cell;
use crate::{Cell, Constraint, Objective, OpenedInput};
use basrelief_parameters::ConfigError;
use basrelief_sim::{ConfigLoader, MachineConfig, MachineInfo, Overrides};
use std::collections::{BTreeMap, BTreeSet};

/// A consistent plan with open inputs.
#[derive(Debug)]
pub struct Plan {
    /// A heading.
    pub title: String,
    /// Inputs.
    pub inputs: Vec<PlanInput>,
    /// Machine.
    pub machine: &'static MachineInfo,
    /// In the order in which they are written; the first changes slowest.
    pub axes: Vec<Axis>,
    /// Objectives; at least one. Columns are paths of [figures](crate::figures).
    pub objectives: Vec<Objective>,
    /// Constraints.
    pub constraints: Vec<Constraint>,
    /// No step starts in this cycle or later.
    pub max_cycles: u64,
    /// True if reference images are drawn and compared. It is the same for all points of a folder.
    pub(crate) exact: bool,
    /// Points to run, each once.
    pub points: Vec<PlanPoint>,
    /// Parameters that all points share.
    pub(super) base: Overrides,
    /// Their TOML, read.
    pub(super) loader: ConfigLoader,
}

/// An input of a plan.
#[derive(Clone, Debug)]
pub struct PlanInput {
    /// Name of the axis in the plan.
    pub name: String,
    /// The open input.
    pub opened: OpenedInput,
    /// Everything in the plan that a report depends on.
    pub(super) identity: String,
}

impl PlanInput {
    /// Returns the frames that are known before a run: those of a scene, and 1 for a trace.
    pub(super) fn frames(&self) -> usize {
        if let OpenedInput::Scene(of) = &self.opened { of.scene().frames.len() } else { 1 }
    }
}

/// One point of the plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanPoint {
    /// SHA-256, in hexadecimal, over all that its report depends on.
    pub id: String,
    /// The same over all that its work depends on: points that share it differ in times only.
    pub work: String,
    /// Number of its input.
    pub input: usize,
    /// Place of the point on each axis, from 0.
    pub places: Vec<usize>,
}

impl Plan {
    /// The part of the points that is shard `number` of `count`, from 1. Points that share their work stay together.
    pub fn shard(&self, number: usize, count: usize) -> Vec<&PlanPoint> {
        let mut groups = BTreeMap::new();
        let of_shard = |point: &&PlanPoint| {
            let next = groups.len();
            *groups.entry(point.work.clone()).or_insert(next) % count == number - 1
        };
        self.points.iter().filter(of_shard).collect()
    }

    /// Returns the minimum number of runs. Points that share their work need one run.
    pub fn min_runs(&self) -> usize {
        self.points.iter().map(|point| &point.work).collect::<BTreeSet<_>>().len()
    }

    /// The values of a point on each axis, as `--set` takes them.
    pub fn settings(&self, places: &[usize]) -> Vec<(String, String)> {
        let of_axis = |(axis, &place): (&Axis, &usize)| {
            axis.keys.iter().cloned().zip(axis.values[place].iter().cloned()).collect::<Vec<_>>()
        };
        self.axes.iter().zip(places).flat_map(of_axis).collect()
    }

    /// Returns the points whose parameters are as in the plan without its axes: at most one per input.
    pub fn default_points(&self) -> Vec<&PlanPoint> {
        let base = self.load(&[]).map(|base| base.described()).unwrap_or_default();
        let value = |key: &String| base.iter().find(|parameter| parameter.key == *key).and_then(|of| json_cell(&of.value).ok());
        // A whole number equals the same real number.
        let equal = |cell: &Cell, base: &Cell| cell == base || cell.number().is_some_and(|x| base.number() == Some(x));
        let is_base = |axis: &Axis, place: usize| {
            let mut cells = axis.keys.iter().zip(&axis.cells[place]);
            cells.all(|(key, cell)| value(key).is_some_and(|base| equal(cell, &base)))
        };
        let on_base: Vec<Vec<bool>> =
            self.axes.iter().map(|axis| (0..axis.cells.len()).map(|place| is_base(axis, place)).collect()).collect();
        let is_default = |point: &&PlanPoint| on_base.iter().zip(&point.places).all(|(axis, &place)| axis[place]);
        self.points.iter().filter(is_default).collect()
    }

    /// The parameters of a point, as they are given.
    pub fn overrides_of(&self, places: &[usize]) -> Overrides {
        let settings = self.base.settings.iter().cloned().chain(self.settings(places)).collect();
        Overrides { toml: self.base.toml.clone(), settings }
    }

    /// The whole configuration of a point.
    ///
    /// # Errors
    /// Parameters that do not fit together.
    pub fn config(&self, places: &[usize]) -> Result<MachineConfig, String> {
        self.load(&self.settings(places)).map_err(|error| error.to_string())
    }

    /// The base with these settings over it.
    pub(super) fn load(&self, settings: &[(String, String)]) -> Result<MachineConfig, ConfigError> {
        let all = self.base.settings.iter().chain(settings);
        self.loader.load(&all.map(|(key, value)| (key.as_str(), value.as_str())).collect::<Vec<_>>())
    }
}
