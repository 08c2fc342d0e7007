//! Buffers, vertex arrays and programs of a trace, followed call by call.

use super::line::TraceCall;
use super::mesh::{COLOR, NORMAL, POSITION, UV};
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::{SceneError, over_budget};
use std::collections::BTreeMap;
use std::io;
use std::rc::Rc;

/// Reads a file that `apitrace dump --blobs` has written, by name.
pub type BlobFiles<'a> = &'a dyn Fn(&str) -> io::Result<(Vec<u8>, MemoryReservation)>;

/// Content of a buffer.
#[derive(Debug, Default)]
pub(crate) struct TraceBuffer {
    pub bytes: Vec<u8>,
    _held: Option<MemoryReservation>,
}

/// Source of a vertex attribute.
#[derive(Clone, Debug, Default)]
pub(crate) struct AttributePointer {
    pub enabled: bool,
    pub size: u64,
    /// Component type, such as `GL_FLOAT`; empty if the pointer was not set by a call that is followed.
    pub kind: String,
    pub normalized: bool,
    pub stride: u64,
    pub offset: u64,
    pub divisor: u64,
    pub buffer: u64,
    /// Memory of the application, in place of a buffer.
    pub client: Option<Rc<TraceBuffer>>,
}

/// State of a vertex array object.
#[derive(Clone, Debug, Default)]
pub(crate) struct VertexArray {
    pub elements: u64,
    /// Attributes of programs, by location.
    attributes: BTreeMap<u64, AttributePointer>,
    /// Attributes of the fixed function, by name.
    fixed: BTreeMap<&'static str, AttributePointer>,
}

/// A part of a buffer that the application writes through a pointer.
#[derive(Debug)]
struct MappedRange {
    address: u64,
    length: u64,
    buffer: u64,
    offset: u64,
}

/// Memory of OpenGL during a trace.
pub(crate) struct TraceMemory<'a> {
    files: BlobFiles<'a>,
    budget: &'a MemoryPool,
    bound: BTreeMap<String, u64>,
    pub buffers: BTreeMap<u64, TraceBuffer>,
    arrays: BTreeMap<u64, VertexArray>,
    array: u64,
    /// Arrays that the application has put aside.
    put_aside: Vec<(u64, VertexArray)>,
    program: u64,
    /// The unit that calls for texture coordinates concern is another one than 0.
    other_unit: bool,
    /// Names of attributes by program and location.
    names: BTreeMap<(u64, u64), String>,
    mapped: Vec<MappedRange>,
}

const ELEMENTS: &str = "GL_ELEMENT_ARRAY_BUFFER";

impl<'a> TraceMemory<'a> {
    pub fn new(files: BlobFiles<'a>, budget: &'a MemoryPool) -> Self {
        let (bound, buffers, arrays, put_aside, names, mapped) = Default::default();
        let (array, program, other_unit) = (0, 0, false);
        Self { files, budget, bound, buffers, arrays, array, put_aside, program, other_unit, names, mapped }
    }

    /// Returns true if a program computes the picture.
    pub fn has_program(&self) -> bool {
        self.program != 0
    }

    /// Returns the enabled attributes that have a name.
    pub fn attributes(&self) -> impl Iterator<Item = (&str, &AttributePointer)> {
        let array = self.arrays.get(&self.array);
        let generic = array.into_iter().flat_map(|array| &array.attributes);
        let named = generic.filter_map(|(location, pointer)| Some((self.name(*location)?.as_str(), pointer)));
        let fixed = array.into_iter().flat_map(|array| &array.fixed).map(|(name, pointer)| (*name, pointer));
        named.chain(fixed).filter(|(_, pointer)| pointer.enabled)
    }

    /// Returns the bound vertex array.
    pub fn vertex_array(&mut self) -> &mut VertexArray {
        self.arrays.entry(self.array).or_default()
    }

    /// Returns the name of the attribute at a location of the current program.
    fn name(&self, location: u64) -> Option<&String> {
        self.names.get(&(self.program, location))
    }

    /// Reserves memory for a draw call.
    pub fn reserve(&self, bytes: u64, what: &str) -> Result<MemoryReservation, SceneError> {
        self.budget.try_reserve(bytes, what).map_err(|e| over_budget("", &e))
    }

