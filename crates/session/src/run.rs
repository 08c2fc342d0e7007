//! One run.

use crate::exact::{Exact, options_of};
use crate::observer::{Observer, Pictures, picture_name};
use crate::record::hash_of;
use crate::settings::{Settings, Source};
use crate::tee::{Seen, Tee};
use basrelief_display_list::{Expectation, Resolver, TraceError};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::{self as kernel, Limits, Outcome, Probe, RunReport, StageTopology};
use basrelief_machines::Counts;
use basrelief_machines::bump::{self, BumpProcessor, ConfigProblem, FrontEnd, SceneFront, TraceFront};
use basrelief_reference::{Picture, Quality};
use basrelief_report::model::{Figure, Input, Picture as PictureFile, PictureQuality, Size};
use basrelief_report::{Facts, Report};
use basrelief_signals::{Camera, Control, Draw, Frame, Scene};
use sha2::{Digest as _, Sha256};
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::Arc;

/// What can keep a run from giving a report.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The trace.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// Parameters that do not fit together.
    #[error(transparent)]
    Config(#[from] ConfigProblem),
    /// A unit could not go on.
    #[error("{0}")]
    Fault(String),
    /// The observer could not take a frame.
    #[error("{0}")]
    Observer(String),
}

/// What a run came to.
#[derive(Debug)]
pub struct Run {
    /// The report, without host figures.
    pub report: Report,
    /// What the engine came to; `None` for the functional model.
    pub timing: Option<RunReport>,
    /// What a trace expects of its replay.
    pub expectations: Vec<Expectation>,
    /// From the first to the last simulated step, without reading, exact drawing, metrics and writing \[s\].
    pub simulate_s: f64,
}

impl Run {
    /// The report with the host's figures: `wall_s` is the time of everything \[s\].
    pub fn with_host(self, wall_s: f64) -> Report {
        self.report.with_host(wall_s, self.simulate_s)
    }
}

/// The stages of the machine under these settings, in the order in which a probe numbers them.
///
/// # Errors
/// Parameters that do not fit together.
pub fn stages(source: &Source, settings: &Settings) -> Result<Vec<StageTopology>, ConfigProblem> {
    let config = &settings.config;
    match source {
        Source::Scene(_) => {
            let front = SceneFront::new(std::iter::empty::<Draw>(), config);
            BumpProcessor::new(front, config).map(|mut m| kernel::topology(&mut m))
        }
        Source::Trace { .. } => {
            let front = TraceFront::new(std::iter::empty::<Result<(Control, Option<u64>), String>>(), config);
            BumpProcessor::new(front, config).map(|mut m| kernel::topology(&mut m))
        }
    }
}

/// Runs `source` on the machine: draws it, draws it exactly, measures, reports.
///
/// A deadlock, the limit of cycles and a stop by the observer are outcomes in the report.
///
/// # Errors
/// What keeps a run from giving a report: see [`SessionError`].
pub fn run<P: Probe>(
    source: Source,
    settings: &Settings,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    match source {
        Source::Scene(scene) => run_scene(&scene, settings, observer, probe),
        Source::Trace { reader, files, name } => {
            let mut files = files;
            let resolver = Resolver::new(reader, move |name: &str| files.open(name))?;
            let seen = Rc::new(RefCell::new(Seen::default()));
            let exact = settings.exact.then(|| options_of(&settings.config));
            let tee = Tee::new(resolver, exact, Rc::clone(&seen), settings.clock);
            let front = TraceFront::new(tee, &settings.config);
            run_trace(front, &seen, name, settings, observer, probe)
        }
    }
}

fn run_scene<P: Probe>(
    scene: &Arc<Scene>,
    settings: &Settings,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    let sha256 = hash_of(scene, &settings.config)?.to_string();
    let commands = Rc::new(Cell::new(0_u64));
    let counter = Rc::clone(&commands);
    let draws = SceneDraws::new(Arc::clone(scene)).inspect(move |_: &Draw| counter.set(counter.get() + 1));
    let machine = BumpProcessor::new(SceneFront::new(draws, &settings.config), &settings.config)?;
    let per_frame: usize = 2 + scene.objects.iter().map(|o| o.mesh.indices.len() / 3 + 1).sum::<usize>();
    let exact = if settings.exact { Exact::Scene(Arc::clone(scene), options_of(&settings.config)) } else { Exact::None };
    let total = Some((per_frame * scene.frames.len()) as u64);
    let mut session = Session::new(settings, observer, exact, Box::new(move || (commands.get(), total)));
    let driven = session.drive(machine, probe)?;
    let input = Input { kind: "scene".into(), name: scene.name.clone(), sha256 };
    let frame = scene.frames.last().map(|f| &**f);
    Ok(session.finish(input, frame, driven, &scene.warnings, vec![]))
}

fn run_trace<F: FrontEnd, P: Probe>(
    front: F,
    seen: &Rc<RefCell<Seen>>,
    name: String,
    settings: &Settings,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    let machine = BumpProcessor::new(front, &settings.config)?;
    let exact = if settings.exact { Exact::Trace(Rc::clone(seen)) } else { Exact::None };
    let commands = Rc::clone(seen);
    let mut session = Session::new(settings, observer, exact, Box::new(move || (commands.borrow().commands, None)));
    let driven = session.drive(machine, probe);
    if let Some(error) = seen.borrow_mut().error.take() {
        return Err(error.into());
    }
    let driven = driven?;
    let passed = std::mem::take(&mut *seen.borrow_mut());
    session.simulate_s -= passed.seconds;
    let sha256 = passed.digest.map(|d| d.to_string()).unwrap_or_default();
    let input = Input { kind: "trace".into(), name, sha256 };
    Ok(session.finish(input, passed.frame.as_deref(), driven, &[], passed.expectations))
}

