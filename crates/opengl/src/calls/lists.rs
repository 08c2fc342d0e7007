//! The fixed function during a trace: current values, primitives and display lists.

use super::immediate::{FixedCall, VertexPart};
use super::mesh::{ArrayMesh, FixedMesh, FixedVertex};
use crate::draw::{DrawCall, NAME_OTHERS};
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::{SceneError, over_budget};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Most lists within each other; OpenGL guarantees 64.
const DEEPEST: usize = 64;

/// Most calls that one call executes through display lists.
const MOST_CALLS: u64 = 1 << 24;

/// A display list while it is compiled.
struct OpenList {
    number: u64,
    executes: bool,
    calls: Vec<FixedCall>,
}

/// State of the fixed function.
pub(crate) struct FixedFunction {
    budget: MemoryPool,
    current: FixedVertex,
    flat: bool,
    /// Mode and vertices since `glBegin`.
    primitive: Option<(Box<str>, Vec<FixedVertex>)>,
    mesh: FixedMesh,
    /// Memory of primitive and mesh.
    held: MemoryReservation,
    /// First reason why the primitives cannot be drawn.
    fault: Option<SceneError>,
    lists: BTreeMap<u64, Rc<Vec<FixedCall>>>,
    open: Option<OpenList>,
    /// Memory of lists.
    lists_held: MemoryReservation,
    executed: u64,
}

/// How a call is executed.
#[derive(Clone, Copy)]
struct Execution {
    /// Vertices are collected.
    collects: bool,
    /// A program computes the colours, so that triangles are never flat.
    has_program: bool,
    /// Number of lists around the call.
    depth: usize,
}

impl FixedFunction {
    pub fn new(budget: &MemoryPool) -> Self {
        let (held, lists_held) = (budget.empty_reservation(), budget.empty_reservation());
        let (current, primitive, mesh, fault, lists) = Default::default();
        Self {
            budget: budget.clone(),
            current,
            flat: false,
            primitive,
            mesh,
            held,
            fault,
            lists,
            open: None,
            lists_held,
            executed: 0,
        }
    }

    /// Returns the current values of attributes.
    pub fn current(&self) -> &FixedVertex {
        &self.current
    }

    /// Returns true if triangles are flat, unless a program computes their colours.
    pub fn is_flat(&self) -> bool {
        self.flat
    }

    /// Begins a display list.
    pub fn open_list(&mut self, number: u64, executes: bool) {
        self.open = Some(OpenList { number, executes, calls: Vec::new() });
    }

    /// Ends a display list.
    pub fn close_list(&mut self) {
        if let Some(open) = self.open.take() {
            self.lists.insert(open.number, Rc::new(open.calls));
        }
    }

    /// Returns true if draw calls go into a display list.
    pub fn has_open_list(&self) -> bool {
        self.open.is_some()
    }

    /// Returns true if calls go into a display list only.
    pub fn only_compiles(&self) -> bool {
        self.open.as_ref().is_some_and(|open| !open.executes)
    }

    /// Adds a call to the open display list, if there is one.
    pub fn compile(&mut self, call: &FixedCall) -> Result<(), SceneError> {
        let Some(open) = &mut self.open else { return Ok(()) };
        let arrays = match call {
            FixedCall::Arrays(mesh) => mesh.bytes(),
            _ => 0,
        };
        let bytes = 2 * size_of::<FixedCall>() as u64 + arrays;
        self.lists_held.try_grow(bytes, "a display list").map_err(|e| over_budget("", &e))?;
        open.calls.push(call.clone());
        Ok(())
    }

    /// Executes a call. `wanted` draw calls collect the vertices of display lists.
    pub fn execute(&mut self, call: &FixedCall, wanted: bool, has_program: bool) -> Result<(), SceneError> {
        let is_list = matches!(call, FixedCall::List(_));
        let is_inside = self.primitive.is_some();
        if !is_inside && (is_list || matches!(call, FixedCall::Begin(_))) {
            (self.mesh, self.fault, self.executed) = (FixedMesh::default(), None, 0);
            self.held.shrink_to(0);
        }
        let collects = wanted || is_inside || !is_list;
        self.step(call, Execution { collects, has_program, depth: 0 })
    }