    /// Reads a blob.
    pub fn blob(&self, name: &str) -> Result<TraceBuffer, SceneError> {
        let cannot = |e: io::Error| match basrelief_input::OverBudget::in_io_error(&e) {
            Some(error) => over_budget(name, error),
            None => SceneError::at(name, format!("cannot be read: {e}")).expected("a file of `apitrace dump --blobs`"),
        };
        let (bytes, held) = (self.files)(name).map_err(cannot)?;
        Ok(TraceBuffer { bytes, _held: Some(held) })
    }

    /// Follows a call.
    pub fn follow(&mut self, call: &TraceCall<'_>) -> Result<(), SceneError> {
        let number = |name: &str| call.number(name).unwrap_or_default();
        match call.name {
            "glBindBuffer" => self.bind(call.text("target").unwrap_or_default(), number("buffer")),
            "glBindVertexArray" => self.array = number("array"),
            "glUseProgram" => self.program = number("program"),
            "glBindAttribLocation" => self.set_name(call, number("index"), call.string("name")),
            "glGetAttribLocation" => self.set_name(call, call.returned().unwrap_or(u64::MAX), call.string("name")),
            "glBufferData" | "glBufferStorage" => self.store(self.target(call), call)?,
            "glNamedBufferData" | "glNamedBufferStorage" => self.store(number("buffer"), call)?,
            "glBufferSubData" => self.write(self.target(call), number("offset"), call, "data")?,
            "glNamedBufferSubData" => self.write(number("buffer"), number("offset"), call, "data")?,
            "glMapBuffer" | "glMapBufferRange" => self.map(self.target(call), call),
            "glUnmapBuffer" => {
                let buffer = self.target(call);
                self.mapped.retain(|range| range.buffer != buffer);
            }
            "memcpy" => self.copy(call)?,
            "glVertexAttribPointer" => self.point(call)?,
            "glVertexAttribDivisor" => self.attribute(number("index")).divisor = number("divisor"),
            "glEnableVertexAttribArray" => self.attribute(number("index")).enabled = true,
            "glDisableVertexAttribArray" => self.attribute(number("index")).enabled = false,
            _ => self.follow_fixed(call)?,
        }
        Ok(())
    }

