//! Plans: inputs, a machine, axes, samples, objectives and constraints, and the points that follow from them.

mod axes;
mod base;
mod definition;
mod exclusion;
mod fault;
mod identity;
mod points;
mod schema;
mod written;

pub use axes::Axis;
pub use definition::{Plan, PlanInput, PlanPoint};
pub use schema::plan_schema;

use crate::figures::{ReportFigure, first_frame, no_figure, path_of};
use crate::one;
use crate::{OpenedInput, SweepError, SweepHost};
use axes::KeyPositions;
use basrelief_parameters::{ConfigError, at_line};
use basrelief_signals::{Frame, Scene};
use basrelief_sim::{MachineInfo, Overrides, PreparedScene, RunOptions, input_sha256};
use exclusion::Exclusion;
use fault::PlanFault;
use std::collections::BTreeSet;
use std::sync::Arc;
use written::{BaseConfig, PlanFile, SampleMethod, SampleOptions};

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
        let at_line = |fault: PlanFault| SweepError(fault.at_line(text));
        let mut plan = Self::parse(text, host).map_err(at_line)?;
        let known = one::run_small(&plan, host);
        plan.check_figures(known.as_deref()).map_err(|error| at_line(error.into()))?;
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
            let places = points::axis_values(&plan.axes, &[], Some(&samples), 1)?;
            plan.inputs = vec![plan.input(&name, opened, host)?];
            plan.points = points::points(&plan, &places);
            Ok(plan)
        };
        of_run().map_err(SweepError)
    }

    fn parse(text: &str, host: &dyn SweepHost) -> Result<Self, PlanFault> {
        let written = PlanFile::parse(text)?;
        let names = written.inputs();
        let Some(first) = names.first() else {
            return Err(PlanFault::new("input", "input: names nothing; expected one input at least"));
        };
        let machine = match &written.machine {
            Some(name) => MachineInfo::named(name).map_err(|error| format!("machine: {error}"))?,
            None => MachineInfo::of_demo(first.strip_prefix("demo:").unwrap_or_default()),
        };
        let base = match &written.config {
            None => String::new(),
            Some(BaseConfig::Inline(table)) => toml::to_string(table).map_err(|error| format!("config: {error}"))?,
            Some(BaseConfig::File(name)) => host.text(name).map_err(|error| format!("config: {error}"))?,
        };
        let loader = machine.loader(&base).map_err(|error| format!("{}: {error}", written.config_place()))?;
        let mut plan = Self {
            title: written.title.clone().unwrap_or_else(|| format!("{}, {}", machine.name, names.join(", "))),
            inputs: vec![],
            machine,
            axes: axes::axes(&written.axes, &written.zip, &KeyPositions::of(text))?,
            objectives: written.objectives()?,
            constraints: written.constraints()?,
            max_cycles: written.max_cycles.unwrap_or(u64::MAX),
            exact: true,
            points: vec![],
            base: Overrides { toml: base, settings: vec![] },
            loader,
        };
        plan.check_parameters(&written)?;
        if written.samples.as_ref().is_some_and(|samples| samples.method == SampleMethod::OneAtATime) {
            plan.axes = plan.around_base()?;
        }
        let exclusion = |(number, table)| Exclusion::of(table, &plan.axes).map_err(|fault| fault.in_block(number));
        let exclusions = (0..).zip(&written.exclude).map(exclusion).collect::<Result<Vec<_>, _>>()?;
        let places = points::axis_values(&plan.axes, &exclusions, written.samples.as_ref(), names.len())?;
        let views = views(&written.view, &written.views);
        // A wrong option of a view may stand in `view` or in any of `views`. So its error has no line if there are `views`.
        let fault = |error: String| match error.starts_with("view:") && !written.views.is_empty() {
            true => PlanFault::new("", error),
            false => error.into(),
        };
        let inputs = names.iter().map(|name| plan.open(name, &views, host).map_err(fault));
        plan.inputs = inputs.collect::<Result<_, _>>()?;
        plan.points = points::points(&plan, &places);
        Ok(plan)
    }

    /// Opens an input. The frames of several views follow each other.
    fn open(&self, name: &str, views: &[ViewSettings], host: &dyn SweepHost) -> Result<PlanInput, String> {
        let mut opened = views.iter().map(|view| host.open(name, view)).collect::<Result<Vec<_>, _>>()?;
        if opened.len() > 1 {
            opened = vec![joined_views(&opened, host).map_err(|error| format!("views: {name}: {error}"))?];
        }
        let Some(opened) = opened.pop() else { return Err("views: is empty; expected a view at least".into()) };
        self.input(name, opened, host)
    }

    fn input(&self, name: &str, opened: OpenedInput, host: &dyn SweepHost) -> Result<PlanInput, String> {
        let source = opened.input(name, host)?;
        let default = self.machine.load("", &[]).map_err(|error| error.to_string())?;
        let sha256 = input_sha256(source, &default, host.budget()).map_err(|error| format!("{name}: {error}"))?;
        let identity = identity::of_input(name, &opened, &sha256);
        Ok(PlanInput { name: name.into(), opened, identity })
    }

    /// Axes around the base configuration of the plan.
    fn around_base(&self) -> Result<Vec<Axis>, String> {
        let base = self.load(&[]).map_err(|error| format!("config: {error}"))?;
        base::with_base_first(self.axes.clone(), &base, &|key, value| self.load(&[(key.into(), value.into())]).ok())
    }

    /// Checks that each parameter occurs once, and that each value is valid by itself.
    fn check_parameters(&self, written: &PlanFile) -> Result<(), PlanFault> {
        let blocks = self.axis_blocks(written.zip.len());
        let mut seen = BTreeSet::new();
        let mut keys = blocks.iter().flat_map(|(block, axis)| axis.keys.iter().map(move |key| (block, key)));
        if let Some((block, twice)) = keys.find(|(_, key)| !seen.insert(*key)) {
            let message = format!("axes: `{twice}` is on two axes; expected it on one");
            return Err(PlanFault::new(format!("{block}.{twice}"), message));
        }
        self.check_base(written)?;
        for (block, axis) in &blocks {
            for values in &axis.values {
                let settings: Vec<(&str, &str)> =
                    axis.keys.iter().map(String::as_str).zip(values.iter().map(String::as_str)).collect();
                self.wrong_value(&settings).map_or(Ok(()), |error| Err(self.value_fault(block, &error)))?;
            }
        }
        if self.objectives.is_empty() {
            let message = "objectives: there are none; expected one at least, such as \"cycles min\"";
            return Err(PlanFault::new("objectives", message));
        }
        Ok(())
    }

    /// Returns each axis with the field of the plan that declares it. The last `zips` axes come from `[[zip]]`.
    fn axis_blocks(&self, zips: usize) -> Vec<(String, &Axis)> {
        let (single, zipped) = self.axes.split_at(self.axes.len() - zips);
        let blocks = (0..).zip(zipped).map(|(number, axis): (usize, _)| (format!("zip.{number}"), axis));
        single.iter().map(|axis| ("axes".into(), axis)).chain(blocks).collect()
    }

    /// Checks the parameters of all points.
    fn check_base(&self, written: &PlanFile) -> Result<(), PlanFault> {
        let Some(error) = self.wrong_value(&[]) else { return Ok(()) };
        if let Some(BaseConfig::File(_)) = &written.config {
            let message = at_line(&self.base.toml, error.key(), self.machine.explain(&error));
            return Err(PlanFault::new("config", format!("{}: {message}", written.config_place())));
        }
        Err(self.value_fault("config", &error))
    }

    /// Returns the error of these settings. Parameters that do not fit together are no mistake of the plan: others may mend that, and
    /// otherwise the point is a row.
    fn wrong_value(&self, settings: &[(&str, &str)]) -> Option<ConfigError> {
        self.loader.load(settings).err().filter(|error| !matches!(error, ConfigError::Unfit { .. }))
    }

    /// Returns the error of a parameter that a block of the plan gives.
    fn value_fault(&self, block: &str, error: &ConfigError) -> PlanFault {
        let place = block.split('.').next().unwrap_or_default();
        let field = format!("{block}.{}", error.key().unwrap_or_default());
        PlanFault::new(field, format!("{place}: {}", self.machine.explain(error)))
    }

    /// Replaces figures by their paths and checks that each exists. Without a trial run nothing is checked.
    fn check_figures(&mut self, known: Option<&[ReportFigure]>) -> Result<(), String> {
        let of_input = |input: &PlanInput| if let OpenedInput::Scene(of) = &input.opened { of.scene().frames.len() } else { 1 };
        let frames = self.inputs.iter().map(of_input).min().unwrap_or(1);
        let columns = self.objectives.iter_mut().map(|o| ("objectives", &mut o.column));
        for (place, column) in columns.chain(self.constraints.iter_mut().map(|c| ("constraints", &mut c.column))) {
            *column = path_of(column);
            let Some(known) = known else { continue };
            let is_known = |name: &str| known.iter().any(|figure| figure.name == name);
            let of_frame = first_frame(column).is_some_and(|(first, frame)| is_known(&first) && frame < frames);
            if !of_frame && !is_known(column) {
                return Err(format!("{place}: {}", no_figure(column, known)));
            }
        }
        let mut seen = BTreeSet::new();
        match self.objectives.iter().find(|objective| !seen.insert(&objective.column)) {
            Some(twice) => Err(format!("objectives: `{}` is named twice", twice.column)),
            None => Ok(()),
        }
    }
}

