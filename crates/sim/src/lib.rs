//! Simulation of an input on a machine: the run, the reference image, quality metrics, analyses and the report. Without a file system,
//! and without its own clock.

mod analysis;
mod build;
mod command_error;
mod file_cure;
mod machine;
mod named_run;
mod observer;
mod options;
mod outputs;
mod prepared;
mod recording;
mod run;

pub use analysis::ablation::ablate;
pub use analysis::attribution::{AttributionProbe, TokenSample, last_stage};
pub use analysis::comparison::explain;
pub use analysis::costs::{
    ActivityCost, CostKind, CycleBreakdown, PARTS, PixelActivity, PixelCost, PolygonCost, RunCosts, UnitCost,
};
pub use analysis::fifo_sizing::{DepthChoice, FifoSizing, size_fifos};
pub use analysis::methods::compare_methods;
pub use analysis::recorded_run::{ExplainOptions, RecordedRun};
pub use basrelief_machines::{
    AllowedValues, ConfigLoader, CostPoints, MACHINES, MachineConfig, MachineInfo, ParameterChoice, ParameterInfo, TileFetch,
    UnitInfo, ValueSource,
};
pub use build::BUILD;
pub use command_error::{CommandError, CommandResult};
pub use file_cure::{existing_in_plan, is_demo, is_model, reason_and_cure};
pub use machine::aux_outputs;
pub use named_run::{run_named, run_quietly};
pub use observer::{FramePictures, KeptRecording, MemoryRequests, NoObserver, Observer, picture_name};
pub use options::{AnalysisPolicy, Overrides, OverridesError, RunInput, RunOptions, TOML_GROWTH};
pub use outputs::aux_output::{AuxContent, AuxForm, AuxOutput, AuxOutputInfo};
pub use outputs::charts::{ChartOutput, ChartOutputs, ChartRange, ChartRangeError, ProbedRun, RunCharts, WriteSeek};
pub use outputs::cost_maps::COST_PICTURES;
pub use outputs::expectation::{check_expectation, expectation_of};
pub use outputs::page_assets::{page_assets, page_pictures};
pub use outputs::png::to_png;
pub use outputs::recorded_trace::{TraceOptions, record_trace};
pub use outputs::request_log::{LoggedMemory, RequestFormat, RequestLog, RequestLogError, logged_memories};
pub use outputs::steps::list_steps;
pub use prepared::PreparedScene;
pub use recording::{
    Recording, RecordingError, ResimulateOptions, ResimulationResult, looks_like_recording, resimulate, resimulate_to,
};
#[cfg(feature = "unwatched")]
pub use run::bare::{BareMachine, bare_machine};
pub use run::display_list::{display_list, input_sha256, trace_header};
pub use run::memory_estimates::reserve_textures;
pub use run::result::{RunError, RunResult};
pub use run::untimed::ideal_parts;
pub use run::{run, timeline_layout};

/// A trace of one grey quad, for the example above.
#[doc(hidden)]
pub fn doc_trace() -> Vec<u8> {
    include_bytes!("quad.dl.jsonl").to_vec()
}

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