    /// Follows a call of the fixed function.
    fn follow_fixed(&mut self, call: &TraceCall<'_>) -> Result<(), SceneError> {
        match call.name {
            "glVertexPointer" => self.point_fixed(POSITION, call, false)?,
            "glNormalPointer" => self.point_fixed(NORMAL, call, true)?,
            "glColorPointer" => self.point_fixed(COLOR, call, true)?,
            "glTexCoordPointer" if !self.other_unit => self.point_fixed(UV, call, false)?,
            "glClientActiveTexture" | "glClientActiveTextureARB" => {
                self.other_unit = call.text("texture") != Some("GL_TEXTURE0");
            }
            "glEnableClientState" | "glDisableClientState" => {
                let enabled = call.name == "glEnableClientState";
                let name = match call.text("array") {
                    Some("GL_VERTEX_ARRAY") => POSITION,
                    Some("GL_NORMAL_ARRAY") => NORMAL,
                    Some("GL_COLOR_ARRAY") => COLOR,
                    Some("GL_TEXTURE_COORD_ARRAY") if !self.other_unit => UV,
                    _ => return Ok(()),
                };
                self.vertex_array().fixed.entry(name).or_default().enabled = enabled;
            }
            "glPushClientAttrib" => {
                let array = self.vertex_array().clone();
                self.put_aside.push((self.array, array));
            }
            "glPopClientAttrib" => {
                if let Some((number, array)) = self.put_aside.pop() {
                    self.array = number;
                    self.arrays.insert(number, array);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn attribute(&mut self, index: u64) -> &mut AttributePointer {
        self.vertex_array().attributes.entry(index).or_default()
    }

    fn bind(&mut self, target: &str, buffer: u64) {
        if target == ELEMENTS {
            self.vertex_array().elements = buffer;
        } else {
            self.bound.insert(target.into(), buffer);
        }
    }

    /// Returns the buffer bound to the target of a call.
    fn target(&self, call: &TraceCall<'_>) -> u64 {
        let target = call.text("target").unwrap_or_default();
        let bound = || self.bound.get(target).copied();
        let elements = || self.arrays.get(&self.array).map(|array| array.elements);
        if target == ELEMENTS { elements() } else { bound() }.unwrap_or_default()
    }

    fn set_name(&mut self, call: &TraceCall<'_>, location: u64, name: Option<&str>) {
        if let (Some(program), Some(name)) = (call.number("program"), name) {
            self.names.insert((program, location), name.into());
        }
    }

    /// Replaces a buffer: by a blob, or by zeros.
    fn store(&mut self, buffer: u64, call: &TraceCall<'_>) -> Result<(), SceneError> {
        self.buffers.remove(&buffer);
        let stored = if let Some(name) = call.blob("data") {
            self.blob(name)?
        } else {
            let size = call.number("size").unwrap_or_default();
            let held = self.budget.try_reserve(size, "a buffer").map_err(|e| over_budget(call.name, &e))?;
            TraceBuffer { bytes: vec![0; size as usize], _held: Some(held) }
        };
        self.buffers.insert(buffer, stored);
        Ok(())
    }

    /// Writes a blob into a buffer. Bytes behind its end are left out, as OpenGL refuses them.
    fn write(&mut self, buffer: u64, offset: u64, call: &TraceCall<'_>, data: &str) -> Result<(), SceneError> {
        let Some(name) = call.blob(data) else { return Ok(()) };
        let from = self.blob(name)?;
        let to = self.buffers.get_mut(&buffer).and_then(|to| to.bytes.get_mut(usize::try_from(offset).ok()?..));
        to.into_iter().for_each(|to| to.iter_mut().zip(&from.bytes).for_each(|(to, from)| *to = *from));
        Ok(())
    }

    fn map(&mut self, buffer: u64, call: &TraceCall<'_>) {
        let whole = self.buffers.get(&buffer).map_or(0, |buffer| buffer.bytes.len() as u64);
        let length = call.number("length").unwrap_or(whole);
        let offset = call.number("offset").unwrap_or_default();
        if let Some(address) = call.returned() {
            self.mapped.push(MappedRange { address, length, buffer, offset });
        }
    }

    /// Follows a write through a pointer.
    fn copy(&mut self, call: &TraceCall<'_>) -> Result<(), SceneError> {
        let address = call.number("dest").unwrap_or_default();
        let is_in = |range: &&MappedRange| address >= range.address && address - range.address < range.length;
        let Some(range) = self.mapped.iter().rev().find(is_in) else { return Ok(()) };
        let (buffer, offset) = (range.buffer, range.offset.saturating_add(address - range.address));
        self.write(buffer, offset, call, "src")
    }

    fn point(&mut self, call: &TraceCall<'_>) -> Result<(), SceneError> {
        let pointer = self.pointer(call, call.text("normalized") == Some("GL_TRUE"))?;
        let attribute = self.attribute(call.number("index").unwrap_or_default());
        let (enabled, divisor) = (attribute.enabled, attribute.divisor);
        *attribute = AttributePointer { enabled, divisor, ..pointer };
        Ok(())
    }

    fn point_fixed(&mut self, name: &'static str, call: &TraceCall<'_>, normalized: bool) -> Result<(), SceneError> {
        let pointer = self.pointer(call, normalized)?;
        let attribute = self.vertex_array().fixed.entry(name).or_default();
        *attribute = AttributePointer { enabled: attribute.enabled, ..pointer };
        Ok(())
    }

    /// Returns the source that a call names. Normals have three components, which their call does not state.
    fn pointer(&self, call: &TraceCall<'_>, normalized: bool) -> Result<AttributePointer, SceneError> {
        let number = |name: &str| call.number(name).unwrap_or_default();
        let client = call.blob("pointer").map(|name| self.blob(name)).transpose()?;
        Ok(AttributePointer {
            size: if call.name == "glNormalPointer" { 3 } else { number("size") },
            kind: call.text("type").unwrap_or_default().into(),
            normalized,
            stride: number("stride"),
            offset: number("pointer"),
            buffer: self.bound.get("GL_ARRAY_BUFFER").copied().unwrap_or_default(),
            client: client.map(Rc::new),
            ..AttributePointer::default()
        })
    }
}
