//! From input to report in one call: the machine, the exact picture, the metrics and the report put together, without a
//! file system and without a clock of its own.
//!
//! A program that loads a trace, runs the machine and reads its report:
//!
//! ```
//! use basrelief_sim::{RunOptions, RunInput, Unobserved, run};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let bytes = basrelief_sim::doc_trace();
//! let source = RunInput::trace(std::io::Cursor::new(bytes), "quad.dl.jsonl");
//! let run = run(source, &RunOptions::default(), &mut Unobserved, None)?;
//! let report = run.report;
//! let cycles = report.cycles.as_ref().map_or(0, |c| c.total);
//! println!("{cycles} cycles, picture {}", report.image[0].sha256);
//! # assert!(cycles > 0);
//! # Ok(())
//! # }
//! ```

mod ablation;
mod apart;
mod beside;
mod configured;
mod costs;
mod described;
mod difference;
mod drive;
mod ended;
mod exact;
mod exhibits;
mod expectation;
mod explained;
mod flow;
mod following;
mod held;
mod ideals;
mod judged;
mod limits;
mod machines;
mod methods;
mod neighbours;
mod observer;
mod outcome;
mod png;
mod prepared;
mod record;
mod rehearsal;
mod run;
mod settings;
mod sizing;
mod tape;
mod tee;

pub use ablation::ablate;
pub use apart::run_apart;
pub use beside::{beside, page_pictures};
pub use configured::{Misconfigured, TOML_GROWTH};
pub use costs::{CostKind, CostPoints, Costs, PARTS, PixelCost, PixelWay, PolygonCost, Spent, UnitCost, WayCost};
pub use described::{Choice as ParameterChoice, Described, From as ValueFrom, Takes};
pub use exhibits::content::{Content, Exhibit, ExhibitInfo, Form};
pub use exhibits::costs::COST_PICTURES;
pub use expectation::{check_expectation, expectation_of};
pub use explained::{Taped, explain};
pub use following::{Following, Sample, last_stage};
pub use held::textures as hold_textures;
pub use machines::{ConfigLoader, MACHINES, MachineConfig, MachineInfo, TileFetch};
pub use methods::compare_methods;
pub use observer::{MemoryRequests, Observer, Pictures, Unobserved, picture_name};
pub use outcome::{Run, SessionError};
pub use png::to_png;
pub use prepared::Prepared;
pub use record::{begin_of, display_list, input_sha256};
pub use run::{board, run};
pub use settings::{RunInput, RunOptions, When};
pub use sizing::{Choice, Sizes, size_fifos};
pub use tape::{Given, Recording, RetimeOptions, TapeFileError, retime, retime_to};

/// A trace of one grey quad, for the example above.
#[doc(hidden)]
pub fn doc_trace() -> Vec<u8> {
    include_bytes!("quad.dl.jsonl").to_vec()
}
