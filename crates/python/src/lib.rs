//! The simulator for Python: the native half of the package `basrelief`, whose other half is in [`package`](../package/basrelief).
//!
//! What crosses between the two is plain: texts, bytes and numbers, of reports the JSON. Only a `Scene`, a
//! `DisplayList` and a `Config` are held on this side. Whatever takes long is done without
//! Python's interpreter lock, which is taken only to ask whether somebody has pressed Ctrl-C.

use pyo3::pymodule;

mod catalogue;
mod compare;
mod config;
mod error;
mod page;
mod pixels;
mod run;
mod scene;
mod sweep;
mod tape;
mod watch;

#[pymodule]
mod _basrelief {
    #[pymodule_export]
    use crate::catalogue::{demos, machines};
    #[pymodule_export]
    use crate::compare::{compare, compared};
    #[pymodule_export]
    use crate::config::Config;
    #[pymodule_export]
    use crate::error::{Error, InputError, UsageError};
    #[pymodule_export]
    use crate::page::{page, part, read_report, text};
    #[pymodule_export]
    use crate::pixels::{difference, png};
    #[pymodule_export]
    use crate::run::run;
    #[pymodule_export]
    use crate::scene::{DisplayList, Scene, read_text};
    #[pymodule_export]
    use crate::sweep::{Plan, work_alone};
    #[pymodule_export]
    use crate::tape::retime;

    /// Version of the simulator.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
