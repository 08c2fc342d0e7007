//! The extension module of the Python package `basrelief`. The Python code of the package is in [`package`](../package/basrelief).
//!
//! The interface consists of strings, bytes and numbers; reports pass as JSON. Only a `Scene`, a `DisplayList`, a `Config` and a `Plan`
//! are objects of this module. Long operations release Python's global lock and take it only to check for Ctrl-C.

use pyo3::pymodule;

mod analysis;
mod catalogue;
mod compare;
mod config;
mod error;
mod host;
mod outputs;
mod page;
mod pixels;
mod recording;
mod run;
mod scene;
mod sensitivity;
mod sweep;
mod watch;

#[pymodule]
mod _basrelief {
    #[pymodule_export]
    use crate::analysis::{ablate, compare_methods, figure, record, size_fifos};
    #[pymodule_export]
    use crate::catalogue::{demos, machines};
    #[pymodule_export]
    use crate::compare::{compare, compared};
    #[pymodule_export]
    use crate::config::Config;
    #[pymodule_export]
    use crate::error::{Error, InputError, UsageError};
    #[pymodule_export]
    use crate::outputs::write;
    #[pymodule_export]
    use crate::page::{page, part, read_report, text};
    #[pymodule_export]
    use crate::pixels::{difference, png, read_png};
    #[pymodule_export]
    use crate::recording::resimulate;
    #[pymodule_export]
    use crate::run::run;
    #[pymodule_export]
    use crate::scene::{DisplayList, Scene, read_text};
    #[pymodule_export]
    use crate::sweep::{Plan, explore, work_alone};

    /// Version of the simulator.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
