//! Scenes from files: inputs, reports of faults, libraries, and the memory that an import may take.

mod budget;
mod inputs;
mod libraries;
mod reports;
