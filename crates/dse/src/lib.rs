//! Design-space exploration: many runs from one plan, and the mathematics and pictures of their results.
//!
//! A [`Plan`] lists inputs, a machine, axes of parameters, objectives and constraints. It is checked as a whole before the first run.
//! A hash over everything that the report of a point depends on identifies the point. A [`SweepFolder`] stores each point under its hash, so
//! any plan, process or machine reuses the points of any other. [`execute()`] runs the missing points. Points that differ only in timing
//! parameters share one run, whose recording is resimulated. [`tables()`] puts all points into one table.
//!
//! | module | contents |
//! |---|---|
//! | [`plan`] | the plan, its axes and its points |
//! | [`figures`] | the numbers of a report by their paths, with units |
//! | [`folder`] | storage of points |
//! | [`execute`](mod@execute) | running missing points on all cores |
//! | [`explore`](mod@explore) | finding the Pareto front with few of the points |
//! | [`sensitivity`](mod@sensitivity) | a plan around a run, one assumed parameter at a time |
//! | [`verify`](mod@verify) | running points again, to compare |
//! | [`tables`](mod@tables) | the files of a sweep: its table, page and charts |
//! | [`table`] | [`Table`]: a row per point, columns with units |
//! | [`rules`] | objectives and constraints |
//! | [`pareto_search`] | choice of the points to run next |
//! | [`front`](mod@front) | Pareto-optimal points |
//! | [`hypervolume`] | quality of a front, in one number |
//! | [`effects`](mod@effects) | range of each objective over the values of an axis |
//! | [`sample`] | Latin hypercubes and Sobol sequences on a grid |
//! | [`page`](mod@page) | the sweep as one HTML page |
//! | [`vega`](mod@vega) | the sweep as a Vega-Lite specification |
//! | [`mod@write`] | the table as CSV and as JSON lines |
//! | `parquet`, `sqlite` | the table as such files, with these features |
//!
//! The caller provides files and progress: see [`SweepHost`]. Equal tables give equal bytes on every machine.

pub mod effects;
pub mod execute;
pub mod explore;
pub mod figures;
pub mod folder;
pub mod front;
mod host;
pub mod hypervolume;
mod levels;
mod one;
pub mod page;
pub mod pareto_search;
#[cfg(feature = "parquet")]
mod parquet;
pub mod plan;
pub mod rules;
pub mod sample;
#[cfg(test)]
mod samples;
pub mod sensitivity;
mod split_mix_64;
#[cfg(feature = "sqlite")]
mod sqlite;
pub mod table;
pub mod tables;
#[cfg(any(feature = "parquet", feature = "sqlite"))]
mod typed;
pub mod vega;
pub mod verify;
pub mod write;

pub use effects::{Effect, effects};
pub use execute::{SweepJob, execute};
pub use explore::{Budget, ExplorationResult, ExploreOptions, explore};
pub use folder::{PointStatus, PointStore, SweepFolder};
pub use front::{FrontPoint, candidates, front, front_points};
pub use host::{OpenError, OpenedInput, SweepHost, SweepProgress};
pub use hypervolume::ObjectiveSpace;
pub use page::{PageOptions, page};
#[cfg(feature = "parquet")]
pub use parquet::parquet;
pub use plan::{OneAtATimeBase, Plan, PlanPoint, plan_schema};
pub use rules::{Constraint, ConstraintRelation, Objective, ObjectiveDirection};
pub use sensitivity::sensitivity;
pub use split_mix_64::SplitMix64;
#[cfg(feature = "sqlite")]
pub use sqlite::sqlite;
pub use table::{Cell, Column, ColumnRole, PointState, Row, Table};
pub use tables::tables;
pub use vega::vega;
pub use verify::verify;

/// Error that ends a sweep: a sentence that names the file or place and the cure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SweepError(pub String);

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
