//! Replay of commands as the tokens that travel on the wires.

use crate::check::check_length;
use crate::command::*;
use crate::data::Digest;
use crate::dent::{DentedPolygons, is_dented};
use crate::error::{CommandFault, ErrorKind, TraceError, TracePlace};
use crate::lent::LentTokens;
use crate::reader::{TraceReader, open};
use crate::sequence::FrameNesting;
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use basrelief_signals::{Control, Frame, Image, Light, Material, ObjectInfo, Polygon, ShadingSettings, Texture, Vertex};
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::sync::Arc;

/// Memory of a texture or a material beside its name and its texels, with its entries in tables \[bytes\].
const DEFINITION: u64 = 1 << 10;
/// Bytes of a texel.
const TEXEL: u64 = 4;

/// Opens the files beside a trace that hold texels. Names are relative, have `/` between their parts and no `..`.
pub trait TextureFiles {
    /// Opens a file.
    ///
    /// # Errors
    /// If there is no such file, or it cannot be read.
    fn open(&mut self, name: &str) -> io::Result<Box<dyn Read>>;
}

impl TextureFiles for Box<dyn TextureFiles> {
    fn open(&mut self, name: &str) -> io::Result<Box<dyn Read>> {
        (**self).open(name)
    }
}

impl<F: FnMut(&str) -> io::Result<Box<dyn Read>>> TextureFiles for F {
    fn open(&mut self, name: &str) -> io::Result<Box<dyn Read>> {
        self(name)
    }
}

/// Files of a trace without a folder, such as one on standard input: none.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl TextureFiles for NoFiles {
    fn open(&mut self, _: &str) -> io::Result<Box<dyn Read>> {
        Err(io::Error::new(io::ErrorKind::NotFound, "this trace is read without a folder to look in"))
    }
}

/// An expectation, with its place in the trace.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedExpectation {
    /// Place of the command.
    pub place: TracePlace,
    /// The expected results.
    pub results: ExpectedResults,
}

/// Checks a trace and turns its commands into control tokens, each with the cycle of its arrival (polygons only).
///
/// Iterate to the end. The trace is checked, and all [expectations](Self::expectations) are there, only then. Textures and
/// materials are kept and shared by their polygons; polygons are not kept. Kept data count against the memory limit.
/// Tokens count until their last clone is dropped.
pub struct TraceResolver<R: Read, F> {
    reader: TraceReader<R>,
    files: F,
    nesting: FrameNesting,
    textures: BTreeMap<u32, (TextureKind, Arc<Texture>)>,
    /// Colour textures defined ahead of the next frame: it declares them.
    declared: Vec<Arc<Texture>>,
    materials: BTreeMap<u32, Arc<Material>>,
    /// Shading settings of the next frame or object.
    shading: ShadingSettings,
    /// Importance of the next object.
    bias: Option<u8>,
    expectations: Vec<PlacedExpectation>,
    dented: Option<DentedPolygons>,
    failed: bool,
    budget: MemoryPool,
    /// Reservation of the kept data.
    held: MemoryReservation,
    /// Texels of the largest texture. Hashing and recording copy them.
    copied: MemoryReservation,
    texture_copies: u64,
    lent: LentTokens,
}

impl<R: Read, F: TextureFiles> TraceResolver<R, F> {
    /// Opens a trace of any form.
    ///
    /// # Errors
    /// Errors of [`open`](crate::open).
    pub fn new(reader: R, files: F, budget: &MemoryPool) -> Result<Self, TraceError> {
        let reader = open(reader, budget)?;
        let begin = reader.begin();
        // Hashing the trace copies it.
        let generator = budget.try_reserve(4 * begin.generator.len() as u64, "the name of its generator");
        let held = generator.map_err(|e| CommandFault::over_budget("generator")(e).at(reader.place(), "begin"))?;
        Ok(Self {
            reader,
            files,
            nesting: FrameNesting::default(),
            textures: BTreeMap::new(),
            declared: Vec::new(),
            materials: BTreeMap::new(),
            shading: ShadingSettings::default(),
            bias: None,
            expectations: Vec::new(),
            dented: None,
            failed: false,
            budget: budget.clone(),
            held,
            copied: budget.empty_reservation(),
            texture_copies: 0,
            lent: LentTokens::new(budget),
        })
    }

    /// Counts the texels of each texture this many times more, for copies in the machine.
    #[must_use]
    pub fn with_texture_copies(mut self, copies: u64) -> Self {
        self.texture_copies = copies;
        self
    }

    /// Error of a request beyond the memory limit that the last command causes.
    pub fn over_budget(&self, error: &OverBudget) -> TraceError {
        self.reader.over_budget(error)
    }

    /// First command: size of the pictures, and generator.
    pub fn begin(&self) -> &BeginCommand {
        self.reader.begin()
    }

    /// Expectations read so far. All are there after the iteration has ended.
    pub fn expectations(&self) -> &[PlacedExpectation] {
        &self.expectations
    }

    /// Returns the polygons so far that are not convex; `None` without one.
    pub fn dented_polygons(&self) -> Option<DentedPolygons> {
        self.dented
    }

