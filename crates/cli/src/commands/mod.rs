//! One file per command, and what several share.

mod compare;
mod convert;
mod describe;
pub mod dump;
mod from;
mod output_files;
mod record;
mod requests;
mod run;
mod schema;
mod serve;
mod simulate;
mod tables;
mod verify;

use crate::args::{Cli, Command};
use crate::error::Done;

/// Runs the command.
pub fn dispatch(cli: Cli) -> Done {
    match cli.command {
        Command::Demo(args) => run::demo(&args, cli.quiet),
        Command::Run(args) => run::run(&args, cli.quiet),
        Command::Record(args) => record::record(&args, cli.quiet),
        Command::Convert(args) => convert::convert(&args),
        Command::Verify(args) => verify::verify(&args, cli.quiet),
        Command::Describe(args) => describe::describe(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Schema(args) => schema::schema(&args),
        Command::Serve(args) => serve::serve(&args, cli.quiet),
    }
}
