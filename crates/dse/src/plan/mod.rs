//! Plans: inputs, a machine, axes, samples, objectives and constraints, and the points that follow from them.

mod axes;
mod base;
mod definition;
mod exclusion;
mod identity;
mod points;
mod schema;
mod trial;
mod views;
mod warnings;
mod written;

pub use axes::Axis;
pub use definition::{Plan, PlanInput, PlanPoint};
pub use schema::plan_schema;
pub(crate) use trial::run_options;

use crate::figures::{first_frame, path_of};
use crate::{OpenedInput, SweepError, SweepHost};
use basrelief_parameters::{ConfigError, FieldPositions, TomlFault};
use basrelief_sim::{ConfigLoader, MachineInfo, Overrides, RunOptions, input_sha256};
use exclusion::Exclusion;
use std::collections::BTreeSet;
use trial::TrialFigures;
use views::{PlanView, open_seen};
use written::{BaseConfig, PlanFile, SampleMethod, SampleOptions, fault_in};

/// A run, to make a plan [around](Plan::one_at_a_time).
#[derive(Clone, Debug)]
pub struct OneAtATimeBase {
    /// Name given by the user; a trace is opened by this name.
    pub name: String,
    /// Input of the plan.
    pub opened: OpenedInput,
    /// Machine.
    pub machine: &'static MachineInfo,
    /// Parameters as they were given.
    pub given: Overrides,
    /// No step starts in this cycle or later.
    pub max_cycles: u64,
    /// True if reference images are drawn and compared.
    pub exact: bool,
}

impl OneAtATimeBase {
    /// Creates the base of a plan around a run.
    pub fn around_run(name: String, opened: OpenedInput, options: &RunOptions) -> Self {
        Self {
            name,
            opened,
            machine: options.config.machine(),
            given: options.overrides.clone(),
            max_cycles: options.max_cycles,
            exact: options.exact,
        }
    }
}

impl Plan {
    /// Reads a plan, opens its inputs, and checks names, values, figures and the number of points.
    ///
    /// # Errors
    /// The line of the first wrong field, the expected value and the cure, without the name of the file.
    pub fn read(text: &str, host: &dyn SweepHost) -> Result<Self, SweepError> {
        let at_line = |fault: TomlFault| SweepError(fault.at_line(text));
        let mut plan = Self::parse(text, host).map_err(at_line)?;
        let known = trial::run_small(&plan, host);
        plan.check_figures(known.as_ref()).map_err(at_line)?;
        Ok(plan)
    }

    /// Returns the plan of a run and of the same run with each assumed parameter at its
    /// [neighbours](basrelief_sim::ParameterInfo::neighbours), one at a time.
    ///
    /// # Errors
    /// An input that cannot be read, parameters that do not fit together.
    pub fn one_at_a_time(run: OneAtATimeBase, host: &dyn SweepHost) -> Result<Self, SweepError> {
        let OneAtATimeBase { name, opened, machine, given, max_cycles, exact } = run;
        let of_run = || {
            let loader = machine.loader(&given.toml).map_err(|error| error.to_string())?;
            let title = format!("{}, {name}", machine.name);
            let (axes, objectives) = (vec![], vec![]);
            let (constraints, inputs, points) = (vec![], vec![], vec![]);
            let mut plan =
                Self { title, inputs, machine, axes, objectives, constraints, max_cycles, exact, points, base: given, loader };
            plan.axes = plan.around_base()?;
            let samples = SampleOptions { method: SampleMethod::OneAtATime, points: None, seed: 0 };
            let places = points::axis_values(&plan.axes, &[], Some(&samples), 1).map_err(TomlFault::into_message)?;
            plan.inputs = vec![plan.input(&name, opened, host)?];
            plan.points = points::points(&plan, &places);
            Ok(plan)
        };
        of_run().map_err(SweepError)
    }

