//! Options of every command.

use crate::address_space;
use crate::args::Cli;
use crate::inputs_read;
use basrelief_input::MemoryPool;
use basrelief_scene::ImportOptions;

/// Options of every command, as the commands use them.
#[derive(Clone, Debug)]
pub struct GlobalOptions {
    /// True if only errors are printed.
    pub quiet: bool,
    /// Memory limit for input data and the structures built from it.
    pub budget: MemoryPool,
    /// True if models may name files outside their folders.
    pub allow_outside: bool,
}

impl GlobalOptions {
    /// Resolves the options of the command line. Called before any thread starts, because threads reserve address space: the
    /// memory limit must be the same in every run.
    pub fn new(cli: &Cli) -> Self {
        let budget = address_space::budget(cli.memory_limit);
        Self { quiet: cli.quiet, budget, allow_outside: cli.allow_outside }
    }

    /// Returns the options for opening a model.
    pub fn import_options(&self) -> ImportOptions {
        ImportOptions { budget: self.budget.clone(), allow_outside: self.allow_outside, on_read: Some(inputs_read::add) }
    }
}
