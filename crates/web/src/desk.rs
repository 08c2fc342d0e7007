//! The service that answers questions, and its state between questions.

use crate::ask::{Ask, File, RunAsk, View};
use crate::command::{Drawn, command};
use crate::outside::Outside;
use crate::parcel::Parcel;
use crate::path::{Come, Path, PathTiles};
use crate::shown::{Rounds, Shown, catalogue};
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
use std::collections::BTreeMap;
use std::io::{self, Cursor, Read};
use std::rc::Rc;
use std::sync::Arc;

/// Answers questions one after the other. Keeps the current input and all results that do not depend on settings.
#[derive(Default)]
pub struct Desk {
    /// The page; `None` without a server connection.
    outside: Option<Rc<dyn Outside>>,
    lying: Option<Lying>,
    /// Pixel costs of the last `costs` question.
    costs: Option<RunCosts>,
}

/// The current input.
struct Lying {
    drawn: Drawn,
    kind: Kind,
}

enum Kind {
    Subject(Box<Looked>),
    /// A display list and its neighbouring files.
    Trace(BTreeMap<String, Arc<[u8]>>, MemoryPool),
}

/// A model, a demo or a server's scene, with its last prepared view.
struct Looked {
    subject: SceneSubject,
    seen: Option<(View, PreparedScene)>,
    budget: MemoryPool,
    #[expect(dead_code, reason = "held as long as the subject")]
    held: MemoryReservation,
    /// Connection to the server with the texels; `None` if the texels are local.
    remote: Option<Remote>,
}

/// Tile size, encoding and quality of the tiles of a server.
type TileFormat = ([u32; 2], (TileEncoding, u8));

/// Connection to a server, and the hashes of its tiles in one format.
struct Remote {
    path: Rc<Path>,
    format: TileFormat,
    hashes: Rc<GroupHashes>,
}

impl Looked {
    fn local(subject: SceneSubject, held: MemoryReservation, budget: MemoryPool) -> Box<Self> {
        Box::new(Self { subject, seen: None, budget, held, remote: None })
    }

