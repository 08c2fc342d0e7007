//! Many runs side by side: the mathematics and the pictures of a sweep.
//!
//! | module | what it holds |
//! |---|---|
//! | [`table`] | [`Table`]: a row per point, columns with units |
//! | [`rules`] | objectives and constraints: what is to be reached, what must be kept |
//! | [`explore`] | which points to run next, to find the front with few |
//! | [`front`](mod@front) | what no other point beats |
//! | [`hypervolume`] | how good a front is, in one number |
//! | [`effects`](mod@effects) | how far each objective moves over the values of an axis |
//! | [`sample`] | Latin hypercubes and Sobol sequences on a grid |
//! | [`page`](mod@page) | the sweep as one page |
//! | [`vega`](mod@vega) | the sweep as a Vega-Lite specification |
//! | [`write`](mod@write) | the table as CSV and as JSON lines |
//! | `parquet`, `sqlite` | the table as such files, with these features |
//!
//! Nothing here opens a file, reads a clock or prints. Equal tables give equal bytes, on every machine.

mod chance;
pub mod effects;
pub mod explore;
pub mod front;
pub mod hypervolume;
mod levels;
pub mod page;
#[cfg(feature = "parquet")]
mod parquet;
pub mod rules;
pub mod sample;
#[cfg(test)]
mod samples;
#[cfg(feature = "sqlite")]
mod sqlite;
pub mod table;
#[cfg(any(feature = "parquet", feature = "sqlite"))]
mod typed;
pub mod vega;
pub mod write;

pub use effects::{Effect, effects};
pub use front::{candidates, front};
pub use hypervolume::Space;
pub use page::{PageOptions, page};
#[cfg(feature = "parquet")]
pub use parquet::parquet;
pub use rules::{Comparison, Constraint, Goal, Objective};
#[cfg(feature = "sqlite")]
pub use sqlite::sqlite;
pub use table::{Cell, Column, Role, Row, State, Table};
pub use vega::vega;
