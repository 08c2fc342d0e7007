//! The service that answers questions, and its state between questions.

use crate::command::{InputName, command};
use crate::comparison::{RerunInput, RunComparison, TraceFiles, trace_input};
use crate::connection::{PathTiles, ServerConnection, TransferTotals};
use crate::host_page::HostPage;
use crate::message::Message;
use crate::render_result::{RenderResult, RoundViewer, catalogue};
use crate::request::{Request, RequestFile, RunRequest, ViewRequest};
use basrelief_deferred_renderer::TileEncoding;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::{MemoryFiles, SceneSubject};
use basrelief_sim::{
    AnalysisPolicy, AuxForm, AuxOutputInfo, MACHINES, MachineConfig, MachineInfo, Overrides, PreparedScene, RunCosts, RunInput,
    RunOptions, run, timeline_layout,
};
use basrelief_tile_server::protocol::{GroupHashes, ReceivedScene, unpack};
use basrelief_timeline::UtilizationTimeline;
use basrelief_trace::looks_like_trace;
use serde::Deserialize as _;
use serde_json::{Value, json};
use std::rc::Rc;
use std::sync::Arc;

/// Answers questions one after the other. Keeps the current input and all results that do not depend on settings.
#[derive(Default)]
pub struct SimulationService {
    /// The page; `None` without a server connection.
    page: Option<Rc<dyn HostPage>>,
    loaded: Option<LoadedInput>,
    /// Pixel costs of the last `costs` question.
    costs: Option<RunCosts>,
    comparison: RunComparison,
}

/// The current input.
struct LoadedInput {
    drawn: InputName,
    kind: InputKind,
}

enum InputKind {
    Subject(Box<SceneView>),
    /// A display list and its neighbouring files.
    Trace(TraceFiles, MemoryPool),
}

/// A model, a demo or a server's scene, with its last prepared view.
struct SceneView {
    subject: SceneSubject,
    prepared: Option<(ViewRequest, PreparedScene)>,
    budget: MemoryPool,
    #[expect(dead_code, reason = "held as long as the subject")]
    held: MemoryReservation,
    /// Connection to the server with the texels; `None` if the texels are local.
    remote: Option<RemoteScene>,
}

/// Tile size, encoding and quality of the tiles of a server.
type TileFormat = ([u32; 2], (TileEncoding, u8));

/// Connection to a server, and the hashes of its tiles in one format.
struct RemoteScene {
    path: Rc<ServerConnection>,
    format: TileFormat,
    hashes: Rc<GroupHashes>,
}

impl SceneView {
    fn local(subject: SceneSubject, held: MemoryReservation, budget: MemoryPool) -> Box<Self> {
        Box::new(Self { subject, prepared: None, budget, held, remote: None })
    }

    /// Fetches the scene of a server with the hashes of tiles in a format.
    fn fetch_scene(path: Rc<ServerConnection>, format: TileFormat, budget: MemoryPool) -> Result<Self, String> {
        let body = path.scene(format.0, format.1)?;
        let ReceivedScene { subject, hashes, held } = unpack(&body, &format!("{}scene", path.server()), &budget)?;
        let remote = Some(RemoteScene { path, format, hashes: Rc::new(hashes) });
        Ok(Self { subject, prepared: None, budget, held, remote })
    }
}

/// Returns the format in which a machine fetches tiles.
fn tile_format(config: &MachineConfig) -> Result<TileFormat, String> {
    let fetch = config.tile_fetch().ok_or_else(|| format!("only machine {} renders from a server", fetching_machine().name))?;
    Ok((fetch.tile, (fetch.encoding, fetch.jpeg_quality)))
}

/// Returns the memory limit for untrusted input. The page has 4 GiB of address space in total.
fn budget() -> MemoryPool {
    MemoryPool::with_advice(MemoryPool::DEFAULT, "the page holds no more: take less, or the command line with --memory-limit")
}

