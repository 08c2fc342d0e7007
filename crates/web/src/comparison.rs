//! Comparison of two runs: their recordings, and the causes of the difference in cycles.

use crate::request::ComparedSide;
use basrelief_input::MemoryPool;
use basrelief_report::{Report, compare};
use basrelief_sim::{
    AnalysisPolicy, ExplainOptions, KeptRecording, PreparedScene, RecordedRun, RunInput, RunOptions, explain, run,
};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Cursor, Read};
use std::sync::Arc;

/// A display list and its neighbouring files, by name.
pub(crate) type TraceFiles = BTreeMap<String, Arc<[u8]>>;

/// Returns a display list as the input of a run.
///
/// # Errors
/// The files lack the display list.
pub(crate) fn trace_input(name: &str, files: &TraceFiles) -> Result<RunInput, String> {
    let reader = Box::new(Cursor::new(Arc::clone(files.get(name).ok_or("the display list is gone")?)));
    let files = files.clone();
    let beside = move |name: &str| match files.get(name) {
        Some(bytes) => Ok(Box::new(Cursor::new(Arc::clone(bytes))) as Box<dyn Read>),
        None => Err(io::Error::from(io::ErrorKind::NotFound)),
    };
    Ok(RunInput::Trace { reader, files: Box::new(beside), name: name.into() })
}

/// Input that more runs can use. `None` if its texels are on a server.
pub(crate) enum RerunInput {
    Scene(PreparedScene),
    Trace(String, TraceFiles),
}

impl RerunInput {
    fn open(&self) -> Option<RunInput> {
        match self {
            Self::Scene(scene) => Some(RunInput::Scene(scene.clone())),
            Self::Trace(name, files) => trace_input(name, files).ok(),
        }
    }
}

/// One side of a comparison.
struct RecordedSide {
    report: Report,
    run: RecordedRun,
    input: Option<RerunInput>,
    budget: MemoryPool,
}

/// The sides of a comparison that are recorded so far.
#[derive(Default)]
pub(crate) struct RunComparison {
    sides: [Option<RecordedSide>; 2],
}

impl RunComparison {
    /// Runs an input and keeps its recording as one side.
    ///
    /// # Errors
    /// The run fails or does not finish.
    pub(crate) fn record(
        &mut self,
        side: ComparedSide,
        input: RunInput,
        options: RunOptions,
        rerun: Option<RerunInput>,
    ) -> Result<Value, String> {
        let place = &mut self.sides[side as usize];
        *place = None;
        let budget = options.budget.clone();
        let options = RunOptions {
            exact: false,
            bottlenecks: AnalysisPolicy::Never,
            aux_outputs: vec![],
            recording: AnalysisPolicy::Always,
            ..options
        };
        let mut kept = KeptRecording::new(&budget);
        let report = run(input, &options, &mut kept, None).map_err(|error| error.to_string())?.report;
        let run = RecordedRun::read(&report, &mut Cursor::new(kept.bytes()), &budget).map_err(|error| error.to_string())?;
        *place = Some(RecordedSide { report, run, input: rerun, budget });
        Ok(json!({}))
    }

    /// Returns the causes of the difference, as `basrelief compare` words and measures them.
    ///
    /// # Errors
    /// A side is not recorded.
    pub(crate) fn explain(&self) -> Result<Value, String> {
        let [Some(a), Some(b)] = &self.sides else { return Err("a comparison needs two recorded runs".into()) };
        let open = || a.input.as_ref()?.open();
        let input = a.input.is_some().then_some(&open as &(dyn Fn() -> _ + Sync));
        let causes = explain(&a.run, &b.run, &ExplainOptions { input, progress: &|_, _| {}, budget: &a.budget });
        let text = compare(&a.report, &b.report, causes.clone()).explanation;
        let rows: Vec<Value> = causes
            .iter()
            .flat_map(|causes| {
                let each = causes.shares.iter().map(|share| json!({ "cause": share.parameter, "by": share.by }));
                each.chain([json!({ "cause": "interaction", "by": causes.together })]).collect::<Vec<_>>()
            })
            .collect();
        Ok(json!({ "text": text, "causes": rows }))
    }
}