    fn parse(text: &str, host: &dyn SweepHost) -> Result<Self, TomlFault> {
        let written = PlanFile::parse(text)?;
        let inputs = written.inputs()?;
        let Some((_, first)) = inputs.first() else {
            return Err(TomlFault::new(&["input"], "input: names nothing; expected one input at least"));
        };
        let machine = match &written.machine {
            Some(name) => MachineInfo::named(name).map_err(|error| TomlFault::new(&["machine"], format!("machine: {error}")))?,
            None => MachineInfo::of_demo(first.strip_prefix("demo:").unwrap_or_default()),
        };
        let (base, loader) = base_of(&written, machine, host).map_err(|error| TomlFault::new(&["config"], error))?;
        let names = inputs.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>().join(", ");
        let positions = FieldPositions::of(text);
        let mut plan = Self {
            title: written.title.clone().unwrap_or_else(|| format!("{}, {names}", machine.name)),
            inputs: vec![],
            machine,
            axes: axes::axes(&written.axes, &written.zip, &positions)?,
            objectives: written.objectives()?,
            constraints: written.constraints()?,
            max_cycles: written.max_cycles.map_or(u64::MAX, u64::from),
            exact: true,
            points: vec![],
            base: Overrides { toml: base, settings: vec![] },
            loader,
        };
        plan.check_parameters(&written, &positions)?;
        if written.samples.as_ref().is_some_and(|samples| samples.method == SampleMethod::OneAtATime) {
            plan.axes = plan.around_base().map_err(|error| TomlFault::new(&["config"], format!("config: {error}")))?;
        }
        let exclusion = |(number, table)| Exclusion::of(number, table, &plan.axes);
        let exclusions = written.exclude.iter().enumerate().map(exclusion).collect::<Result<Vec<_>, _>>()?;
        let places = points::axis_values(&plan.axes, &exclusions, written.samples.as_ref(), inputs.len())?;
        plan.inputs = plan.open(&inputs, &PlanView::all(&written)?, host)?;
        plan.points = points::points(&plan, &places);
        Ok(plan)
    }