/// What the engine came to, and what the units counted.
struct Driven {
    counts: Counts,
    report: Option<RunReport>,
}

/// A run under way.
struct Session<'a> {
    settings: &'a Settings,
    observer: &'a mut dyn Observer,
    exact: Exact,
    commands: Box<dyn Fn() -> (u64, Option<u64>)>,
    images: Vec<String>,
    quality: Vec<Quality>,
    failed: Option<String>,
    simulate_s: f64,
}

impl<'a> Session<'a> {
    fn new(
        settings: &'a Settings,
        observer: &'a mut dyn Observer,
        exact: Exact,
        commands: Box<dyn Fn() -> (u64, Option<u64>)>,
    ) -> Self {
        let (images, quality) = (Vec::new(), Vec::new());
        Self { settings, observer, exact, commands, images, quality, failed: None, simulate_s: 0.0 }
    }

    /// Simulates to the end.
    fn drive<F: FrontEnd, P: Probe>(&mut self, mut machine: BumpProcessor<F>, probe: &mut P) -> Result<Driven, SessionError> {
        let &Settings { clock, engine, max_cycles, .. } = self.settings;
        let began = clock();
        let mut aside = 0.0;
        let report = {
            let mut progress = |machine: &mut BumpProcessor<F>| self.look(machine, &mut aside);
            match engine {
                Some(engine) => {
                    let limits = Limits { max_cycles, progress: &mut progress };
                    Some(kernel::run_with(&mut machine, engine, probe, limits))
                }
                None => match kernel::run_functional(&mut machine, &mut progress) {
                    Ok(()) => None,
                    Err(fault) => return Err(self.fault(fault)),
                },
            }
        };
        self.simulate_s = clock() - began - aside;
        self.take_frames(&mut machine);
        if let Some(RunReport { outcome: Outcome::Fault(fault), .. }) = &report {
            return Err(self.fault(fault.clone()));
        }
        match self.failed.take() {
            Some(failed) => Err(SessionError::Observer(failed)),
            None => Ok(Driven { counts: machine.counts(), report }),
        }
    }

    fn fault(&mut self, fault: String) -> SessionError {
        self.failed.take().map_or(SessionError::Fault(fault), SessionError::Observer)
    }

    /// Called by the engine between its rounds; what is done here counts as no simulation.
    fn look<F: FrontEnd>(&mut self, machine: &mut BumpProcessor<F>, aside: &mut f64) -> bool {
        if machine.has_finished() {
            let began = (self.settings.clock)();
            self.take_frames(machine);
            *aside += (self.settings.clock)() - began;
        }
        let (commands, total) = (self.commands)();
        self.failed.is_none() && self.observer.progress(commands, total)
    }

    fn take_frames<F: FrontEnd>(&mut self, machine: &mut BumpProcessor<F>) {
        for frame in machine.drain_finished() {
            if self.failed.is_none() {
                self.failed = self.take_frame(frame).err();
            }
        }
    }

    fn take_frame(&mut self, frame: FinishedFrame) -> Result<(), String> {
        let index = self.images.len();
        let machine = Picture { width: frame.width, height: frame.height, rgb: frame.rgb, covered: frame.covered };
        self.images.push(digest(&machine));
        let exact = self.exact.picture(index);
        let quality = exact.as_ref().map(|e| Quality::measure(e, &machine)).transpose().map_err(|e| e.to_string())?;
        self.quality.extend(quality);
        self.observer.frame(&Pictures { index, machine: &machine, exact: exact.as_ref().zip(quality) })
    }

    fn finish(
        self,
        input: Input,
        frame: Option<&Frame>,
        driven: Driven,
        warnings: &[String],
        expectations: Vec<Expectation>,
    ) -> Run {
        let several = self.images.len() > 1;
        let image = self.images.into_iter().enumerate();
        let no_view = Camera { view_projection: [0.0; 16], to_light: [0.0; 3], to_viewer: [0.0; 3] };
        let facts = Facts {
            machine: "bump".into(),
            input,
            config: serde_json::to_value(&self.settings.config).unwrap_or_default(),
            camera: frame.map_or(no_view, |f| f.camera),
            size: frame.map_or(Size { width: 0, height: 0 }, |f| Size { width: f.width, height: f.height }),
            numerals: bump::UNITS.iter().filter_map(|u| Some((u.name.to_owned(), u.numeral.parse().ok()?))).collect(),
            device: driven.counts.iter().map(|(name, value)| (name.to_owned(), figure(value))).collect(),
            quality: self
                .quality
                .last()
                .map(|&last| PictureQuality { last, frames: if several { self.quality.clone() } else { vec![] } }),
            image: image.map(|(i, sha256)| PictureFile { file: picture_name("image", i, several), sha256 }).collect(),
            warnings: (warnings.iter().cloned())
                .chain(bump::warnings(&self.settings.config))
                .chain(bump::claim_3_warning(&self.settings.config, &driven.counts))
                .collect(),
        };
        let report = match &driven.report {
            Some(run) => Report::timed(facts, run),
            None => Report::functional(facts, &Outcome::Complete),
        };
        Run { report, timing: driven.report, expectations, simulate_s: self.simulate_s }
    }
}

/// SHA-256 of the RGB8 rows, top row first.
fn digest(picture: &Picture) -> String {
    let mut hash = Sha256::new();
    hash.update(picture.rgb.as_flattened());
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

fn figure(value: &serde_json::Value) -> Figure {
    serde_json::from_value(value.clone()).unwrap_or_else(|_| Figure::Text(value.to_string()))
}