/// Options of a view, as the command line takes them.
type ViewSettings = Vec<(String, String)>;

/// Returns the options of each view: those of `view`, and over them those of one of `views`, which draw one frame each unless they
/// state more.
fn views(common: &toml::Table, views: &[toml::Table]) -> Vec<ViewSettings> {
    let settings = |table: &toml::Table| table.iter().map(|(name, value)| (name.clone(), setting_text(value))).collect();
    let over_common = |view: &toml::Table| {
        let mut all = common.clone();
        all.extend(view.clone());
        all.entry("frames").or_insert(toml::Value::Integer(1));
        settings(&all)
    };
    if views.is_empty() { vec![settings(common)] } else { views.iter().map(over_common).collect() }
}

/// Returns one scene with the frames of all views.
fn joined_views(opened: &[OpenedInput], host: &dyn SweepHost) -> Result<OpenedInput, String> {
    let scene = |input: &OpenedInput| match input {
        OpenedInput::Scene(prepared) => Ok(Arc::clone(prepared.scene())),
        OpenedInput::Trace => Err("a trace has its own view; remove `views`".to_owned()),
    };
    let scenes = opened.iter().map(scene).collect::<Result<Vec<_>, _>>()?;
    let all = scenes.iter().flat_map(|scene| &scene.frames);
    let frames: Vec<Arc<Frame>> = (0..).zip(all).map(|(index, frame)| Arc::new(Frame { index, ..(**frame).clone() })).collect();
    let mut sizes: Vec<(u32, u32)> = frames.iter().map(|frame| (frame.width, frame.height)).collect();
    sizes.dedup();
    match (scenes.first(), sizes.as_slice()) {
        (Some(first), [_]) => {
            let joined = Scene { frames, ..(**first).clone() };
            Ok(OpenedInput::Scene(PreparedScene::cached(Arc::new(joined), host.budget())))
        }
        _ => Err(format!("have the sizes {sizes:?}; expected one size for all views")),
    }
}

/// A value as the command line takes it.
fn setting_text(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        toml::Value::Array(values) => values.iter().map(setting_text).collect::<Vec<_>>().join(","),
        other => other.to_string(),
    }
}
