//! The service that answers questions, and its state between questions.

use crate::comparison::RunComparison;
use crate::connection::{ServerConnection, TransferTotals};
use crate::draft::{DraftPicture, DraftRecord};
use crate::host_page::{HostPage, PageResponse};
use crate::loaded_input::LoadedInput;
use crate::message::Message;
use crate::render_result::{RenderResult, RoundViewer, catalogue};
use crate::request::{Request, RunRequest};
use basrelief_input::MemoryPool;
use basrelief_sim::{
    AnalysisPolicy, AuxForm, AuxOutputInfo, MachineConfig, MachineInfo, Overrides, RunCosts, RunInput, RunOptions, list_steps,
    run, timeline_layout,
};
use basrelief_timeline::{TimelineStep, UtilizationTimeline};
use serde::Deserialize as _;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::rc::Rc;

/// Maximum number of cycles whose steps are listed.
const MOST_CYCLES: u64 = 4096;

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
            Request::Demo { name } => self.set_input(LoadedInput::demo(name)?),
            Request::From { server } => {
                let page = self.page.as_ref().ok_or("there is nobody to ask for what a server has")?;
                self.set_input(LoadedInput::fetch(Rc::clone(page), server)?)
            }
            Request::Files { name, files } => self.set_input(LoadedInput::open(name, files, question)?),
            Request::Run(ask) => self.run(&ask),
            Request::Record { side, run } => {
                let (loaded, _, (input, options)) = self.prepare_run(&run, None)?;
                let rerun = loaded.rerun_input(&input);
                self.comparison.record(side, input, options, rerun).map(Message::from_json)
            }
            Request::Explain => self.comparison.explain().map(Message::from_json),
            Request::Costs(ask) => self.costs(&ask),
            Request::Received { address, status, tag } => {
                self.receive(&address, PageResponse { status, tag, body: question.rest.clone() })
            }
            Request::Steps(ask) => self.steps(&ask),
            Request::Pixel { x, y } => Ok(Message::from_json(pixel(self.costs.as_ref(), x, y))),
        }
    }

    /// Replaces the current input.
    fn set_input(&mut self, input: LoadedInput) -> Result<Message, String> {
        let about = input.about();
        self.loaded = Some(input);
        self.costs = None;
        Ok(Message::from_json(about))
    }

    fn run(&mut self, ask: &RunRequest) -> Result<Message, String> {
        let page = self.page.clone();
        let record = ask.draft.clone().map(DraftRecord::new);
        let (loaded, machine, (input, options)) = self.prepare_run(ask, record.as_ref())?;
        let board = timeline_layout(&input, &options).map_err(|e| e.to_string())?;
        let names = board.diagram.stages.into_iter().map(|stage| stage.name).collect();
        let path = loaded.path().cloned();
        let rounds = path.clone().zip(page).map(|(path, page)| RoundViewer::new(path, page));
        let mut shown = match &record {
            Some(record) => RenderResult::with_draft(DraftPicture::new(Rc::clone(record))),
            None => RenderResult::with_rounds(rounds),
        };
        let mut strips = UtilizationTimeline::default();
        let ran = run(input, &options, &mut shown, if ask.exact { Some(&mut strips) } else { None });
        let report = ran.map_err(|e| e.to_string())?.report;
        if let Some(record) = record.as_ref().filter(|record| !record.borrow().is_complete()) {
            return Ok(self.draft(shown, &mut record.borrow_mut()));
        }
        let strips = ask.exact.then_some((strips, names));
        let mut answer = shown.answer(&report, &loaded.command(machine, ask), strips)?;
        answer.json["path"] = path.map_or(Value::Null, |path| totals_json(&path));
        Ok(answer)
    }

    /// Returns the answer to a run that lacks tiles, and keeps the textures of these tiles.
    fn draft(&mut self, shown: RenderResult, record: &mut DraftRecord) -> Message {
        let mut answer = shown.draft();
        answer.json["missing"] = json!(record.missing);
        answer.json["needed"] = json!(record.needed);
        if let Some(remote) = self.loaded.as_mut().and_then(LoadedInput::remote) {
            remote.add_pages(std::mem::take(&mut record.pages));
        }
        answer
    }

    /// Caches a response that the page has fetched for a draft.
    fn receive(&mut self, address: &str, response: PageResponse) -> Result<Message, String> {
        let remote = self.loaded.as_mut().and_then(LoadedInput::remote).ok_or("there is no server")?;
        remote.receive(address, response).map(|()| Message::from_json(json!({})))
    }

    /// Repeats the run to list the steps in these cycles.
    fn steps(&mut self, ask: &RunRequest) -> Result<Message, String> {
        let [from, to] = ask.cycles;
        if !(1..=MOST_CYCLES).contains(&to.saturating_sub(from)) {
            return Err(format!("cycles {from} to {to}: expected 1 to {MOST_CYCLES} cycles"));
        }
        let (_, _, (input, options)) = self.prepare_run(ask, None)?;
        let options = RunOptions { exact: false, bottlenecks: AnalysisPolicy::Never, aux_outputs: vec![], ..options };
        let steps = list_steps(input, &options, from..to).map_err(|e| e.to_string())?;
        let each = |step: &TimelineStep| json!([step.stage, step.from, step.to, step.kind, step.text]);
        Ok(Message::from_json(json!({ "steps": steps.iter().map(each).collect::<Vec<_>>() })))
    }

    /// Repeats the run to measure the cost of each pixel.
    fn costs(&mut self, ask: &RunRequest) -> Result<Message, String> {
        let (_, _, (input, options)) = self.prepare_run(ask, None)?;
        let options =
            RunOptions { costs: true, exact: false, bottlenecks: AnalysisPolicy::Never, aux_outputs: vec![], ..options };
        let mut shown = RenderResult::default();
        let ran = run(input, &options, &mut shown, None).map_err(|e| e.to_string())?;
        self.costs = ran.costs;
        shown.exhibits()
    }

    /// Returns the input, the machine and the options of a run, or of a draft with a record.
    fn prepare_run(
        &mut self,
        ask: &RunRequest,
        draft: Option<&Rc<RefCell<DraftRecord>>>,
    ) -> Result<(&LoadedInput, &'static MachineInfo, (RunInput, RunOptions)), String> {
        let loaded = self.loaded.as_mut().ok_or("there is nothing to draw yet: choose a demo, or drop a model")?;
        let (machine, given) = (MachineInfo::named(&ask.machine)?, Overrides { toml: String::new(), settings: ask.set.clone() });
        let config = given.config(machine, &[]).map_err(|e| e.to_string())?;
        config.check().map_err(|e| e.to_string())?;
        let (input, budget) = loaded.input(&ask.view, &config, draft)?;
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

/// Returns the totals received over a connection.
fn totals_json(path: &ServerConnection) -> Value {
    let TransferTotals { requests, scene_bytes, tiles, tile_bytes } = path.totals();
    json!({ "requests": requests, "scene_bytes": scene_bytes, "tiles": tiles, "tile_bytes": tile_bytes })
}

/// Returns the options of a run. `is_here` is true if the texels for a reference image are local. Otherwise intermediate pictures
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
