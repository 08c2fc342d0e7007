//! What people read and open: the report of a run, its tables, its page, and the explained difference of two.
//!
//! | module | what it makes |
//! |---|---|
//! | [`model`], [`build`](mod@build) | [`Report`]: `report.json`, under a published [`schema`] |
//! | [`derived`] | figures with unit and formula: cycles per fragment, GB/s, hit rates |
//! | [`blame`] | what limits a run, in one sentence that follows from the accounting |
//! | [`text`] | the tables of the terminal |
//! | [`compare`](mod@compare) | what changed between two runs, and what explains it |
//! | [`costs`] | what objects and polygons cost |
//! | [`sensitivity`] | which of our assumptions a run hangs on |
//! | [`ablation`] | what each short cut of a machine saves, and what it costs |
//! | [`methods`] | what each method of choosing division points costs at the same error |
//! | [`work`] | what a machine draws, in its own words |
//! | [`html`](mod@html) | the report as one page |
//! | [`csv`] | the same figures, one per line |
//!
//! Nothing here opens a file, reads a clock or prints: writers are arguments, host figures are arguments, tables are
//! strings. A report without its `host` part is the same to the bit whatever the engine, machine or thread count.

pub mod ablation;
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
pub use build::Context;
pub use compare::{Comparison, Explained, Share, compare};
pub use csv::to_csv;
pub use html::to_html;
pub use json::{ReadError, SCHEMA, schema};
pub use methods::Methods;
pub use model::{Report, Sensitivity, costs, sensitivity};
pub use text::{Style, Tables, hardware, to_text};
