//! Options of every command.

use crate::address_space;
use crate::args::{Cli, ColorMode};
use crate::inputs_read;
use basrelief_input::MemoryPool;
use basrelief_report::TextStyle;
use basrelief_scene::ImportOptions;
use std::io::{self, IsTerminal};

/// Options of every command, as the commands use them.
#[derive(Clone, Debug)]
pub struct GlobalOptions {
    /// True if only errors are printed.
    pub quiet: bool,
    /// Memory limit as given \[bytes\]; the budget may be lower where the system grants less.
    pub memory_limit: u64,
    /// Memory limit for input data and the structures built from it.
    pub budget: MemoryPool,
    /// When texts have colours.
    pub color: ColorMode,
    /// True if models may name files outside their folders.
    pub allow_outside: bool,
}

impl GlobalOptions {
    /// Resolves the options of the command line. Called before any thread starts, because threads reserve address space: the
    /// memory limit must be the same in every run.
    pub fn new(cli: &Cli) -> Self {
        let budget = address_space::budget(cli.memory_limit);
        Self { quiet: cli.quiet, memory_limit: cli.memory_limit.0, budget, color: cli.color, allow_outside: cli.allow_outside }
    }

    /// Returns width and colours of texts on standard output.
    pub fn text_style(&self) -> TextStyle {
        let width = std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok()).unwrap_or(120);
        // no-color.org: set and not empty.
        let no_color = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        TextStyle { width, color: self.color.applies(io::stdout().is_terminal(), no_color) }
    }

    /// Returns the options for opening a model.
    pub fn import_options(&self) -> ImportOptions {
        ImportOptions { budget: self.budget.clone(), allow_outside: self.allow_outside, on_read: Some(inputs_read::add) }
    }
}
