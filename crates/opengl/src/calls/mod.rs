//! Draw calls of a trace, from the text of `apitrace dump --multiline=no --blobs`: arguments, indices and vertices, which state dumps lack.

mod arrays;
mod immediate;
mod line;
mod lists;
mod memory;
mod mesh;
#[cfg(test)]
mod tests;

pub use memory::BlobFiles;
pub(crate) use mesh::POSITION;

use crate::draw::DrawCall;
use arrays::{array_mesh, unsupported};
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::{SceneError, over_budget};
use immediate::FixedCall;
use line::TraceCall;
use lists::FixedFunction;
use memory::TraceMemory;
use mesh::FixedMesh;
use std::collections::{BTreeMap, BTreeSet};

/// The calls of one frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameCalls {
    /// Numbers of the draw calls. Vertices between `glBegin` and `glEnd` have the number of `glEnd`, because the state is dumped there.
    pub draws: Vec<u64>,
    /// Number of the last call.
    pub last: u64,
    /// The application has shown the frame.
    pub is_complete: bool,
}

/// Returns the frames of a trace that draw. The calls after the last swap of buffers form a frame that is not complete.
pub fn frames(text: &str) -> Vec<FrameCalls> {
    let mut frames = vec![FrameCalls::default()];
    let mut lists = DrawingLists::default();
    for call in text.lines().filter_map(TraceCall::parse) {
        let Some(frame) = frames.last_mut() else { break };
        frame.last = call.number;
        if lists.draws(&call) {
            frame.draws.push(call.number);
        }
        if is_swap(call.name) {
            frame.is_complete = true;
            frames.push(FrameCalls::default());
        }
    }
    frames.retain(|frame| !frame.draws.is_empty());
    frames
}

/// Display lists that draw.
#[derive(Default)]
struct DrawingLists {
    known: BTreeSet<u64>,
    /// Number of the open list, and whether its calls are executed too.
    open: Option<(u64, bool)>,
    /// Between `glBegin` and `glEnd`.
    is_inside: bool,
}

impl DrawingLists {
    /// Follows a call. Returns true if it draws.
    fn draws(&mut self, call: &TraceCall<'_>) -> bool {
        let list = call.list();
        match call.name {
            "glNewList" => {
                self.open = Some((list, call.executes_list()));
                self.known.remove(&list);
            }
            "glEndList" => self.open = None,
            "glBegin" => self.is_inside = true,
            _ => {}
        }
        let is_known = call.name != "glCallList" || self.known.contains(&list);
        let draws = is_draw(call.name) && is_known && (!self.is_inside || call.name == "glEnd");
        self.is_inside &= call.name != "glEnd";
        if let Some((list, _)) = self.open.filter(|_| draws) {
            self.known.insert(list);
        }
        draws && self.open.is_none_or(|(_, executes)| executes)
    }
}

fn is_swap(name: &str) -> bool {
    name.ends_with("SwapBuffers")
        || name.contains("SwapBuffersWithDamage")
        || matches!(name, "glFrameTerminatorGREMEDY" | "CGLFlushDrawable")
}

fn is_draw(name: &str) -> bool {
    let is_other = name.starts_with("glDrawBuffer") || name.starts_with("glDrawPixels");
    (name.starts_with("glDraw") && !is_other)
        || ["glMultiDraw", "glEvalMesh", "glRect"].iter().any(|prefix| name.starts_with(prefix))
        || matches!(name, "glEnd" | "glCallList" | "glCallLists")
}

/// The state behind a draw call, with its memory.
#[derive(Debug)]
pub struct StateDump {
    /// Number of the call.
    pub call: u64,
    /// Output of `apitrace replay -D CALL`.
    pub bytes: Vec<u8>,
    /// Memory of `bytes`.
    pub held: MemoryReservation,
}

