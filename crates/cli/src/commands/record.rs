//! `basrelief record`: writes the output of the geometry processor as a trace.

use super::convert::to_trace_file;
use super::simulate::{read_files, simulate_quietly};
use crate::args::RecordArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::input::{self, Input, demo_of};
use crate::outputs::check_outputs_keep_inputs;
use crate::progress::Progress;
use basrelief_input::{CountedBuffer, MemoryPool};
use basrelief_report::number::thousands;
use basrelief_signals::Scene;
use basrelief_sim::{MachineConfig, RunInput, display_list, expectation_of, reserve_textures, trace_header};
use basrelief_trace::{BeginCommand, ExpectedResults, ParameterValue, TraceEncoding, TraceForm, TraceRecorder};
use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use std::path::Path;
use std::sync::Arc;

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
    let expectations = if args.expect { vec![replay_results(scene, &config, args, budget)?] } else { vec![] };
    let mut commands = 0;
    to_trace_file(&args.out, |writer, form| {
        let progress = Progress::new(None, "commands", global.quiet);
        commands = write_list(scene, &config, writer, (form, trace_header(scene)), expectations, (progress, budget))?;
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

/// Writes the trace of a scene with this form and header. Returns the number of commands before `end`,
/// which states it, too.
pub fn write_list(
    scene: &Arc<Scene>,
    config: &MachineConfig,
    writer: impl Write,
    (form, begin): (TraceForm, BeginCommand),
    expectations: Vec<ExpectedResults>,
    (mut progress, budget): (Progress, &MemoryPool),
) -> CommandResult<u64> {
    // Copies of texels during recording: base64 and a line buffer that doubles.
    let copies = || (0..4).map(|_| reserve_textures(scene, 0, budget)).collect::<Result<Vec<_>, _>>();
    let _copies = copies().map_err(CommandError::in_input(&scene.name))?;
    let failed = CommandError::in_input(&scene.name);
    let mut recorder = TraceRecorder::new(writer, form, begin).map_err(&failed)?;
    for (at, control) in (1_u64..).zip(display_list(scene, config)) {
        recorder.record(&control).map_err(&failed)?;
        progress.set_position(at);
    }
    let commands = recorder.commands() + expectations.len() as u64;
    recorder.finish(expectations).map(|_| commands).map_err(failed)
}

/// Returns the results of a replay of the trace. They differ from a run of the scene, where the geometry processor can be blocked: in a
/// replay, polygons arrive as if nothing had stalled.
fn replay_results(
    scene: &Arc<Scene>,
    config: &MachineConfig,
    args: &RecordArgs,
    budget: &MemoryPool,
) -> CommandResult<ExpectedResults> {
    let mut list = CountedBuffer::new(budget, "a display list");
    let form = TraceForm { encoding: TraceEncoding::Binary, compressed: true };
    let progress = Progress::new(None, "commands", true);
    write_list(scene, config, &mut list, (form, trace_header(scene)), vec![], (progress, budget))?;
    let (list, _held) = list.into_parts();
    let run = simulate_quietly(RunInput::trace(Cursor::new(list), &scene.name), config, None, budget)?;
    Ok(expectation_of(&run.report, settings_of(config, &args.machine.settings)?))
}

/// Returns the parameters that a replay needs: those that differ from their default, and those that the user set. If one belongs to a
/// memory, or is the clock, all parameters of that memory are needed, because the others would follow from its part.
fn settings_of(config: &MachineConfig, named: &[(String, String)]) -> CommandResult<BTreeMap<String, ParameterValue>> {
    let pairs = config.parameters().into_iter().zip(config.machine().parameters());
    let (told, other): (Vec<_>, Vec<_>) =
        pairs.partition(|(here, default)| here.default != default.default || named.iter().any(|(key, _)| *key == here.key));
    let follows = |key: &str| {
        let memory = memory_of(key);
        memory.is_some() && told.iter().any(|(p, _)| p.key == "clock.hz" || memory_of(&p.key) == memory)
    };
    let followers: Vec<_> = other.into_iter().filter(|(p, _)| follows(&p.key)).collect();
    let value = |value| serde_json::from_value(value).map_err(CommandError::bad_input);
    told.into_iter().chain(followers).map(|(here, _)| Ok((here.key, value(here.default)?))).collect()
}

/// Returns the memory of a parameter.
fn memory_of(key: &str) -> Option<&str> {
    key.strip_prefix("memory.").and_then(|rest| rest.split('.').next())
}
