//! From commands to what travels on the wires.

use crate::check::check_length;
use crate::command::*;
use crate::data::Digest;
use crate::error::{ErrorKind, Fault, TraceError};
use crate::reader::{Reader, open};
use crate::sequence::Nesting;
use basrelief_signals::{Control, Frame, Image, Light, Material, ObjectInfo, Polygon, Texture, Vertex};
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::sync::Arc;

/// Most texels of all textures together \[bytes, 4 per texel\].
const TEXTURE_MEMORY: u64 = 1 << 30;
/// Most materials: far above what scenes have, and a bound on what a small compressed file can make us hold.
const MAX_MATERIALS: usize = 1 << 16;

/// Opens the files beside a trace that hold texels. Names are relative, have `/` between their parts and no `..`.
pub trait Files {
    /// Opens a file.
    ///
    /// # Errors
    /// If there is no such file, or it cannot be read.
    fn open(&mut self, name: &str) -> io::Result<Box<dyn Read>>;
}

impl<F: FnMut(&str) -> io::Result<Box<dyn Read>>> Files for F {
    fn open(&mut self, name: &str) -> io::Result<Box<dyn Read>> {
        self(name)
    }
}

/// Files of a trace that stands alone, such as one on standard input: there are none.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl Files for NoFiles {
    fn open(&mut self, _: &str) -> io::Result<Box<dyn Read>> {
        Err(io::Error::new(io::ErrorKind::NotFound, "this trace is read without a folder to look in"))
    }
}

/// Checks a trace and turns its commands into control tokens, each with the cycle of its arrival (polygons only).
///
/// Iterate to the end: only then is it known that the trace is whole, and are all [expectations](Self::expectations)
/// there. Textures and materials are kept, and shared by the polygons that use them; polygons are not.
pub struct Resolver<R: Read, F> {
    reader: Reader<R>,
    files: F,
    nesting: Nesting,
    textures: BTreeMap<u32, (TextureKind, Arc<Texture>)>,
    texture_memory: u64,
    /// Colour textures defined ahead of the next frame: it declares them.
    declared: Vec<Arc<Texture>>,
    materials: BTreeMap<u32, Arc<Material>>,
    expectations: Vec<Expectation>,
    failed: bool,
}

impl<R: Read, F: Files> Resolver<R, F> {
    /// Opens a trace of any form.
    ///
    /// # Errors
    /// As [`open`].
    pub fn new(reader: R, files: F) -> Result<Self, TraceError> {
        Ok(Self {
            reader: open(reader)?,
            files,
            nesting: Nesting::default(),
            textures: BTreeMap::new(),
            texture_memory: 0,
            declared: Vec::new(),
            materials: BTreeMap::new(),
            expectations: Vec::new(),
            failed: false,
        })
    }

    /// Size of the pictures, and what made the trace.
    pub fn begin(&self) -> &Begin {
        self.reader.begin()
    }

    /// Expectations read so far; all of them once the iteration has ended.
    pub fn expectations(&self) -> &[Expectation] {
        &self.expectations
    }

    fn take(&mut self, command: Command) -> Result<Option<Control>, Fault> {
        self.nesting.accept(&command)?;
        let control = match command {
            Command::Frame(frame) => Control::Frame(Arc::new(self.frame(&frame))),
            Command::Object(ObjectBegin { id, name, centre, entries }) => {
                Control::Object(Arc::new(ObjectInfo { id, name, centre, entries }))
            }
            Command::Polygon(polygon) => Control::Polygon(Arc::new(self.polygon(&polygon)?)),
            Command::FrameEnd(_) => Control::FrameEnd,
            other => return self.keep(other).map(|()| None),
        };
        Ok(Some(control))
    }

    /// Commands that put nothing on a wire.
    fn keep(&mut self, command: Command) -> Result<(), Fault> {
        match command {
            Command::Texture(texture) => return self.define_texture(texture),
            Command::Material(material) => return self.define_material(material),
            Command::Expect(expectation) => self.expectations.push(*expectation),
            _ => {}
        }
        Ok(())
    }