/// Adds the arguments, indices and vertices of draw calls to their state dumps, as the member `draw`.
///
/// `text` is the output of `apitrace dump`, and `files` reads its blobs. Returns the dumps in their order.
///
/// # Errors
/// A draw call of a kind that is not supported, or that is not in the text; a blob that cannot be read; too much memory.
pub fn with_draws(
    text: &str,
    files: BlobFiles<'_>,
    mut dumps: Vec<StateDump>,
    budget: &MemoryPool,
) -> Result<Vec<StateDump>, SceneError> {
    let wanted: BTreeSet<u64> = dumps.iter().map(|dump| dump.call).collect();
    let mut replay = TraceReplay { memory: TraceMemory::new(files, budget), fixed: FixedFunction::new(budget) };
    let mut found = BTreeMap::new();
    for call in text.lines().filter_map(TraceCall::parse) {
        let at_call = |e: SceneError| SceneError { place: format!("call {}: {}", call.number, e.place), ..e };
        let draw = replay.follow(&call, wanted.contains(&call.number)).map_err(at_call)?;
        found.extend(draw.map(|draw| (call.number, draw)));
    }
    drop(replay);
    for dump in &mut dumps {
        let place = format!("call {}", dump.call);
        let missing = || SceneError::at(&*place, "is not in the trace").expected("the number of a draw call");
        let (draw, held) = found.remove(&dump.call).ok_or_else(missing)?;
        let text = serde_json::to_string(&draw).map_err(|e| SceneError::at(&*place, e.to_string()))?;
        drop((draw, held));
        let member = format!("\n  \"draw\": {text},");
        // The text, and twice the dump while it grows.
        let bytes = 2 * (text.len() + member.len()) as u64 + dump.bytes.len() as u64;
        dump.held.try_grow(bytes, "a dump with its draw call").map_err(|e| over_budget(&*place, &e))?;
        let start = dump.bytes.iter().position(|byte| *byte == b'{').map_or(dump.bytes.len(), |at| at + 1);
        dump.bytes.splice(start..start, member.into_bytes());
        dump.bytes.shrink_to_fit();
        dump.held.shrink_to(dump.bytes.len() as u64);
    }
    Ok(dumps)
}

/// Memory and state of OpenGL, call by call.
struct TraceReplay<'a> {
    memory: TraceMemory<'a>,
    fixed: FixedFunction,
}

/// A draw call with its memory.
type CountedDraw = (DrawCall, MemoryReservation);

impl TraceReplay<'_> {
    /// Follows a call. Returns its draw call if it is wanted.
    fn follow(&mut self, call: &TraceCall<'_>, wanted: bool) -> Result<Option<CountedDraw>, SceneError> {
        match call.name {
            "glNewList" => self.fixed.open_list(call.list(), call.executes_list()),
            "glEndList" => self.fixed.close_list(),
            _ => {}
        }
        let draw = if let Some(fixed_call) = FixedCall::parse(call) {
            self.follow_fixed(&fixed_call, call, wanted)?
        } else {
            if self.fixed.has_open_list() && is_draw(call.name) {
                self.fixed.compile(&compiled(call, &mut self.memory)?)?;
            }
            if wanted { Some(self.draw_arrays(call)?) } else { None }
        };
        self.memory.follow(call)?;
        Ok(draw)
    }

    fn follow_fixed(
        &mut self,
        fixed_call: &FixedCall,
        call: &TraceCall<'_>,
        wanted: bool,
    ) -> Result<Option<CountedDraw>, SceneError> {
        self.fixed.compile(fixed_call)?;
        if !self.fixed.only_compiles() {
            self.fixed.execute(fixed_call, wanted, self.memory.has_program())?;
        }
        match fixed_call {
            _ if !wanted => Ok(None),
            FixedCall::End | FixedCall::List(_) => self.fixed.draw(call.number).map(Some),
            _ => Err(unsupported(call, "this kind of draw call is not read")),
        }
    }

    /// Reads a draw call from arrays.
    fn draw_arrays(&mut self, call: &TraceCall<'_>) -> Result<CountedDraw, SceneError> {
        let (mut mesh, mut held) = array_mesh(call, &mut self.memory)?;
        if !mesh.is_fixed() {
            return Ok((mesh.into_draw(call.number), held));
        }
        held.join(self.memory.reserve(mesh.bytes(), "vertices of a draw call")?);
        mesh.fill(self.fixed.current());
        if !self.fixed.is_flat() || self.memory.has_program() {
            return Ok((mesh.into_draw(call.number), held));
        }
        let mut flat = FixedMesh::default();
        flat.add(&mesh.mode, &mesh.vertices(), &mesh.numbers(), true)?;
        Ok((flat.into_draw(call.number), held))
    }
}

/// Returns a draw call from arrays as a display list holds it.
fn compiled(call: &TraceCall<'_>, memory: &mut TraceMemory<'_>) -> Result<FixedCall, SceneError> {
    match array_mesh(call, memory) {
        Ok((mesh, _)) if mesh.is_fixed() => Ok(FixedCall::Arrays(Box::new(mesh))),
        Err(error) if error.over_budget => Err(error),
        _ => Ok(FixedCall::Refused(call.name.into())),
    }
}