    /// Returns all expectations with their reservation.
    pub fn into_expectations(self) -> (Vec<PlacedExpectation>, MemoryReservation) {
        let bytes = self.expectations.iter().map(|expectation| 2 * expectation.results.bytes()).sum();
        let Self { mut held, expectations, .. } = self;
        // Counted when they were read.
        held.shrink_to(bytes);
        (expectations, held)
    }

    fn take(&mut self, command: TraceCommand) -> Result<Option<Control>, CommandFault> {
        self.nesting.accept(&command)?;
        let control = match command {
            TraceCommand::Frame(frame) => Control::Frame(Arc::new(self.frame(&frame))),
            TraceCommand::Object(ObjectBegin { id, name, centre, entries, mesh }) => {
                let shading = std::mem::take(&mut self.shading);
                Control::Object(Arc::new(ObjectInfo { id, name, centre, entries, bias: self.bias.take(), shading, mesh }))
            }
            TraceCommand::Polygon(polygon) => Control::Polygon(Arc::new(self.polygon(&polygon)?)),
            TraceCommand::Criterion(Criterion { error_bound }) => Control::Criterion(error_bound),
            TraceCommand::FrameEnd(_) => Control::FrameEnd,
            other => return self.keep(other).map(|()| None),
        };
        self.lent.lend(&control)?;
        Ok(Some(control))
    }

    /// Handles commands that give no token.
    fn keep(&mut self, command: TraceCommand) -> Result<(), CommandFault> {
        match command {
            TraceCommand::Texture(texture) => return self.define_texture(texture),
            TraceCommand::Material(material) => return self.define_material(material),
            TraceCommand::Shading(shading) => self.shading = (&shading).into(),
            TraceCommand::Importance(importance) => self.bias = Some(importance.bias),
            TraceCommand::Expect(expectation) => {
                if self.expectations.len() == MAX_EXPECTATIONS {
                    let message =
                        format!("is one too many, expected at most {MAX_EXPECTATIONS}: `verify` replays the trace for each");
                    return Err(CommandFault::new("", message));
                }
                // Twice, because the caller receives a copy.
                self.held.try_grow(2 * expectation.bytes(), "expectations").map_err(CommandFault::over_budget(""))?;
                self.expectations.push(PlacedExpectation { place: self.reader.place(), results: *expectation });
            }
            _ => {}
        }
        Ok(())
    }

    fn frame(&mut self, frame: &FrameBegin) -> Frame {
        let &BeginCommand { width, height, .. } = self.reader.begin();
        let lights = frame.lights.iter().map(Light::from).collect();
        let (textures, shading) = (std::mem::take(&mut self.declared), std::mem::take(&mut self.shading));
        Frame { index: frame.index, width, height, camera: frame.camera, lights, textures, shading }
    }

    fn polygon(&mut self, polygon: &PolygonRecord) -> Result<Polygon, CommandFault> {
        if is_dented(&polygon.position) {
            let first = self.reader.place();
            self.dented.get_or_insert(DentedPolygons { first, count: 0 }).count += 1;
        }
        let &PolygonRecord { object, lod, bump, arrival, .. } = polygon;
        let material = self.materials.get(&polygon.material).ok_or_else(|| unknown("material", polygon.material))?;
        Ok(Polygon { vertices: vertices(polygon), material: Arc::clone(material), object, lod, bump, arrival })
    }

    fn define_material(&mut self, definition: MaterialDefinition) -> Result<(), CommandFault> {
        if self.materials.contains_key(&definition.id) {
            return Err(twice(definition.id));
        }
        self.held.try_grow(DEFINITION + definition.name.len() as u64, "materials").map_err(CommandFault::over_budget("name"))?;
        let color_texture = self.texture("color_texture", definition.color_texture, TextureKind::Color)?;
        let normal_map = self.texture("normal_map", definition.normal_map, TextureKind::Normal)?;
        let MaterialDefinition { id, name, base_color, normal_scale, lighting, double_sided, .. } = definition;
        let material = Material { id, name, base_color, color_texture, normal_map, normal_scale, lighting, double_sided };
        self.materials.insert(id, Arc::new(material));
        Ok(())
    }

    fn texture(&self, field: &str, id: Option<u32>, kind: TextureKind) -> Result<Option<Arc<Texture>>, CommandFault> {
        let Some(id) = id else { return Ok(None) };
        match self.textures.get(&id) {
            None => Err(unknown(field, id)),
            Some((found, _)) if *found != kind => {
                Err(CommandFault::new(field, format!("is {id}, a texture of the other kind; expected kind {kind:?}")))
            }
            Some((_, texture)) => Ok(Some(Arc::clone(texture))),
        }
    }

