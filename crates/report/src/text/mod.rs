//! Text for people.

pub mod number;