    /// Fetches the scene of a server with the hashes of tiles in a format.
    fn fetched(path: Rc<Path>, format: TileFormat, budget: MemoryPool) -> Result<Self, String> {
        let body = path.scene(format.0, format.1)?;
        let ReceivedScene { subject, hashes, held } = unpack(&body, &format!("{}scene", path.server()), &budget)?;
        let remote = Some(Remote { path, format, hashes: Rc::new(hashes) });
        Ok(Self { subject, seen: None, budget, held, remote })
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

impl Desk {
    /// Makes a service that fetches server data through this page.
    pub fn within(outside: Rc<dyn Outside>) -> Self {
        Self { outside: Some(outside), ..Self::default() }
    }

    /// Answers an encoded [`Parcel`] with another. The JSON of an error answer has the single key `error`.
    pub fn answer(&mut self, question: &[u8]) -> Vec<u8> {
        let answer = Parcel::read(question).and_then(|question| self.answer_to(&question));
        answer.unwrap_or_else(|error| Parcel::of(json!({ "error": error }))).into_bytes()
    }

    fn answer_to(&mut self, question: &Parcel) -> Result<Parcel, String> {
        match Ask::deserialize(&question.json).map_err(|e| format!("no question: {e}"))? {
            Ask::Catalogue => Ok(Parcel::of(catalogue())),
            Ask::Demo { name } => {
                let subject = SceneSubject::demo(&name).map_err(|e| e.to_string())?;
                let machine = MachineInfo::of_demo(&name).name;
                let budget = budget();
                let held = budget.empty_reservation();
                self.take(Drawn::Demo(name), Kind::Subject(Looked::local(subject, held, budget)), machine)
            }
            Ask::From { server } => {
                let kind = self.fetched(&server)?;
                self.take(Drawn::From(server), kind, fetching_machine().name)
            }
            Ask::Files { name, files } => {
                let kind = opened(&name, files, question)?;
                self.take(Drawn::File(name), kind, MACHINES[0].name)
            }
            Ask::Run(ask) => self.run(&ask),
            Ask::Costs(ask) => self.costs(&ask),
            Ask::Pixel { x, y } => Ok(Parcel::of(pixel(self.costs.as_ref(), x, y))),
        }
    }

    /// Replaces the current input. `machine` is its default machine.
    fn take(&mut self, drawn: Drawn, kind: Kind, machine: &str) -> Result<Parcel, String> {
        let about = match &kind {
            Kind::Subject(looked) => {
                let subject = &looked.subject;
                json!({ "machine": machine, "scene": true, "triangles": subject.triangles(), "warnings": subject.warnings() })
            }
            Kind::Trace(..) => json!({ "machine": machine, "scene": false }),
        };
        self.lying = Some(Lying { drawn, kind });
        self.costs = None;
        Ok(Parcel::of(about))
    }

    /// Fetches the scene of a server.
    fn fetched(&self, server: &str) -> Result<Kind, String> {
        let outside = self.outside.as_ref().ok_or("there is nobody to ask for what a server has")?;
        let budget = budget();
        let path = Rc::new(Path::new(Rc::clone(outside), server, &budget));
        let usual = Overrides::default().config(fetching_machine(), &[]).map_err(|e| e.to_string())?;
        Ok(Kind::Subject(Box::new(Looked::fetched(path, tile_format(&usual)?, budget)?)))
    }

    fn run(&mut self, ask: &RunAsk) -> Result<Parcel, String> {
        let outside = self.outside.clone();
        let (lying, machine, (input, options)) = self.asked(ask)?;
        let board = timeline_layout(&input, &options).map_err(|e| e.to_string())?;
        let names = board.diagram.stages.into_iter().map(|stage| stage.name).collect();
        let path = lying.path().cloned();
        let rounds = path.clone().zip(outside).map(|(path, outside)| Rounds::new(path, outside));
        let (mut shown, mut strips) = (Shown::with(rounds), UtilizationTimeline::default());
        let ran = run(input, &options, &mut shown, if ask.exact { Some(&mut strips) } else { None });
        let report = ran.map_err(|e| e.to_string())?.report;
        let strips = ask.exact.then_some((strips, names));
        let mut answer = shown.answer(&report, &lying.command(machine, ask), strips)?;
        answer.json["path"] = path.map_or(Value::Null, |path| come(&path));
        Ok(answer)
    }

    /// Repeats the run to measure the cost of each pixel.
    fn costs(&mut self, ask: &RunAsk) -> Result<Parcel, String> {
        let (_, _, (input, options)) = self.asked(ask)?;
        let options =
            RunOptions { costs: true, exact: false, bottlenecks: AnalysisPolicy::Never, aux_outputs: vec![], ..options };
        let mut shown = Shown::default();
        let ran = run(input, &options, &mut shown, None).map_err(|e| e.to_string())?;
        self.costs = ran.costs;
        shown.exhibits()
    }

    /// Returns the input, the machine and the options of a run.
    fn asked(&mut self, ask: &RunAsk) -> Result<(&Lying, &'static MachineInfo, (RunInput, RunOptions)), String> {
        let lying = self.lying.as_mut().ok_or("there is nothing to draw yet: choose a demo, or drop a model")?;
        let (machine, given) = (MachineInfo::named(&ask.machine)?, Overrides { toml: String::new(), settings: ask.set.clone() });
        let config = given.config(machine, &[]).map_err(|e| e.to_string())?;
        config.check().map_err(|e| e.to_string())?;
        let (input, budget) = lying.input(&ask.view, &config)?;
        let is_here = lying.path().is_none();
        Ok((lying, machine, (input, options(config, given, ask, budget, is_here))))
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
fn come(path: &Path) -> Value {
    let Come { requests, scene_bytes, tiles, tile_bytes } = path.come();
    json!({ "requests": requests, "scene_bytes": scene_bytes, "tiles": tiles, "tile_bytes": tile_bytes })
}

/// Returns the options of a run. `is_here` is true if the texels for an exact picture are local. Otherwise intermediate pictures
/// are shown.
fn options(config: MachineConfig, given: Overrides, ask: &RunAsk, budget: MemoryPool, is_here: bool) -> RunOptions {
    let exact = ask.exact && is_here;
    let wanted = |info: &AuxOutputInfo| match info.form {
        AuxForm::PicturePerRound => !is_here,
        _ => ask.exact && Shown::takes(info) && (exact || !info.judges),
    };
    let exhibits = basrelief_sim::aux_outputs(config.machine()).into_iter().filter(wanted).collect();
    let limits = if ask.limits { AnalysisPolicy::IfShort } else { AnalysisPolicy::Never };
    RunOptions { config, overrides: given, exact, bottlenecks: limits, aux_outputs: exhibits, budget, ..RunOptions::default() }
}

impl Lying {
    /// Returns the connection to the server with the texels; `None` if the texels are local.
    fn path(&self) -> Option<&Rc<Path>> {
        match &self.kind {
            Kind::Subject(looked) => looked.remote.as_ref().map(|remote| &remote.path),
            Kind::Trace(..) => None,
        }
    }

    fn input(&mut self, view: &View, config: &MachineConfig) -> Result<(RunInput, MemoryPool), String> {
        match &mut self.kind {
            Kind::Subject(looked) => {
                if let Some(Remote { path, format, .. }) = &looked.remote {
                    let (path, wanted) = (Rc::clone(path), tile_format(config)?);
                    if wanted != *format {
                        **looked = Looked::fetched(path, wanted, looked.budget.clone())?;
                    }
                }
                let Looked { subject, seen, budget, remote, .. } = &mut **looked;
                let prepared = match seen.take() {
                    Some((of, prepared)) if of == *view => prepared,
                    _ => PreparedScene::cached(Arc::new(subject.seen(&view.options()).map_err(|e| e.to_string())?), budget),
                };
                *seen = Some((view.clone(), prepared.clone()));
                let input = match remote {
                    None => RunInput::Scene(prepared),
                    Some(Remote { path, format: (_, encoding), hashes }) => {
                        let tiles = PathTiles::new(Rc::clone(path), Rc::clone(hashes), *encoding);
                        RunInput::Remote { scene: prepared, tiles: Box::new(tiles), name: self.drawn.name().into() }
                    }
                };
                Ok((input, budget.clone()))
            }
            Kind::Trace(files, budget) => {
                let name = self.drawn.name();
                let reader = Box::new(Cursor::new(Arc::clone(files.get(name).ok_or("the display list is gone")?)));
                let files = files.clone();
                let beside = move |name: &str| match files.get(name) {
                    Some(bytes) => Ok(Box::new(Cursor::new(Arc::clone(bytes))) as Box<dyn Read>),
                    None => Err(io::Error::from(io::ErrorKind::NotFound)),
                };
                Ok((RunInput::Trace { reader, files: Box::new(beside), name: name.into() }, budget.clone()))
            }
        }
    }

    /// Returns the command that gives the same report.
    fn command(&self, machine: &MachineInfo, ask: &RunAsk) -> String {
        let usual = match &self.drawn {
            Drawn::Demo(name) => MachineInfo::of_demo(name).name,
            Drawn::File(_) => MACHINES[0].name,
            Drawn::From(_) => fetching_machine().name,
        };
        let machine = Some(machine.name).filter(|name| *name != usual);
        let view = Some(&ask.view).filter(|_| matches!(self.kind, Kind::Subject(..)));
        command(&self.drawn, machine, view, &ask.set)
    }
}

/// Opens a model or a display list.
fn opened(name: &str, files: Vec<File>, question: &Parcel) -> Result<Kind, String> {
    let bytes = |file: &File| question.bytes(file.at).ok_or_else(|| format!("{}: is not in the question", file.name));
    let main = files.iter().find(|file| file.name == name).ok_or_else(|| format!("{name}: is not among the files"))?;
    let budget = budget();
    if looks_like_trace(bytes(main)?) {
        let all = files.iter().map(|file| Ok((file.name.clone(), Arc::from(bytes(file)?)))).collect::<Result<_, String>>()?;
        return Ok(Kind::Trace(all, budget));
    }
    let mut memory = MemoryFiles::default();
    for file in files.iter().filter(|file| file.name != name) {
        memory = memory.with(&file.name, bytes(file)?);
    }
    let loaded = SceneSubject::load_within(bytes(main)?, name, &memory, &budget);
    let (subject, held) = loaded.map_err(|e| e.to_string())?;
    Ok(Kind::Subject(Looked::local(subject, held, budget)))
}
