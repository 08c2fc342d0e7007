//! Definition of the command line. The comments are the texts of `--help`: each option states its unit of measure and its default.

mod common;
mod describe;
mod lists;
mod manual;
mod opengl;
mod run;
mod sweep;
mod usage_error;
mod values;

pub use common::{EngineName, MachineArgs, RequestsFormat, SimulationArgs, TablesArgs, TokenKind, ViewArgs};
pub use describe::{CompareArgs, DescribeArgs, Explain, SchemaArgs, SchemaName};
pub use lists::{ConvertArgs, RecordArgs, VerifyArgs};
pub use manual::{ColorMode, CompletionsArgs, ManArgs};
pub use opengl::{CaptureArgs, GlSceneArgs, ImportGlArgs};
pub use run::{DemoArgs, PageArgs, ResimulateArgs, RunArgs, ServeArgs, SizeFifosArgs};
pub use sweep::{ExploreArgs, PlanArgs, SweepArgs};
pub use usage_error::with_cure;

use basrelief_input::{ByteSize, MemoryPool};
use clap::{CommandFactory, Parser, Subcommand};

/// Cycle-level simulator of four patented shading devices: cycles, bottlenecks, memory traffic and image quality.
#[derive(Debug, Parser)]
#[command(name = "basrelief", version, max_term_width = 110, arg_required_else_help = true)]
pub struct Cli {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
    /// Print errors only, and output that the command is asked for.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Memory limit for input data and the structures built from it [bytes; suffixes KiB, MiB, GiB]. A run that needs more ends
    /// with an error.
    #[arg(long, global = true, value_name = "BYTES", default_value_t = ByteSize(MemoryPool::DEFAULT))]
    pub memory_limit: ByteSize,
    /// Use colours. `auto` uses them on a terminal, unless the environment sets NO_COLOR.
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t)]
    pub color: ColorMode,
    /// Let models name files outside their folders, with `../`. Without it such a name is an error.
    #[arg(long, global = true)]
    pub allow_outside: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw an embedded demo scene; write its images and report.
    Demo(DemoArgs),
    /// Draw a model (glTF 2.0, GLB, OBJ) or replay a trace (display list); write its images and report.
    Run(RunArgs),
    /// Compute the timing of a recording anew, with other FIFOs, memories and caches, without executing the units again.
    Resimulate(ResimulateArgs),
    /// Find the smallest FIFO depths that keep the cycles of one or several runs.
    SizeFifos(SizeFifosArgs),
    /// Run the points of a plan that have no result yet; write their tables and Pareto front (design-space sweep).
    Sweep(SweepArgs),
    /// Find the Pareto front of a plan with few runs (design-space exploration).
    Explore(ExploreArgs),
    /// Write the output of the geometry processor as a trace (display list).
    Record(RecordArgs),
    /// Turn a frame of an OpenGL application, as state dumps of apitrace, into a scene; compare its image with the application's.
    ImportGl(ImportGlArgs),
    /// Run an OpenGL application under apitrace, and turn one of its frames into a scene as `import-gl` does. The trace and the dumps
    /// stay in the folder NAME.capture beside the scene.
    Capture(CaptureArgs),
    /// Convert a trace between its forms (JSON Lines or binary, plain or zstd), without loss.
    Convert(ConvertArgs),
    /// Replay traces and check the expectations that they carry.
    Verify(VerifyArgs),
    /// Show a machine: block diagram, units, parameters with unit, default and provenance.
    Describe(DescribeArgs),
    /// Compare reports: changes, largest first, and their causes.
    Compare(CompareArgs),
    /// Print a JSON schema.
    Schema(SchemaArgs),
    /// Print the completions of commands and options for a shell.
    Completions(CompletionsArgs),
    /// Print the manual page of the program or of one command, for `man -l -`.
    Man(ManArgs),
    /// Open the simulator as a page in a browser.
    Page(PageArgs),
    /// Serve a scene over HTTP for `run --from`: meshes, texture sizes and single texture tiles.
    Serve(ServeArgs),
}

