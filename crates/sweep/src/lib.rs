//! Many runs from one plan.
//!
//! A [`Plan`] says what is run: inputs, a machine, axes of parameters, objectives and constraints. It is checked as a whole before the
//! first run. Its points are known by a hash over all that their reports depend on, and lie in a [`Folder`] under that hash: who finds a
//! report there need not run the point again, whichever plan, process or machine has put it there. [`execute()`] runs what is missing;
//! points that differ in times only are run once and timed again from the tape of that run. [`tables()`] puts all points into one table.
//!
//! | module | what it holds |
//! |---|---|
//! | [`plan`] | the plan, its axes and its points |
//! | [`figures`] | the numbers of a report by their paths, with units |
//! | [`folder`] | where points lie |
//! | [`execute`](mod@execute) | running what is missing, on all cores |
//! | [`explore`](mod@explore) | the front with few of the points |
//! | [`sensitivity`](mod@sensitivity) | a plan around a run, one assumed parameter at a time |
//! | [`verify`](mod@verify) | running points again, to compare |
//! | [`tables`](mod@tables) | the table of all points |
//!
//! Files and progress are the caller's: see [`Host`].

pub mod execute;
pub mod explore;
pub mod figures;
pub mod folder;
mod host;
mod one;
pub mod plan;
pub mod sensitivity;
pub mod tables;
pub mod verify;

pub use execute::{Tally, Work, execute};
pub use explore::{Explored, explore};
pub use folder::{Folder, Found, Store};
pub use host::{Host, Opened};
pub use plan::{Around, Plan, Point};
pub use sensitivity::sensitivity;
pub use tables::tables;
pub use verify::verify;

/// What ends a sweep: a sentence that names file or place, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SweepError(pub String);
