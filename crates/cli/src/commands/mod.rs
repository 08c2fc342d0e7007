//! One file per command, and the code that several commands share.

mod capture;
mod causes;
mod cluster;
mod compare;
mod convert;
mod describe;
pub mod dump;
mod explore;
mod from;
mod html;
mod import_gl;
mod manual;
mod output_files;
mod page;
mod page_files;
mod plans;
mod real_times;
mod record;
mod recording;
mod reporting;
mod requests;
mod resimulate;
mod rtl_area;
mod run;
mod schema;
mod sensitivity;
mod serve;
mod simulate;
mod size_fifos;
mod sweep;
mod tables;
mod timelines;
mod verify;
mod wires;

use crate::args::Command;
use crate::error::CommandResult;
use crate::global::GlobalOptions;

/// Runs the command.
pub fn dispatch(command: Command, global: &GlobalOptions) -> CommandResult {
    match command {
        Command::Demo(args) => run::demo(&args, global),
        Command::Run(args) => run::run(&args, global),
        Command::SizeFifos(args) => size_fifos::size_fifos(&args, global),
        Command::Sweep(args) => sweep::sweep(&args, global),
        Command::Explore(args) => explore::explore(&args, global),
        Command::Resimulate(args) => resimulate::resimulate(&args, global),
        Command::Record(args) => record::record(&args, global),
        Command::Capture(args) => capture::capture(&args, global),
        Command::ImportGl(args) => import_gl::import_gl(&args, global),
        Command::Convert(args) => convert::convert(&args, &global.budget),
        Command::Verify(args) => verify::verify(&args, global),
        Command::Describe(args) => describe::describe(&args, global),
        Command::Compare(args) => compare::compare(&args, global),
        Command::Schema(args) => schema::schema(&args),
        Command::Completions(args) => manual::completions(&args),
        Command::Man(args) => manual::man(&args),
        Command::Page(args) => page::page(&args, global.quiet),
        Command::Serve(args) => serve::serve(&args, global),
    }
}