/// Returns the definition of the command line. A negative number after an option is its value, so that the message about it names the
/// option.
pub fn command() -> clap::Command {
    taking_negative_numbers(Cli::command())
}

fn taking_negative_numbers(command: clap::Command) -> clap::Command {
    let option = |arg: clap::Arg| {
        let is_option = !arg.is_positional() && arg.get_action().takes_values();
        if is_option { arg.allow_negative_numbers(true) } else { arg }
    };
    command.mut_args(option).mut_subcommands(taking_negative_numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_line_is_consistent() {
        command().debug_assert();
    }

    #[test]
    fn dash_is_no_output_file() {
        for option in ["--html", "--timeline", "--waves", "--tokens", "--rtl", "--recording"] {
            let parse = |path| command().try_get_matches_from(["basrelief", "demo", option, path]);
            let error = parse("-").unwrap_err();
            assert!(error.to_string().contains("expected a file (`./-` for a file called `-`)"), "{error}");
            assert!(parse("./-").is_ok(), "{option}");
        }
        for command in [["resimulate", "out", "--html", "-"].as_slice(), &["compare", "a", "b", "--html", "-"]] {
            assert!(super::command().try_get_matches_from([&["basrelief"], command].concat()).is_err(), "{command:?}");
        }
    }

    #[test]
    fn wave_file_of_another_format_is_refused() {
        let parse = |path| command().try_get_matches_from(["basrelief", "demo", "--waves", path]);
        let error = parse("run.vcd").unwrap_err().to_string();
        assert!(error.contains("expected a name that ends in .fst, the format that is written"), "{error}");
        for path in ["run.fst", "RUN.FST", "run", "/dev/null"] {
            assert!(parse(path).is_ok(), "{path}");
        }
    }

    #[test]
    fn file_of_another_format_is_refused() {
        let parse = |option: &str, path: &str| command().try_get_matches_from(["basrelief", "demo", option, path]);
        for (option, ending, wrong) in
            [("--tokens", "kanata", "run.txt"), ("--tokens", "kanata", "run.kanata.ZST"), ("--rtl", "wires", "run.wires.gz")]
        {
            let error = parse(option, wrong).unwrap_err().to_string();
            assert!(error.contains(&format!("expected a name that ends in .{ending} or .{ending}.zst")), "{error}");
            for path in [format!("run.{ending}"), format!("run.{ending}.zst"), "run".into(), "run.zst".into(), "/dev/null".into()]
            {
                assert!(parse(option, &path).is_ok(), "{option} {path}");
            }
        }
    }

    #[test]
    fn flows_of_timelines_can_be_chosen_alone() {
        let parse = |line: &str| command().try_get_matches_from(["basrelief", "demo"].into_iter().chain(line.split(' ')));
        assert!(parse("--timeline a.pftrace --tokens-every 8 --tokens-of polygons").is_ok());
        assert!(parse("--timeline a.pftrace --waves a.fst --tokens a.kanata --tokens-every 8").is_ok());
        assert!(parse("--waves a.fst --tokens-every 8").is_err());
    }

    #[test]
    fn host_name_has_no_scheme_and_no_port() {
        let parse = |name| command().try_get_matches_from(["basrelief", "serve", "demo:coin", "--allow-host", name]);
        for name in ["simulator.example", "localhost", "10.0.0.7", "[::1]"] {
            assert!(parse(name).is_ok(), "{name}");
        }
        for name in ["", "http://a/", "a:80", "user@a", "a b"] {
            let error = parse(name).unwrap_err().to_string();
            assert!(error.contains("expected the name of a host") || error.contains("a value is required"), "{name}: {error}");
        }
    }

    #[test]
    fn negative_number_belongs_to_the_option_before_it() {
        for line in ["demo --frames -1", "demo --max-cycles -5", "demo --memory-limit -1"] {
            let words = ["basrelief"].into_iter().chain(line.split(' '));
            let error = command().try_get_matches_from(words).unwrap_err().to_string();
            assert!(error.contains("invalid value '-"), "{line}: {error}");
        }
    }
}
