//! `basrelief completions` and `basrelief man`, both from the definition of the command line.

use crate::args::{self, CompletionsArgs, ManArgs};
use crate::error::{CommandError, CommandResult, print};
use clap::Command;

/// Prints the completions for a shell.
pub fn completions(args: &CompletionsArgs) -> CommandResult {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut args::command(), "basrelief", &mut script);
    print_bytes(&script)
}

/// Prints a manual page.
pub fn man(args: &ManArgs) -> CommandResult {
    let mut page = Vec::new();
    let command = documented(args.command.as_deref())?;
    let title = command.get_display_name().unwrap_or("basrelief").to_owned();
    clap_mangen::Man::new(command).title(title).render(&mut page).map_err(CommandError::bad_input)?;
    print_bytes(&page)
}

/// Returns the program, or its subcommand under the name that manual pages have: `basrelief-run`.
fn documented(name: Option<&str>) -> CommandResult<Command> {
    let mut program = args::command();
    program.build();
    let Some(name) = name else { return Ok(program) };
    let commands = program.get_subcommands().map(Command::get_name).collect::<Vec<_>>().join(", ");
    let found = program.find_subcommand(name).cloned();
    let command = found.ok_or_else(|| CommandError::Usage(format!("man: `{name}` is no command; expected one of {commands}")))?;
    Ok(command.display_name(format!("basrelief-{name}")))
}

fn print_bytes(text: &[u8]) -> CommandResult {
    print(&String::from_utf8_lossy(text))
}
