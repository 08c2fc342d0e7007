//! `basrelief record`: writes the output of the geometry processor as a trace.

use super::convert::to_trace_file;
use super::simulate::read_files;
use crate::args::RecordArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::input::{self, Input};
use crate::outputs::check_outputs_keep_inputs;
use crate::progress::Progress;
use crate::scene_input::demo_of;
use basrelief_report::number::thousands;
use basrelief_sim::{TraceOptions, record_trace};
use std::path::Path;

/// Records a scene.
pub fn record(args: &RecordArgs, global: &GlobalOptions) -> CommandResult {
    let inputs = read_files(Some(&args.input), &args.machine, &args.view);
    check_outputs_keep_inputs(None, &[("--out", &args.out)], &inputs).map_err(CommandError::Usage)?;
    let (config, _) = input::config(&args.machine, demo_of(&args.input), &global.budget)?;
    let Input::Scene(scene) = input::open(&args.input, &args.view, global)? else {
        return Err(CommandError::Usage(format!(
            "{}: is already a trace; `basrelief convert` changes its form",
            args.input.display()
        )));
    };
    check_outputs_keep_inputs(None, &[("--out", &args.out)], &[]).map_err(CommandError::Usage)?;
    let (scene, budget) = (scene.scene(), &global.budget);
    let mut commands = 0;
    to_trace_file(&args.out, |writer, form| {
        let mut progress = Progress::new(None, "commands", global.quiet);
        let expect = args.expect.then_some(&*args.machine.settings);
        let options = TraceOptions { config: &config, form, expect, budget };
        commands = record_trace(scene, writer, &options, &mut |at| progress.set_position(at))?;
        Ok(())
    })?;
    if !global.quiet && args.out != Path::new("-") {
        let bytes = std::fs::metadata(&args.out).map_or(0, |file| file.len());
        let (frames, with) = (scene.frames.len(), if args.expect { ", with expectations" } else { "" });
        let s = if frames == 1 { "" } else { "s" };
        let text = format!("{} commands of {frames} frame{s}, {} bytes{with}", thousands(commands), thousands(bytes));
        print(&format!("Written to {}: {text}\n", args.out.display()))?;
    }
    Ok(())
}