    /// Opens the inputs, each with its path in the plan.
    fn open(
        &self,
        inputs: &[(Vec<String>, String)],
        views: &[PlanView<'_>],
        host: &dyn SweepHost,
    ) -> Result<Vec<PlanInput>, TomlFault> {
        let open = |(path, name): &(Vec<String>, String)| {
            let opened = open_seen(path, name, views, host)?;
            self.input(name, opened, host).map_err(|error| TomlFault::new(path, format!("input: {error}")))
        };
        inputs.iter().map(open).collect()
    }

    fn input(&self, name: &str, opened: OpenedInput, host: &dyn SweepHost) -> Result<PlanInput, String> {
        let source = opened.input(name, host)?;
        let sha256 =
            input_sha256(source, &self.machine.default_config(), host.budget()).map_err(|error| format!("{name}: {error}"))?;
        let identity = identity::of_input(name, &opened, &sha256);
        Ok(PlanInput { name: name.into(), opened, identity })
    }

    /// Axes around the base configuration of the plan.
    fn around_base(&self) -> Result<Vec<Axis>, String> {
        let base = self.load(&[]).map_err(|error| error.to_string())?;
        base::with_base_first(self.axes.clone(), &base, &|key, value| self.load(&[(key.into(), value.into())]).ok())
    }

    /// Checks that each value is valid by itself, and that there is an objective.
    fn check_parameters(&self, written: &PlanFile, positions: &FieldPositions<'_>) -> Result<(), TomlFault> {
        self.check_base(written, positions)?;
        for (block, axis) in self.axis_blocks(written.zip.len()) {
            for values in &axis.values {
                self.check_values(&block, axis, values)?;
            }
        }
        if self.objectives.is_empty() {
            let message = "objectives: there are none; expected one at least, such as \"cycles min\"";
            return Err(TomlFault::new(&["objectives"], message));
        }
        Ok(())
    }

    /// Returns each axis with the path of the block that declares it. The last `zips` axes come from `[[zip]]`.
    fn axis_blocks(&self, zips: usize) -> Vec<(Vec<String>, &Axis)> {
        let (single, zipped) = self.axes.split_at(self.axes.len() - zips);
        let blocks = zipped.iter().enumerate().map(|(number, axis)| (vec!["zip".into(), number.to_string()], axis));
        single.iter().map(|axis| (vec!["axes".into()], axis)).chain(blocks).collect()
    }

    /// Checks the parameters of all points.
    fn check_base(&self, written: &PlanFile, positions: &FieldPositions<'_>) -> Result<(), TomlFault> {
        let Some(error) = self.wrong_value(&[]) else { return Ok(()) };
        let message = self.explain(&error);
        if let Some(BaseConfig::File(_)) = &written.config {
            let message = TomlFault::of_parameter(error.key(), message).at_line(&self.base.toml);
            return Err(TomlFault::new(&["config"], format!("{}: {message}", written.config_place())));
        }
        // A parameter that another one determines, or that has an old name, is not in the plan.
        let key = error.key().filter(|key| positions.start_of(&["config", key]).is_some());
        let path: Vec<&str> = std::iter::once("config").chain(key).collect();
        Err(TomlFault::new(&path, format!("config: {message}")))
    }

    /// Checks one value of each parameter of an axis.
    fn check_values(&self, block: &[String], axis: &Axis, values: &[String]) -> Result<(), TomlFault> {
        let settings: Vec<(&str, &str)> = axis.keys.iter().map(String::as_str).zip(values.iter().map(String::as_str)).collect();
        let Some(error) = self.wrong_value(&settings) else { return Ok(()) };
        // A parameter with an old name, and one that determines others, has errors of another parameter.
        let is_wrong = |setting: &(&str, &str)| error.key() == Some(setting.0) || self.wrong_value(&[*setting]).is_some();
        let wrong = settings.iter().find(|setting| is_wrong(setting)).map(|(key, _)| (*key).to_owned());
        let path: Vec<String> = block.iter().cloned().chain(wrong).collect();
        Err(TomlFault::new(&path, format!("{}: {}", block[0], self.explain(&error))))
    }

    /// Returns the error of these settings. Parameters that do not fit together are no mistake of the plan: others may mend that, and
    /// otherwise the point is a row.
    fn wrong_value(&self, settings: &[(&str, &str)]) -> Option<ConfigError> {
        self.loader.load(settings).err().filter(|error| !matches!(error, ConfigError::Unfit { .. }))
    }

    /// Describes an error of a parameter in the plan.
    fn explain(&self, error: &ConfigError) -> String {
        self.machine.explain(error, machine_field)
    }

    /// Replaces figures by their paths and checks that each exists. Without a trial run nothing is checked.
    fn check_figures(&mut self, trial: Option<&TrialFigures>) -> Result<(), TomlFault> {
        let frames = self.inputs.iter().map(PlanInput::frames).min().unwrap_or(1);
        let objectives = self.objectives.iter_mut().map(|objective| &mut objective.column).enumerate();
        let constraints = self.constraints.iter_mut().map(|constraint| &mut constraint.column).enumerate();
        let columns = objectives.map(|of| ("objectives", of)).chain(constraints.map(|of| ("constraints", of)));
        for (list, (number, column)) in columns {
            *column = path_of(column);
            let Some(trial) = trial else { continue };
            let of_frame = first_frame(column).is_some_and(|(first, frame)| trial.has(&first) && frame < frames);
            if !of_frame && !trial.has(column) {
                return Err(fault_in(list, number, trial.missing(column)));
            }
        }
        let mut seen = BTreeSet::new();
        match self.objectives.iter().enumerate().find(|(_, objective)| !seen.insert(&objective.column)) {
            Some((number, twice)) => Err(fault_in("objectives", number, format!("`{}` is named twice", twice.column))),
            None => Ok(()),
        }
    }
}

/// Cure for parameters of another machine.
fn machine_field(name: &str) -> String {
    format!("set machine = \"{name}\" in the plan")
}

/// Returns the text of the parameters of all points, and their loader.
fn base_of(written: &PlanFile, machine: &MachineInfo, host: &dyn SweepHost) -> Result<(String, ConfigLoader), String> {
    let in_config = |error: String| format!("config: {error}");
    let in_place = |error: String| format!("{}: {error}", written.config_place());
    let base = match &written.config {
        None => String::new(),
        Some(BaseConfig::Inline(table)) => toml::to_string(table).map_err(|error| in_config(error.to_string()))?,
        Some(BaseConfig::File(name)) => {
            machine.config_text(host.text(name).map_err(in_config)?, machine_field).map_err(in_place)?
        }
    };
    let loader = machine
        .loader(&base)
        .map_err(|error| in_place(TomlFault::of_parameter(error.key(), error.to_string()).at_line(&base)))?;
    Ok((base, loader))
}