    fn define_texture(&mut self, mut definition: TextureDefinition) -> Result<(), CommandFault> {
        if self.textures.contains_key(&definition.id) {
            return Err(twice(definition.id));
        }
        self.held.try_grow(DEFINITION + definition.name.len() as u64, "textures").map_err(CommandFault::over_budget("name"))?;
        let texels = TEXEL * definition.texel_count();
        let copies = (texels + DEFINITION) * self.texture_copies;
        self.held.try_grow(texels + copies, "texels").map_err(CommandFault::over_budget("width"))?;
        let (bytes, _held) = self.texels(&mut definition)?;
        if Digest::of(&bytes) != definition.sha256 {
            let message = format!(
                "is {}, but the texels have {}: they are damaged or not the ones meant",
                definition.sha256,
                Digest::of(&bytes)
            );
            return Err(CommandFault::new("sha256", message));
        }
        let levels = levels(&definition, &bytes);
        drop((bytes, _held));
        let more = texels.saturating_sub(self.copied.bytes());
        self.copied.try_grow(more, "a copy of texels").map_err(CommandFault::over_budget("width"))?;
        let TextureDefinition { id, name, kind, sampler, offset, .. } = definition;
        let texture = Arc::new(Texture { id, name, sampler, levels, offset, elsewhere: None });
        if kind == TextureKind::Color && !self.nesting.in_frame() {
            self.declared.push(Arc::clone(&texture));
        }
        self.textures.insert(id, (kind, texture));
        Ok(())
    }

    /// Returns the texels, as many bytes as the levels need, with their reservation. The reader counts texels inside a command.
    fn texels(&mut self, definition: &mut TextureDefinition) -> Result<(Vec<u8>, MemoryReservation), CommandFault> {
        if let Some(data) = definition.data.take() {
            return Ok((data.0, self.budget.empty_reservation()));
        }
        texels_of_file(definition, &mut self.files, &self.budget)
    }
}

/// Returns the texels of a texture that names their file, with their reservation.
pub(crate) fn texels_of_file(
    definition: &TextureDefinition,
    files: &mut impl TextureFiles,
    budget: &MemoryPool,
) -> Result<(Vec<u8>, MemoryReservation), CommandFault> {
    let name = definition.file.as_deref().unwrap_or_default();
    let expected = definition.texel_count() * definition.kind.texel_bytes();
    let held = budget.try_reserve(expected + 1, "a file of texels").map_err(CommandFault::over_budget("file"))?;
    let mut bytes = Vec::with_capacity(expected as usize + 1);
    let read = files.open(name).and_then(|file| file.take(expected + 1).read_to_end(&mut bytes));
    read.map_err(|e| CommandFault::new("file", format!("cannot read {name:?}: {e}")).of_kind(ErrorKind::Io))?;
    check_length(definition, bytes.len() as u64, "file")?;
    Ok((bytes, held))
}

impl<R: Read, F: TextureFiles> Iterator for TraceResolver<R, F> {
    type Item = Result<(Control, Option<u64>), TraceError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.failed {
            let (name, taken) = match self.reader.next()? {
                Ok(command) => (command.name(), self.take(command)),
                Err(error) => {
                    self.failed = true;
                    return Some(Err(error));
                }
            };
            match taken {
                Ok(None) => {}
                Ok(Some(control)) => {
                    let arrival = if let Control::Polygon(polygon) = &control { Some(polygon.arrival) } else { None };
                    return Some(Ok((control, arrival)));
                }
                Err(fault) => {
                    self.failed = true;
                    return Some(Err(fault.at(self.reader.place(), name)));
                }
            }
        }
        None
    }
}

fn unknown(field: &str, id: u32) -> CommandFault {
    CommandFault::new(field, format!("is {id}, which is not defined; define it before its first use"))
}

fn twice(id: u32) -> CommandFault {
    CommandFault::new("id", format!("is {id}, which is defined already; give each its own number"))
}

fn vertices(polygon: &PolygonRecord) -> Vec<Vertex> {
    let default = Vertex::default();
    let item = |i: usize, &position: &[f32; 4]| Vertex {
        position,
        normal: polygon.normal.get(i).copied().unwrap_or(default.normal),
        tangent: polygon.tangent.get(i).copied().unwrap_or(default.tangent),
        uv: polygon.uv.get(i).copied().unwrap_or(default.uv),
        uv_normal: polygon.uv_normal.get(i).copied().unwrap_or(default.uv_normal),
        color: polygon.color.get(i).copied().unwrap_or(default.color),
        brightness: polygon.brightness.get(i).copied().unwrap_or(default.brightness),
    };
    polygon.position.iter().enumerate().map(|(i, position)| item(i, position)).collect()
}

fn levels(definition: &TextureDefinition, bytes: &[u8]) -> Vec<Image> {
    let mut rest = bytes;
    let level = |(width, height): (u32, u32)| {
        let texels = u64::from(width) * u64::from(height);
        let (own, after) = rest.split_at_checked((texels * definition.kind.texel_bytes()) as usize).unwrap_or((rest, &[]));
        rest = after;
        let texels = match definition.kind {
            TextureKind::Color => own.as_chunks().0.to_vec(),
            TextureKind::Normal => own.as_chunks().0.iter().map(|&[r, g, b]| [r, g, b, u8::MAX]).collect(),
        };
        Image { width, height, texels }
    };
    definition.level_sizes().map(level).collect()
}