    fn frame(&mut self, frame: &FrameBegin) -> Frame {
        let &Begin { width, height, .. } = self.reader.begin();
        let lights = frame.lights.iter().map(Light::from).collect();
        Frame { index: frame.index, width, height, camera: frame.camera, lights, textures: std::mem::take(&mut self.declared) }
    }

    fn polygon(&self, polygon: &PolygonRecord) -> Result<Polygon, Fault> {
        let &PolygonRecord { object, lod, bump, arrival, .. } = polygon;
        let material = self.materials.get(&polygon.material).ok_or_else(|| unknown("material", polygon.material))?;
        Ok(Polygon { vertices: vertices(polygon), material: Arc::clone(material), object, lod, bump, arrival })
    }

    fn define_material(&mut self, definition: MaterialDefinition) -> Result<(), Fault> {
        if self.materials.contains_key(&definition.id) {
            return Err(twice(definition.id));
        }
        if self.materials.len() >= MAX_MATERIALS {
            return Err(Fault::new("id", format!("is the number of one more than {MAX_MATERIALS} materials")));
        }
        let color_texture = self.texture("color_texture", definition.color_texture, TextureKind::Color)?;
        let normal_map = self.texture("normal_map", definition.normal_map, TextureKind::Normal)?;
        let MaterialDefinition { id, name, base_color, normal_scale, lighting, double_sided, .. } = definition;
        let material = Material { id, name, base_color, color_texture, normal_map, normal_scale, lighting, double_sided };
        self.materials.insert(id, Arc::new(material));
        Ok(())
    }

    fn texture(&self, field: &str, id: Option<u32>, kind: TextureKind) -> Result<Option<Arc<Texture>>, Fault> {
        let Some(id) = id else { return Ok(None) };
        match self.textures.get(&id) {
            None => Err(unknown(field, id)),
            Some((found, _)) if *found != kind => {
                Err(Fault::new(field, format!("is {id}, a texture of the other kind; expected kind {kind:?}")))
            }
            Some((_, texture)) => Ok(Some(Arc::clone(texture))),
        }
    }

    fn define_texture(&mut self, mut definition: TextureDefinition) -> Result<(), Fault> {
        if self.textures.contains_key(&definition.id) {
            return Err(twice(definition.id));
        }
        self.texture_memory += definition.texel_count() * 4;
        if self.texture_memory > TEXTURE_MEMORY {
            let limit = TEXTURE_MEMORY >> 20;
            return Err(Fault::new("width", format!("makes all textures larger than {limit} MiB together: use smaller ones")));
        }
        let bytes = self.texels(&mut definition)?;
        if Digest::of(&bytes) != definition.sha256 {
            let message = format!(
                "is {}, but the texels have {}: they are damaged or not the ones meant",
                definition.sha256,
                Digest::of(&bytes)
            );
            return Err(Fault::new("sha256", message));
        }
        let levels = levels(&definition, &bytes);
        let TextureDefinition { id, name, kind, sampler, offset, .. } = definition;
        let texture = Arc::new(Texture { id, name, sampler, levels, offset });
        if kind == TextureKind::Color && !self.nesting.in_frame() {
            self.declared.push(Arc::clone(&texture));
        }
        self.textures.insert(id, (kind, texture));
        Ok(())
    }

    /// The texels' bytes, as many as the levels need.
    fn texels(&mut self, definition: &mut TextureDefinition) -> Result<Vec<u8>, Fault> {
        if let Some(data) = definition.data.take() {
            return Ok(data.0);
        }
        let name = definition.file.as_deref().unwrap_or_default();
        let mut bytes = Vec::new();
        let expected = definition.texel_count() * definition.kind.texel_bytes();
        let read = self.files.open(name).and_then(|file| file.take(expected + 1).read_to_end(&mut bytes));
        read.map_err(|e| Fault::new("file", format!("cannot read {name:?}: {e}")).of_kind(ErrorKind::Io))?;
        check_length(definition, bytes.len() as u64, "file")?;
        Ok(bytes)
    }
}

impl<R: Read, F: Files> Iterator for Resolver<R, F> {
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

fn unknown(field: &str, id: u32) -> Fault {
    Fault::new(field, format!("is {id}, which is not defined; define it before its first use"))
}

fn twice(id: u32) -> Fault {
    Fault::new("id", format!("is {id}, which is defined already; give each its own number"))
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
