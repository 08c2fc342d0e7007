//! Many runs side by side: the mathematics and the pictures of a sweep.
//!
//! | module | what it holds |
//! |---|---|
//! | [`table`] | [`Table`]: a row per point, columns with units; axes, objectives, constraints |
//! | [`write`](mod@write) | the table as CSV and as JSON lines |
//!
//! Nothing here opens a file, reads a clock or prints. Equal tables give equal bytes, on every machine.

pub mod table;
pub mod write;

pub use table::{Cell, Column, Comparison, Constraint, Goal, Objective, Role, Row, State, Table};
