//! Recording of tokens as commands.

use crate::command::*;
use crate::data::{Digest, Texels};
use crate::error::{CommandFault, TraceError, TracePlace};
use crate::form::TraceForm;
use crate::sequence::FrameNesting;
use crate::writer::TraceWriter;
use basrelief_signals::{Control, Frame, Material, ObjectInfo, Polygon, ShadingSettings, Texture, Vertex};
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;

/// Texels of a normal map that are repacked at a time.
const PIECE_TEXELS: usize = 1024;

/// Records control tokens as a trace. [Reading](crate::TraceResolver) it gives equal tokens.
pub struct TraceRecorder<W: Write> {
    writer: TraceWriter<W>,
    describer: CommandBuilder,
}

impl<W: Write> TraceRecorder<W> {
    /// Opens a trace of this form and writes `begin`.
    ///
    /// # Errors
    /// A failed write, a value of `begin` that is not allowed, or a form that this build lacks.
    pub fn new(writer: W, form: TraceForm, begin: BeginCommand) -> Result<Self, TraceError> {
        let mut writer = TraceWriter::new(writer, form)?;
        let describer = CommandBuilder::new(&begin, TexelUse::Inline);
        writer.write(&TraceCommand::Begin(begin))?;
        Ok(Self { writer, describer })
    }

    /// Records a token. Textures that a frame declares are defined ahead of it, other textures and materials ahead of their
    /// first use.
    ///
    /// # Errors
    /// A token that belongs to no display list or is out of order, a value that a trace cannot hold, or a failed write.
    pub fn record(&mut self, control: &Control) -> Result<(), TraceError> {
        let Self { writer, describer } = self;
        describer.describe(control, &mut |command| writer.write(command))
    }

    /// Number of commands so far.
    pub fn commands(&self) -> u64 {
        self.writer.count()
    }

    /// Writes the expectations and `end`; gives the writer back.
    ///
    /// # Errors
    /// If a frame is open or none was recorded, or the writer below fails.
    pub fn finish(mut self, expectations: Vec<ExpectedResults>) -> Result<W, TraceError> {
        for expectation in expectations {
            self.writer.write(&TraceCommand::Expect(Box::new(expectation)))?;
        }
        let end = TraceCommand::End(EndCommand { commands: self.writer.count() });
        let place = TracePlace::Command(self.writer.count() + 1);
        self.describer.nesting.accept(&end).map_err(|fault| fault.at(place, end.name()))?;
        self.writer.write(&end)?;
        self.writer.finish()
    }
}

/// Part that a texture's definition has of its texels.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum TexelUse {
    /// The texels and their digest.
    Inline,
    /// The digest alone.
    DigestOnly,
}

/// Turns control tokens into commands. Defines textures and materials at their first use.
pub(crate) struct CommandBuilder {
    width: u32,
    height: u32,
    texels: TexelUse,
    nesting: FrameNesting,
    count: u64,
    textures: BTreeMap<u32, (TextureKind, Arc<Texture>)>,
    materials: BTreeMap<u32, Arc<Material>>,
}

pub(crate) type CommandSink<'a> = dyn FnMut(&TraceCommand) -> Result<(), TraceError> + 'a;

impl CommandBuilder {
    pub(crate) fn new(begin: &BeginCommand, texels: TexelUse) -> Self {
        Self {
            width: begin.width,
            height: begin.height,
            texels,
            nesting: FrameNesting::default(),
            count: 1,
            textures: BTreeMap::new(),
            materials: BTreeMap::new(),
        }
    }

    pub(crate) fn describe(&mut self, control: &Control, emit: &mut CommandSink<'_>) -> Result<(), TraceError> {
        let command = match control {
            Control::Frame(frame) => {
                frame.textures.iter().try_for_each(|texture| self.define_texture(TextureKind::Color, texture, emit))?;
                let begin = TraceCommand::Frame(self.frame(frame)?);
                self.shading(frame.shading, emit)?;
                begin
            }
            Control::Object(object) => {
                self.shading(object.shading, emit)?;
                if let Some(bias) = object.bias {
                    self.emit(&TraceCommand::Importance(ImportanceWeights { bias }), emit)?;
                }
                TraceCommand::Object(object_begin(object))
            }
            Control::Polygon(polygon) => {
                self.define_material(&polygon.material, emit)?;
                TraceCommand::Polygon(polygon_record(polygon))
            }
            Control::Criterion(error_bound) => TraceCommand::Criterion(Criterion { error_bound: *error_bound }),
            Control::FrameEnd => TraceCommand::FrameEnd(FrameEnd {}),
            Control::CodeBook(_) => {
                let fault = CommandFault::new("", "is made behind the geometry processor and belongs in no display list");
                return Err(self.error(fault, "code book"));
            }
        };
        self.emit(&command, emit)
    }

