//! The current input, with its last prepared view.

use crate::command::{InputName, command, quoted};
use crate::comparison::{RerunInput, TraceFiles, trace_input};
use crate::connection::ServerConnection;
use crate::draft::{DraftPages, DraftRecord, DraftTiles};
use crate::host_page::{HostPage, PageResponse};
use crate::message::Message;
use crate::request::{RequestFile, RunRequest, ViewRequest};
use crate::tiles::PathTiles;
use basrelief_deferred_renderer::{TileFormat, TileSource};
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::{MemoryFiles, SceneSubject};
use basrelief_sim::{MACHINES, MachineConfig, MachineInfo, Overrides, PreparedScene, RunInput};
use basrelief_tile_server::protocol::{GroupHashes, ReceivedScene, unpack};
use basrelief_trace::{TraceForm, looks_compressed, looks_like_trace};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// The current input.
pub(crate) struct LoadedInput {
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

/// Connection to a server, and the hashes of its tiles in one format.
pub(crate) struct RemoteScene {
    path: Rc<ServerConnection>,
    format: TileFormat,
    hashes: Rc<GroupHashes>,
    /// Textures with tiles that a draft lacked, by the start of the addresses of their tiles.
    drafted: DraftPages,
}

impl RemoteScene {
    fn tiles(&self) -> PathTiles {
        PathTiles::new(Rc::clone(&self.path), Rc::clone(&self.hashes), self.format)
    }

    /// Keeps the textures of tiles that a draft lacked.
    pub(crate) fn add_pages(&mut self, pages: DraftPages) {
        self.drafted.retain(|(cut, _)| pages.iter().all(|(of, _)| of != cut));
        self.drafted.extend(pages);
    }

    /// Caches a response that the page has fetched.
    ///
    /// # Errors
    /// The response is wrong.
    pub(crate) fn receive(&self, address: &str, response: PageResponse) -> Result<(), String> {
        let found = self.drafted.iter().find(|(cut, _)| address.strip_prefix(cut).is_some_and(|rest| rest.starts_with('/')));
        self.tiles().receive(address, found.map(|(_, page)| &**page), response)
    }
}

impl SceneView {
    fn local(subject: SceneSubject, held: MemoryReservation, budget: MemoryPool) -> Box<Self> {
        Box::new(Self { subject, prepared: None, budget, held, remote: None })
    }

    /// Fetches the scene of a server with the hashes of tiles in a format.
    fn fetch_scene(path: Rc<ServerConnection>, format: TileFormat, budget: MemoryPool) -> Result<Self, String> {
        let body = path.scene(format)?;
        let ReceivedScene { subject, hashes, held } = unpack(&body, &format!("{}scene", path.server()), &budget)?;
        let remote = Some(RemoteScene { path, format, hashes: Rc::new(hashes), drafted: vec![] });
        Ok(Self { subject, prepared: None, budget, held, remote })
    }
}

/// Returns the first machine that renders from a server.
fn fetching_machine() -> &'static MachineInfo {
    MACHINES.iter().find(|machine| machine.fetches_tiles).unwrap_or(&MACHINES[0])
}

/// Returns the format in which a machine fetches tiles.
fn tile_format(config: &MachineConfig) -> Result<TileFormat, String> {
    let fetch = config.tile_fetch().ok_or_else(|| format!("only machine {} renders from a server", fetching_machine().name))?;
    Ok(fetch.format)
}

/// Returns the memory limit for untrusted input. The page has 4 GiB of address space in total.
fn budget() -> MemoryPool {
    MemoryPool::with_advice(MemoryPool::DEFAULT, "the page holds no more: take less, or the command line with --memory-limit")
}

impl LoadedInput {
    /// Opens a demo.
    pub(crate) fn demo(name: String) -> Result<Self, String> {
        let subject = SceneSubject::demo(&name).map_err(|e| e.to_string())?;
        let budget = budget();
        let held = budget.empty_reservation();
        Ok(Self { drawn: InputName::Demo(name), kind: InputKind::Subject(SceneView::local(subject, held, budget)) })
    }

    /// Fetches the scene of a server.
    pub(crate) fn fetch(page: Rc<dyn HostPage>, server: String) -> Result<Self, String> {
        let budget = budget();
        let path = Rc::new(ServerConnection::new(page, &server, &budget));
        let usual = Overrides::default().config(fetching_machine(), &[]).map_err(|e| e.to_string())?;
        let scene_view = SceneView::fetch_scene(path, tile_format(&usual)?, budget)?;
        Ok(Self { drawn: InputName::From(server), kind: InputKind::Subject(Box::new(scene_view)) })
    }