impl SimulationService {
    /// Makes a service that fetches server data through this page.
    pub fn with_page(page: Rc<dyn HostPage>) -> Self {
        Self { page: Some(page), ..Self::default() }
    }

    /// Answers an encoded [`Message`] with another. The JSON of an error answer has the single key `error`.
    pub fn answer(&mut self, question: &[u8]) -> Vec<u8> {
        let answer = Message::read(question).and_then(|question| self.answer_to(&question));
        answer.unwrap_or_else(|error| Message::from_json(json!({ "error": error }))).into_bytes()
    }

    fn answer_to(&mut self, question: &Message) -> Result<Message, String> {
        match Request::deserialize(&question.json).map_err(|e| format!("no question: {e}"))? {
            Request::Catalogue => Ok(Message::from_json(catalogue())),
            Request::Demo { name } => {
                let subject = SceneSubject::demo(&name).map_err(|e| e.to_string())?;
                let machine = MachineInfo::of_demo(&name).name;
                let budget = budget();
                let held = budget.empty_reservation();
                self.set_input(InputName::Demo(name), InputKind::Subject(SceneView::local(subject, held, budget)), machine)
            }
            Request::From { server } => {
                let kind = self.fetch_scene(&server)?;
                self.set_input(InputName::From(server), kind, fetching_machine().name)
            }
            Request::Files { name, files } => {
                let kind = open_files(&name, files, question)?;
                self.set_input(InputName::File(name), kind, MACHINES[0].name)
            }
            Request::Run(ask) => self.run(&ask),
            Request::Record { side, run } => {
                let (loaded, _, prepared) = self.prepare_run(&run)?;
                let rerun = loaded.rerun_input(&prepared.0);
                self.comparison.record(side, prepared, rerun).map(Message::from_json)
            }
            Request::Explain => self.comparison.explain().map(Message::from_json),
            Request::Costs(ask) => self.costs(&ask),
            Request::Pixel { x, y } => Ok(Message::from_json(pixel(self.costs.as_ref(), x, y))),
        }
    }

    /// Replaces the current input. `machine` is its default machine.
    fn set_input(&mut self, drawn: InputName, kind: InputKind, machine: &str) -> Result<Message, String> {
        let about = match &kind {
            InputKind::Subject(scene_view) => {
                let subject = &scene_view.subject;
                json!({ "machine": machine, "scene": true, "triangles": subject.triangles(), "warnings": subject.warnings() })
            }
            InputKind::Trace(..) => json!({ "machine": machine, "scene": false }),
        };
        self.loaded = Some(LoadedInput { drawn, kind });
        self.costs = None;
        Ok(Message::from_json(about))
    }

    /// Fetches the scene of a server.
    fn fetch_scene(&self, server: &str) -> Result<InputKind, String> {
        let page = self.page.as_ref().ok_or("there is nobody to ask for what a server has")?;
        let budget = budget();
        let path = Rc::new(ServerConnection::new(Rc::clone(page), server, &budget));
        let usual = Overrides::default().config(fetching_machine(), &[]).map_err(|e| e.to_string())?;
        Ok(InputKind::Subject(Box::new(SceneView::fetch_scene(path, tile_format(&usual)?, budget)?)))
    }

    fn run(&mut self, ask: &RunRequest) -> Result<Message, String> {
        let page = self.page.clone();
        let (loaded, machine, (input, options)) = self.prepare_run(ask)?;
        let board = timeline_layout(&input, &options).map_err(|e| e.to_string())?;
        let names = board.diagram.stages.into_iter().map(|stage| stage.name).collect();
        let path = loaded.path().cloned();
        let rounds = path.clone().zip(page).map(|(path, page)| RoundViewer::new(path, page));
        let (mut shown, mut strips) = (RenderResult::with_rounds(rounds), UtilizationTimeline::default());
        let ran = run(input, &options, &mut shown, if ask.exact { Some(&mut strips) } else { None });
        let report = ran.map_err(|e| e.to_string())?.report;
        let strips = ask.exact.then_some((strips, names));
        let mut answer = shown.answer(&report, &loaded.command(machine, ask), strips)?;
        answer.json["path"] = path.map_or(Value::Null, |path| totals_json(&path));
        Ok(answer)
    }

