//! One file per command, and the code that several commands share.

mod compare;
mod convert;
mod describe;
pub mod dump;
mod explore;
mod from;
mod html;
mod output_files;
mod page;
mod plans;
mod real_times;
mod record;
mod recording;
mod requests;
mod run;
mod schema;
mod sensitivity;
mod serve;
mod simulate;
mod size_fifos;
mod sweep;
pub mod tables;
mod timelines;
mod verify;

use crate::args::{Cli, Command};
use crate::error::Done;
use basrelief_input::Budget;

/// Runs the command.
pub fn dispatch(cli: Cli, budget: &Budget) -> Done {
    match cli.command {
        Command::Demo(args) => run::demo(&args, budget, cli.quiet),
        Command::Run(args) => run::run(&args, budget, cli.quiet),
        Command::SizeFifos(args) => size_fifos::size_fifos(&args, budget),
        Command::Sweep(args) => sweep::sweep(&args, budget, cli.quiet),
        Command::Explore(args) => explore::explore(&args, budget, cli.quiet),
        Command::Resimulate(args) => recording::resimulate(&args, budget, cli.quiet),
        Command::Record(args) => record::record(&args, budget, cli.quiet),
        Command::Convert(args) => convert::convert(&args, budget),
        Command::Verify(args) => verify::verify(&args, budget, cli.quiet),
        Command::Describe(args) => describe::describe(&args, budget),
        Command::Compare(args) => compare::compare(&args, budget),
        Command::Schema(args) => schema::schema(&args),
        Command::Page(args) => page::page(&args, cli.quiet),
        Command::Serve(args) => serve::serve(&args, budget, cli.quiet),
    }
}