    fn step(&mut self, call: &FixedCall, how: Execution) -> Result<(), SceneError> {
        match call {
            FixedCall::Begin(mode) => self.primitive = Some((mode.clone(), Vec::new())),
            FixedCall::Set(VertexPart::Position, value) => self.vertex(*value, how)?,
            FixedCall::Set(VertexPart::Normal, [x, y, z, _]) => self.current.normal = [*x, *y, *z],
            FixedCall::Set(VertexPart::Color, value) => self.current.color = *value,
            FixedCall::Set(VertexPart::Uv, value) => self.current.uv = *value,
            FixedCall::ShadeModel { flat } => self.flat = *flat,
            FixedCall::End => {
                if let Some((mode, vertices)) = self.primitive.take().filter(|_| how.collects) {
                    let numbers: Vec<u32> = (0..vertices.len() as u32).collect();
                    self.add(&mode, &vertices, &numbers, how);
                }
            }
            FixedCall::Arrays(mesh) if how.collects => {
                self.held.try_grow(2 * mesh.bytes(), "vertices of a draw call").map_err(|e| over_budget("", &e))?;
                let mut mesh = ArrayMesh::clone(mesh);
                mesh.fill(&self.current);
                self.add(&mesh.mode, &mesh.vertices(), &mesh.numbers(), how);
            }
            FixedCall::List(number) => self.list(*number, how)?,
            FixedCall::State(name) if how.depth > 0 && self.has_vertices() => {
                self.mesh.left_out.insert(name.to_string());
            }
            FixedCall::Refused(name) if how.depth > 0 || self.primitive.is_some() => self.refuse(name),
            FixedCall::Arrays(_) | FixedCall::State(_) | FixedCall::Refused(_) => {}
        }
        Ok(())
    }

    fn has_vertices(&self) -> bool {
        !self.mesh.vertices.is_empty() || self.primitive.as_ref().is_some_and(|(_, vertices)| !vertices.is_empty())
    }

    fn vertex(&mut self, position: [f32; 4], how: Execution) -> Result<(), SceneError> {
        if how.collects && self.primitive.is_some() {
            self.held.try_grow(FixedMesh::size_of(1), "vertices of a draw call").map_err(|e| over_budget("", &e))?;
            let vertex = FixedVertex { position, ..self.current };
            self.primitive.iter_mut().for_each(|(_, vertices)| vertices.push(vertex));
        }
        Ok(())
    }

    fn add(&mut self, mode: &str, vertices: &[FixedVertex], numbers: &[u32], how: Execution) {
        if let Err(fault) = self.mesh.add(mode, vertices, numbers, self.flat && !how.has_program) {
            self.fault.get_or_insert(fault);
        }
    }

    fn refuse(&mut self, name: &str) {
        let fault = || {
            SceneError::at(name, "is not followed within a display list or glBegin")
                .expected("vertices, normals, colours, texture coordinates and arrays, under one matrix")
                .cure(NAME_OTHERS)
        };
        self.fault.get_or_insert_with(fault);
    }

    /// Executes a display list. OpenGL ignores lists that do not exist and those that are too deep.
    fn list(&mut self, number: u64, how: Execution) -> Result<(), SceneError> {
        let Some(list) = self.lists.get(&number).cloned().filter(|_| how.depth < DEEPEST) else { return Ok(()) };
        self.executed += list.len() as u64 + 1;
        if self.executed > MOST_CALLS {
            return Err(SceneError::at("glCallList", format!("executes more than {MOST_CALLS} calls")).cure(NAME_OTHERS));
        }
        list.iter().try_for_each(|call| self.step(call, Execution { depth: how.depth + 1, ..how }))
    }

    /// Returns the collected triangles as a draw call, with the memory that they need.
    pub fn draw(&mut self, call: u64) -> Result<(DrawCall, MemoryReservation), SceneError> {
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        let draw = std::mem::take(&mut self.mesh).into_draw(call);
        Ok((draw, std::mem::replace(&mut self.held, self.budget.empty_reservation())))
    }
}