    /// Writes `shading` ahead of its frame or object, unless it is empty.
    fn shading(&mut self, shading: ShadingSettings, emit: &mut CommandSink<'_>) -> Result<(), TraceError> {
        if shading == ShadingSettings::default() {
            return Ok(());
        }
        self.emit(&TraceCommand::Shading(shading.into()), emit)
    }

    fn emit(&mut self, command: &TraceCommand, emit: &mut CommandSink<'_>) -> Result<(), TraceError> {
        self.nesting.accept(command).map_err(|fault| self.error(fault, command.name()))?;
        self.count += 1;
        emit(command)
    }

    fn error(&self, fault: CommandFault, name: &str) -> TraceError {
        fault.at(TracePlace::Command(self.count + 1), name)
    }

    fn frame(&self, frame: &Frame) -> Result<FrameBegin, TraceError> {
        if (frame.width, frame.height) != (self.width, self.height) {
            let Self { width, height, .. } = self;
            let message = format!("is {} x {}, expected {width} x {height} as in `begin`", frame.width, frame.height);
            return Err(self.error(CommandFault::new("size", message), "frame"));
        }
        let lights = frame.lights.iter().map(LightRecord::from).collect();
        Ok(FrameBegin { index: frame.index, camera: frame.camera, lights })
    }

    fn define_material(&mut self, material: &Arc<Material>, emit: &mut CommandSink<'_>) -> Result<(), TraceError> {
        if let Some(known) = self.materials.get(&material.id) {
            return same(known, material).map_err(|fault| self.error(fault, "material"));
        }
        for (kind, texture) in [(TextureKind::Color, &material.color_texture), (TextureKind::Normal, &material.normal_map)] {
            if let Some(texture) = texture {
                self.define_texture(kind, texture, emit)?;
            }
        }
        self.emit(&TraceCommand::Material(material_definition(material)), emit)?;
        self.materials.insert(material.id, Arc::clone(material));
        Ok(())
    }

    fn define_texture(
        &mut self,
        kind: TextureKind,
        texture: &Arc<Texture>,
        emit: &mut CommandSink<'_>,
    ) -> Result<(), TraceError> {
        if let Some((known_kind, known)) = self.textures.get(&texture.id) {
            let known = if *known_kind == kind { same(known, texture) } else { Err(two_uses(texture.id)) };
            return known.map_err(|fault| self.error(fault, "texture"));
        }
        let definition = texture_definition(kind, texture, self.texels).map_err(|fault| self.error(fault, "texture"))?;
        self.emit(&TraceCommand::Texture(definition), emit)?;
        self.textures.insert(texture.id, (kind, Arc::clone(texture)));
        Ok(())
    }
}

/// Returns true if two definitions of one number are equal. Usually they are the same place in memory, which is cheap to test.
fn same<T: PartialEq + NumberedItem>(known: &Arc<T>, found: &Arc<T>) -> Result<(), CommandFault> {
    if Arc::ptr_eq(known, found) || known == found {
        return Ok(());
    }
    Err(CommandFault::new("id", format!("is {}, the number of a different one before; give each its own", found.number())))
}

trait NumberedItem {
    fn number(&self) -> u32;
}

impl NumberedItem for Material {
    fn number(&self) -> u32 {
        self.id
    }
}

impl NumberedItem for Texture {
    fn number(&self) -> u32 {
        self.id
    }
}

fn two_uses(id: u32) -> CommandFault {
    CommandFault::new("kind", format!("texture {id} is used as colour and as normal map; give each use a texture of its own"))
}

