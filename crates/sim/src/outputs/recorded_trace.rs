//! Traces of scenes: the output of the geometry processor.

use crate::command_error::{CommandError, CommandResult};
use crate::named_run::run_quietly;
use crate::options::RunInput;
use crate::outputs::expectation::expectation_of;
use crate::run::display_list::{display_list, trace_header};
use crate::run::memory_estimates::reserve_textures;
use basrelief_input::{CountedBuffer, MemoryPool};
use basrelief_kernel::Engine;
use basrelief_machines::MachineConfig;
use basrelief_signals::Scene;
use basrelief_trace::{ExpectedResults, ParameterValue, TraceEncoding, TraceForm, TraceRecorder};
use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use std::sync::Arc;

/// Options of a trace.
#[derive(Clone, Copy, Debug)]
pub struct TraceOptions<'a> {
    /// The machine that replays the trace.
    pub config: &'a MachineConfig,
    /// Form of the trace.
    pub form: TraceForm,
    /// Parameters that the user gave. With them the trace states the results of its replay.
    pub expect: Option<&'a [(String, String)]>,
    /// Memory limit.
    pub budget: &'a MemoryPool,
}

/// Writes the trace of a scene. `progress` receives the number of commands so far. Returns the number of commands before `end`, which
/// states it, too.
///
/// # Errors
/// A trace that cannot be written, a replay that does not finish, and data beyond the memory limit.
pub fn record_trace(
    scene: &Arc<Scene>,
    writer: &mut dyn Write,
    options: &TraceOptions<'_>,
    progress: &mut dyn FnMut(u64),
) -> CommandResult<u64> {
    let expectations = options.expect.map(|given| replay_results(scene, options, given)).transpose()?;
    write_list(scene, writer, options, expectations.into_iter().collect(), progress)
}

fn write_list(
    scene: &Arc<Scene>,
    writer: &mut dyn Write,
    options: &TraceOptions<'_>,
    expectations: Vec<ExpectedResults>,
    progress: &mut dyn FnMut(u64),
) -> CommandResult<u64> {
    // Copies of texels during recording: base64 and a line buffer that doubles.
    let copies = || (0..4).map(|_| reserve_textures(scene, 0, options.budget)).collect::<Result<Vec<_>, _>>();
    let _copies = copies().map_err(CommandError::in_input(&scene.name))?;
    let failed = CommandError::in_input(&scene.name);
    let mut recorder = TraceRecorder::new(writer, options.form, trace_header(scene)).map_err(&failed)?;
    for (at, control) in (1_u64..).zip(display_list(scene, options.config)) {
        recorder.record(&control).map_err(&failed)?;
        progress(at);
    }
    let commands = recorder.commands() + expectations.len() as u64;
    recorder.finish(expectations).map(|_| commands).map_err(failed)
}

/// Returns the results of a replay of the trace. They differ from a run of the scene, where the geometry processor can be blocked: in a
/// replay, polygons arrive as if nothing had stalled.
fn replay_results(scene: &Arc<Scene>, options: &TraceOptions<'_>, given: &[(String, String)]) -> CommandResult<ExpectedResults> {
    let TraceOptions { config, budget, .. } = *options;
    let mut list = CountedBuffer::new(budget, "a display list");
    let form = TraceForm { encoding: TraceEncoding::Binary, compressed: TraceForm::CAN_COMPRESS };
    write_list(scene, &mut list, &TraceOptions { form, ..*options }, vec![], &mut |_| {})?;
    let (list, _held) = list.into_parts();
    let run = run_quietly(RunInput::trace(Cursor::new(list), &scene.name), config, Engine::Timed, budget)?;
    Ok(expectation_of(&run.report, settings_of(config, given)?))
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