    /// Repeats the run to measure the cost of each pixel.
    fn costs(&mut self, ask: &RunRequest) -> Result<Message, String> {
        let (_, _, (input, options)) = self.prepare_run(ask)?;
        let options =
            RunOptions { costs: true, exact: false, bottlenecks: AnalysisPolicy::Never, aux_outputs: vec![], ..options };
        let mut shown = RenderResult::default();
        let ran = run(input, &options, &mut shown, None).map_err(|e| e.to_string())?;
        self.costs = ran.costs;
        shown.exhibits()
    }

    /// Returns the input, the machine and the options of a run.
    fn prepare_run(&mut self, ask: &RunRequest) -> Result<(&LoadedInput, &'static MachineInfo, (RunInput, RunOptions)), String> {
        let loaded = self.loaded.as_mut().ok_or("there is nothing to draw yet: choose a demo, or drop a model")?;
        let (machine, given) = (MachineInfo::named(&ask.machine)?, Overrides { toml: String::new(), settings: ask.set.clone() });
        let config = given.config(machine, &[]).map_err(|e| e.to_string())?;
        config.check().map_err(|e| e.to_string())?;
        let (input, budget) = loaded.input(&ask.view, &config)?;
        let is_here = loaded.path().is_none();
        Ok((loaded, machine, (input, options(config, given, ask, budget, is_here))))
    }
}

/// Returns the cost of a pixel; null if unknown.
fn pixel(costs: Option<&RunCosts>, x: u32, y: u32) -> Value {
    let Some(pixel) = costs.and_then(|costs| costs.pixel(x, y)) else { return Value::Null };
    let ways: Vec<Value> = pixel
        .activities
        .iter()
        .map(|way| json!({ "unit": way.unit, "kind": way.kind.name(), "of": way.of, "cycles": way.cycles }))
        .collect();
    let polygon =
        pixel.polygon.map(|polygon| json!({ "polygon": polygon.number, "object": polygon.object, "frame": polygon.frame }));
    json!({
        "cycles": pixel.cycles, "ways": ways, "overdraw": pixel.overdraw, "level": pixel.level, "entry": pixel.entry,
        "polygon": polygon,
    })
}

/// Returns the first machine that renders from a server.
fn fetching_machine() -> &'static MachineInfo {
    MACHINES.iter().find(|machine| machine.fetches_tiles).unwrap_or(&MACHINES[0])
}

/// Returns the totals received over a connection.
fn totals_json(path: &ServerConnection) -> Value {
    let TransferTotals { requests, scene_bytes, tiles, tile_bytes } = path.totals();
    json!({ "requests": requests, "scene_bytes": scene_bytes, "tiles": tiles, "tile_bytes": tile_bytes })
}

/// Returns the options of a run. `is_here` is true if the texels for an exact picture are local. Otherwise intermediate pictures
/// are shown.
fn options(config: MachineConfig, given: Overrides, ask: &RunRequest, budget: MemoryPool, is_here: bool) -> RunOptions {
    let exact = ask.exact && is_here;
    let wanted = |info: &AuxOutputInfo| match info.form {
        AuxForm::PicturePerRound => !is_here,
        _ => ask.exact && RenderResult::is_shown(info) && (exact || !info.judges),
    };
    let exhibits = basrelief_sim::aux_outputs(config.machine()).into_iter().filter(wanted).collect();
    let limits = if ask.limits { AnalysisPolicy::IfShort } else { AnalysisPolicy::Never };
    RunOptions { config, overrides: given, exact, bottlenecks: limits, aux_outputs: exhibits, budget, ..RunOptions::default() }
}