fn texture_definition(kind: TextureKind, texture: &Texture, texels: TexelUse) -> Result<TextureDefinition, CommandFault> {
    let first = texture.levels.first().ok_or_else(|| CommandFault::new("levels", "is 0, expected at least one level"))?;
    let mut definition = TextureDefinition {
        id: texture.id,
        name: texture.name.clone(),
        kind,
        sampler: texture.sampler,
        width: first.width,
        height: first.height,
        levels: texture.levels.len() as u32,
        offset: texture.offset,
        sha256: Digest::default(),
        data: None,
        file: None,
    };
    if let Some(elsewhere) = texture.elsewhere {
        definition.sha256 = Digest(elsewhere);
        return Ok(definition);
    }
    check_levels(&definition, texture)?;
    match texels {
        TexelUse::Inline => {
            // Exactly as much as it takes: grown by doubling, it would take up to twice that.
            let mut bytes = Vec::with_capacity((definition.texel_count() * kind.texel_bytes()) as usize);
            each_piece(kind, texture, |piece| bytes.extend_from_slice(piece));
            definition.sha256 = Digest::of(&bytes);
            definition.data = Some(Texels(bytes));
        }
        TexelUse::DigestOnly => definition.sha256 = Digest::of_pieces(|take| each_piece(kind, texture, take)),
    }
    Ok(definition)
}

fn check_levels(definition: &TextureDefinition, texture: &Texture) -> Result<(), CommandFault> {
    for (k, (level, size)) in texture.levels.iter().zip(definition.level_sizes()).enumerate() {
        let texels = u64::from(level.width) * u64::from(level.height);
        if (level.width, level.height) != size || level.texels.len() as u64 != texels {
            let (width, height, count) = (level.width, level.height, level.texels.len());
            let message = format!("is {width} x {height} with {count} texels, expected {} x {}", size.0, size.1);
            return Err(CommandFault::new(format!("levels[{k}]"), message));
        }
        if definition.kind == TextureKind::Normal && level.texels.iter().any(|texel| texel[3] != u8::MAX) {
            return Err(CommandFault::new(format!("levels[{k}]"), "is of a normal map and has alpha; expected 255 throughout"));
        }
    }
    Ok(())
}

/// Calls `take` with the bytes of all texels, in pieces.
fn each_piece(kind: TextureKind, texture: &Texture, mut take: impl FnMut(&[u8])) {
    for level in &texture.levels {
        match kind {
            TextureKind::Color => take(level.texels.as_flattened()),
            TextureKind::Normal => {
                let mut piece = [[0; 3]; PIECE_TEXELS];
                for texels in level.texels.chunks(PIECE_TEXELS) {
                    piece.iter_mut().zip(texels).for_each(|(to, &[r, g, b, _])| *to = [r, g, b]);
                    take(piece[..texels.len()].as_flattened());
                }
            }
        }
    }
}

fn material_definition(material: &Material) -> MaterialDefinition {
    let number = |texture: &Option<Arc<Texture>>| texture.as_ref().map(|texture| texture.id);
    MaterialDefinition {
        id: material.id,
        name: material.name.clone(),
        base_color: material.base_color,
        normal_scale: material.normal_scale,
        lighting: material.lighting,
        color_texture: number(&material.color_texture),
        normal_map: number(&material.normal_map),
        double_sided: material.double_sided,
    }
}

fn object_begin(object: &ObjectInfo) -> ObjectBegin {
    ObjectBegin { id: object.id, name: object.name.clone(), centre: object.centre, entries: object.entries, mesh: object.mesh }
}

fn polygon_record(polygon: &Polygon) -> PolygonRecord {
    let vertices = &polygon.vertices;
    PolygonRecord {
        object: polygon.object,
        material: polygon.material.id,
        lod: polygon.lod,
        bump: polygon.bump,
        arrival: polygon.arrival,
        position: vertices.iter().map(|v| v.position).collect(),
        normal: attribute(vertices, |v| v.normal),
        tangent: attribute(vertices, |v| v.tangent),
        uv: attribute(vertices, |v| v.uv),
        uv_normal: attribute(vertices, |v| v.uv_normal),
        color: attribute(vertices, |v| v.color),
        brightness: attribute(vertices, |v| v.brightness),
    }
}

/// Returns an empty list if every vertex has the default. Compared by bits: -0 is not 0.
fn attribute<const N: usize>(vertices: &[Vertex], of: impl Fn(&Vertex) -> [f32; N]) -> Vec<[f32; N]> {
    let default = of(&Vertex::default()).map(f32::to_bits);
    if vertices.iter().all(|v| of(v).map(f32::to_bits) == default) {
        return Vec::new();
    }
    vertices.iter().map(of).collect()
}