    /// Opens a model or a display list.
    pub(crate) fn open(name: String, files: Vec<RequestFile>, question: &Message) -> Result<Self, String> {
        let kind = open_files(&name, files, question)?;
        Ok(Self { drawn: InputName::File(name), kind })
    }

    /// Returns its default machine.
    fn usual_machine(&self) -> &'static str {
        match &self.drawn {
            InputName::Demo(name) => MachineInfo::of_demo(name).name,
            InputName::File(_) => MACHINES[0].name,
            InputName::From(_) => fetching_machine().name,
        }
    }

    /// Describes it for the page.
    pub(crate) fn about(&self) -> Value {
        let machine = self.usual_machine();
        match &self.kind {
            InputKind::Subject(scene_view) => {
                let subject = &scene_view.subject;
                json!({ "machine": machine, "scene": true, "triangles": subject.triangles(), "warnings": subject.warnings() })
            }
            InputKind::Trace(..) => json!({ "machine": machine, "scene": false }),
        }
    }

    /// Returns the connection to the server with the texels; `None` if the texels are local.
    pub(crate) fn path(&self) -> Option<&Rc<ServerConnection>> {
        match &self.kind {
            InputKind::Subject(scene_view) => scene_view.remote.as_ref().map(|remote| &remote.path),
            InputKind::Trace(..) => None,
        }
    }

    pub(crate) fn remote(&mut self) -> Option<&mut RemoteScene> {
        match &mut self.kind {
            InputKind::Subject(scene_view) => scene_view.remote.as_mut(),
            InputKind::Trace(..) => None,
        }
    }

    pub(crate) fn input(
        &mut self,
        view: &ViewRequest,
        config: &MachineConfig,
        draft: Option<&Rc<RefCell<DraftRecord>>>,
    ) -> Result<(RunInput, MemoryPool), String> {
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
                    Some(remote) => {
                        let tiles: Box<dyn TileSource> = match draft {
                            Some(record) => Box::new(DraftTiles::new(remote.tiles(), Rc::clone(record))),
                            None => Box::new(remote.tiles()),
                        };
                        RunInput::Remote { scene: prepared, tiles, name: self.drawn.name().into() }
                    }
                };
                Ok((input, budget.clone()))
            }
            InputKind::Trace(files, budget) => Ok((trace_input(self.drawn.name(), files)?, budget.clone())),
        }
    }

    /// Returns the input of more runs, for a prepared run.
    pub(crate) fn rerun_input(&self, prepared: &RunInput) -> Option<RerunInput> {
        match (prepared, &self.kind) {
            (RunInput::Scene(scene), _) => Some(RerunInput::Scene(scene.clone())),
            (RunInput::Trace { .. }, InputKind::Trace(files, _)) => {
                Some(RerunInput::Trace(self.drawn.name().into(), files.clone()))
            }
            _ => None,
        }
    }

    /// Returns the command that gives the same report.
    pub(crate) fn command(&self, machine: &MachineInfo, ask: &RunRequest) -> String {
        let machine = Some(machine.name).filter(|name| *name != self.usual_machine());
        let view = Some(&ask.view).filter(|_| matches!(self.kind, InputKind::Subject(..)));
        command(&self.drawn, machine, view, &ask.set)
    }
}

/// Opens a model or a display list.
fn open_files(name: &str, files: Vec<RequestFile>, question: &Message) -> Result<InputKind, String> {
    let bytes = |file: &RequestFile| question.bytes(file.at).ok_or_else(|| format!("{}: is not in the question", file.name));
    let main = files.iter().find(|file| file.name == name).ok_or_else(|| format!("{name}: is not among the files"))?;
    let budget = budget();
    check_is_not_compressed(name, bytes(main)?)?;
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

/// Refuses compressed traces and recordings of runs, which are compressed likewise. The page has no decompressor.
fn check_is_not_compressed(name: &str, bytes: &[u8]) -> Result<(), String> {
    if !looks_compressed(bytes) {
        return Ok(());
    }
    // Only the name tells them apart without a decompressor.
    if name.ends_with(".recording") {
        let cure = format!("`basrelief resimulate {}` reads it", quoted(name));
        return Err(format!("{name}: the recording of a run, expected a model or a trace; {cure}"));
    }
    let stem = name.strip_suffix(".zst").filter(|stem| TraceForm::for_file_name(stem).is_some());
    let plain = stem.map_or_else(|| format!("{name}.bdl"), str::to_owned);
    Err(format!(
        "{name}: is compressed with zstd, which this page cannot read; expected a model or an uncompressed trace; \
         `basrelief convert {} {}` decompresses a trace",
        quoted(name),
        quoted(&plain)
    ))
}
