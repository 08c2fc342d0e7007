//! The report of a run: its data, its tables, its HTML page, and the comparison of two reports.
//!
//! | module | contents |
//! |---|---|
//! | [`model`], [`build`](mod@build) | [`Report`]: `report.json`, under a published [`schema`] |
//! | [`derived`] | figures with unit and formula: cycles per fragment, GB/s, hit rates |
//! | [`bottleneck`] | the bottleneck of a run, from the cycle accounting |
//! | `area` | area by place, and operators that are slower than the clock |
//! | [`text`] | the tables of the terminal |
//! | [`compare`](mod@compare) | difference of two runs and its causes |
//! | [`costs`] | cycles per object and polygon |
//! | [`sensitivity`] | effect of each assumed parameter |
//! | [`ablation`] | cycles with each optimization switched off |
//! | [`methods`] | cost of each method of choosing division points at the same error |
//! | [`work`] | work, routes, circuits and processes of a machine |
//! | [`html`](mod@html) | the report as one page |
//! | [`csv`] | the same figures, one per line |
//!
//! This crate opens no file, reads no clock and prints nothing: writers and host figures are arguments, tables are strings. A report
//! without its `host` part is equal to the bit for every engine, host and number of threads.

pub mod ablation;
#[cfg(test)]
mod agreement;
mod area;
pub mod bottleneck;
pub mod build;
pub mod compare;
pub mod csv;
pub mod derived;
pub mod html;
mod json;
mod long_table;
pub mod methods;
pub mod model;
pub mod number;
#[cfg(test)]
mod samples;
pub mod text;
pub mod work;

pub use ablation::Ablation;
pub use area::{NO_AREA, depth_warnings};
pub use build::ReportContext;
pub use compare::{CauseShare, Comparison, MeasuredCauses, compare};
pub use csv::{no_formula, to_csv};
pub use html::to_html;
pub use json::{ReadError, SCHEMA, schema};
pub use methods::MethodComparison;
pub use model::{Report, Sensitivity, costs, sensitivity};
pub use text::{TableGroup, TextStyle, hardware, to_text};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
