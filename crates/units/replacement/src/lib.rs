//! Normal-vector replacement unit (110): replaces each pseudo-normal N' by the nearest reference normal of its level's VQ table
//! (121) and sends only the index.
//!
//! ```text
//! Flow<PseudoNormals> -> [ table resident? | gather, cluster | search ] -> Flow<NormalIndexes>
//!                             |                  |
//!              client 0: VQ tables (121)   client 1: gathered N'      both in memory (120)
//! ```
//!
//! Erratum of the patent: it takes the *smallest* normalized inner product, which selects the opposite vector. The nearest has
//! the *largest*, and ties go to the lowest index.

mod clustering;
mod code_book;
mod code_books;
mod config;
mod gather;
mod policy;
mod search;
mod state;
mod tables;
mod unit;

pub use code_book::{CodeBook, build_code_book};
pub use config::{CodeBookMode, PerLevel, ReplacementConfig, TablePolicy, TableSource};
pub use gather::GatheredBatch;
pub use search::NearestSearch;
pub use state::{ReplacementCounters, ReplacementState};
pub use unit::Replacement;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