impl LoadedInput {
    /// Returns the connection to the server with the texels; `None` if the texels are local.
    fn path(&self) -> Option<&Rc<ServerConnection>> {
        match &self.kind {
            InputKind::Subject(scene_view) => scene_view.remote.as_ref().map(|remote| &remote.path),
            InputKind::Trace(..) => None,
        }
    }

    fn input(&mut self, view: &ViewRequest, config: &MachineConfig) -> Result<(RunInput, MemoryPool), String> {
        match &mut self.kind {
            InputKind::Subject(scene_view) => {
                if let Some(RemoteScene { path, format, .. }) = &scene_view.remote {
                    let (path, wanted) = (Rc::clone(path), tile_format(config)?);
                    if wanted != *format {
                        **scene_view = SceneView::fetch_scene(path, wanted, scene_view.budget.clone())?;
                    }
                }
                let SceneView { subject, prepared: seen, budget, remote, .. } = &mut **scene_view;
                let prepared = match seen.take() {
                    Some((of, prepared)) if of == *view => prepared,
                    _ => PreparedScene::cached(Arc::new(subject.seen(&view.options()).map_err(|e| e.to_string())?), budget),
                };
                *seen = Some((view.clone(), prepared.clone()));
                let input = match remote {
                    None => RunInput::Scene(prepared),
                    Some(RemoteScene { path, format: (_, encoding), hashes }) => {
                        let tiles = PathTiles::new(Rc::clone(path), Rc::clone(hashes), *encoding);
                        RunInput::Remote { scene: prepared, tiles: Box::new(tiles), name: self.drawn.name().into() }
                    }
                };
                Ok((input, budget.clone()))
            }
            InputKind::Trace(files, budget) => Ok((trace_input(self.drawn.name(), files)?, budget.clone())),
        }
    }

    /// Returns the input of more runs, for a prepared run.
    fn rerun_input(&self, prepared: &RunInput) -> Option<RerunInput> {
        match (prepared, &self.kind) {
            (RunInput::Scene(scene), _) => Some(RerunInput::Scene(scene.clone())),
            (RunInput::Trace { .. }, InputKind::Trace(files, _)) => {
                Some(RerunInput::Trace(self.drawn.name().into(), files.clone()))
            }
            _ => None,
        }
    }

    /// Returns the command that gives the same report.
    fn command(&self, machine: &MachineInfo, ask: &RunRequest) -> String {
        let usual = match &self.drawn {
            InputName::Demo(name) => MachineInfo::of_demo(name).name,
            InputName::File(_) => MACHINES[0].name,
            InputName::From(_) => fetching_machine().name,
        };
        let machine = Some(machine.name).filter(|name| *name != usual);
        let view = Some(&ask.view).filter(|_| matches!(self.kind, InputKind::Subject(..)));
        command(&self.drawn, machine, view, &ask.set)
    }
}

/// Opens a model or a display list.
fn open_files(name: &str, files: Vec<RequestFile>, question: &Message) -> Result<InputKind, String> {
    let bytes = |file: &RequestFile| question.bytes(file.at).ok_or_else(|| format!("{}: is not in the question", file.name));
    let main = files.iter().find(|file| file.name == name).ok_or_else(|| format!("{name}: is not among the files"))?;
    let budget = budget();
    if looks_like_trace(bytes(main)?) {
        let all = files.iter().map(|file| Ok((file.name.clone(), Arc::from(bytes(file)?)))).collect::<Result<_, String>>()?;
        return Ok(InputKind::Trace(all, budget));
    }
    let mut memory = MemoryFiles::default();
    for file in files.iter().filter(|file| file.name != name) {
        memory = memory.with(&file.name, bytes(file)?);
    }
    let loaded = SceneSubject::load(bytes(main)?, name, &memory, &budget);
    let (subject, held) = loaded.map_err(|e| e.to_string())?;
    Ok(InputKind::Subject(SceneView::local(subject, held, budget)))
}
