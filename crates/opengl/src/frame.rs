//! From the dumps of one frame to a scene.

use crate::draw::LEAVE_OUT;
use crate::dump::GlDump;
use crate::fixed::{is_fixed, to_light};
use crate::geometry::{GlGeometry, GlMesh, geometry};
use crate::gltf::{self, GlObject};
use crate::map_value::three;
use crate::mapping::{MapKey, Mapping};
use crate::matrix::{affine, from_normal_matrix, matrix, model_view_of, to_viewer};
use crate::normal_space::use_normal_space;
use crate::picture::{ApplicationPicture, application_picture};
use crate::reader::DrawReader;
use crate::state::{COLOR_MASK, Parameters, draw_state, writes_no_color};
use crate::surface::{GlSurface, surface};
use crate::text::parse;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_reference::TextureFilter;
use basrelief_scene::SceneError;
use basrelief_signals::Camera;
use glam::{DMat4, DVec3};

/// The dump of one draw call.
#[derive(Clone, Copy, Debug)]
pub struct DumpFile<'a> {
    /// Name for messages. Without `draw` in the dump, the number at the end of its stem is the number of the call.
    pub name: &'a str,
    /// Content.
    pub bytes: &'a [u8],
}

/// A frame of an application as a scene.
#[derive(Debug)]
pub struct GlFrame {
    /// The scene: glTF 2.0 with embedded buffers and textures.
    pub gltf: String,
    /// View of the application. The glTF file has none, because its cameras cannot hold every matrix.
    pub camera: Camera,
    /// Width and height of the viewport \[pixels\].
    pub size: [u32; 2],
    /// Picture behind the last draw call, if the dump has it.
    pub application: Option<ApplicationPicture>,
    /// Filter of the application's textures; trilinear if they differ.
    pub filter: TextureFilter,
    /// Choices of the import, one sentence each.
    pub notes: Vec<String>,
    /// Parts that are left out, one sentence each.
    pub warnings: Vec<String>,
    _held: MemoryReservation,
}

/// Imports the draw calls of one frame, in order of drawing.
///
/// # Errors
/// A file that is no dump, state that the devices do not have, or another vertex program than a product of matrices with the position.
/// A mapped name that does not exist, or input over the memory limit. The error names file, call and field.
pub fn import(files: &[DumpFile<'_>], mapping: &Mapping, budget: &MemoryPool) -> Result<GlFrame, SceneError> {
    let mut builder = FrameBuilder { mapping, budget, view: None, objects: Vec::new(), notes: Vec::new(), warnings: Vec::new() };
    let mut held = budget.empty_reservation();
    let (mut application, mut calls) = (None, Vec::new());
    check_distinct(files)?;
    for (number, file) in (1..).zip(files) {
        let (dump, _dump) = parse(file.bytes, budget).map_err(|e| e.in_file(file.name))?;
        let call = dump.draw.as_ref().map(|draw| draw.call).or(number_of(file.name)).unwrap_or(number);
        let at_call = |e: SceneError| in_call(e, call).in_file(file.name);
        calls.push(call);
        held.join(builder.add(&dump, call).map_err(at_call)?);
        if number == files.len() as u64 {
            let viewport = builder.view.as_ref().map_or([0; 4], |view| view.viewport);
            application = application_picture(&dump, viewport, budget).map_err(at_call)?;
        }
    }
    let Some(view) = builder.view else {
        let what = if files.is_empty() { "no draw call is given" } else { "no given draw call writes colours" };
        return Err(SceneError::at("", what).expected("a state dump for each draw call of the frame"));
    };
    mapping.check_calls(&calls)?;
    let filter = filter_of(&builder.objects);
    let (gltf, text) = gltf::write(&builder.objects, budget)?;
    held.join(text);
    let (notes, warnings, size) = (builder.notes, builder.warnings, [view.viewport[2], view.viewport[3]]);
    Ok(GlFrame { gltf, camera: view.camera, size, application, filter, notes, warnings, _held: held })
}

/// Refuses files with equal contents, because the same triangles twice hide each other.
fn check_distinct(files: &[DumpFile<'_>]) -> Result<(), SceneError> {
    let earlier = |number: usize| files[..number].iter().find(|other| other.bytes == files[number].bytes);
    match (1..files.len()).find_map(|number| Some((&files[number], earlier(number)?))) {
        Some((file, other)) => Err(SceneError::at("", format!("has the same content as {}", other.name))
            .expected("one dump for each draw call")
            .cure("name each dump once")
            .in_file(file.name)),
        None => Ok(()),
    }
}

/// Adds the number of the call to the place of an error.
fn in_call(error: SceneError, call: u64) -> SceneError {
    let place = if error.place.is_empty() { format!("call {call}") } else { format!("call {call}: {}", error.place) };
    SceneError { place, ..error }
}

/// Returns the number at the end of the stem of a file name.
fn number_of(name: &str) -> Option<u64> {
    let stem = name.strip_suffix(".json").unwrap_or(name);
    let digits = stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    stem[digits..].parse().ok()
}

/// Returns the filter of the reference image, from glTF's number of a minification filter.
fn filter_of(objects: &[GlObject]) -> TextureFilter {
    let mut filters = objects.iter().flat_map(|object| [&object.surface.albedo, &object.surface.normal_map]).flatten();
    let Some(first) = filters.next().map(|texture| texture.sampler.min_filter) else { return TextureFilter::Trilinear };
    if filters.any(|texture| texture.sampler.min_filter != first) {
        return TextureFilter::Trilinear;
    }
    match first {
        9728 => TextureFilter::Nearest,
        9729 => TextureFilter::Bilinear,
        9984 => TextureFilter::NearestMipNearest,
        9985 => TextureFilter::BilinearMipNearest,
        9986 => TextureFilter::NearestMipLinear,
        _ => TextureFilter::Trilinear,
    }
}

/// View of the first draw call, which all others share.
struct FrameView {
    call: u64,
    /// Number of the frame buffer.
    target: u64,
    viewport: [u32; 4],
    view_projection: DMat4,
    camera: Camera,
    /// No draw call has named a light yet.
    light_is_guess: bool,
}

struct FrameBuilder<'a> {
    mapping: &'a Mapping,
    budget: &'a MemoryPool,
    view: Option<FrameView>,
    objects: Vec<GlObject>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

impl FrameBuilder<'_> {
    /// Adds a draw call as an object. Returns the memory that stays.
    fn add(&mut self, dump: &GlDump, call: u64) -> Result<MemoryReservation, SceneError> {
        let mut reader = DrawReader::new(dump, call, self.mapping, self.budget);
        if writes_no_color(dump) {
            reader.warn(format!("is left out, because it writes no colours ({COLOR_MASK})"));
            self.warnings.extend(reader.warnings);
            return Ok(reader.kept);
        }
        let (state, warnings) = draw_state(dump)?;
        warnings.iter().for_each(|text| reader.warn(text));
        let mut geometry = geometry(&mut reader)?;
        let world = self.world(&mut reader, &geometry, state.viewport)?;
        if state.reversed != (world.determinant() < 0.0) {
            geometry.mesh.indices.as_chunks_mut::<3>().0.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        self.use_light(&mut reader, &geometry, world);
        let mut surface = surface(&mut reader, &geometry.mesh, state.double_sided)?;
        if is_fixed(dump) {
            join_constant_color(&mut geometry.mesh, &mut surface);
        }
        use_normal_space(&mut reader, &mut geometry.mesh, &surface);
        let DrawReader { notes, warnings, kept, .. } = reader;
        self.notes.extend(notes);
        self.warnings.extend(warnings);
        self.objects.push(GlObject { name: format!("call {call}"), mesh: geometry.mesh, world, surface });
        Ok(kept)
    }

    /// Returns the world matrix. The first draw call decides the view.
    fn world(&mut self, reader: &mut DrawReader<'_>, geometry: &GlGeometry, viewport: [u32; 4]) -> Result<DMat4, SceneError> {
        let Some(view) = &self.view else {
            let world = world_of(reader, geometry);
            let view_projection = geometry.mvp * world.inverse();
            let (camera, light_is_guess) = camera(reader, view_projection)?;
            let (call, target) = (reader.call, target(reader));
            self.view = Some(FrameView { call, target, viewport, view_projection, camera, light_is_guess });
            return Ok(world);
        };
        let target = target(reader);
        if view.target != target {
            return Err(SceneError::at("/parameters/GL_DRAW_FRAMEBUFFER_BINDING", format!("is {target}"))
                .expected(format!("{}, as in call {}", view.target, view.call))
                .cure(ONE_PASS));
        }
        if view.viewport != viewport {
            return Err(SceneError::at("/parameters/GL_VIEWPORT", format!("is {viewport:?}"))
                .expected(format!("{:?}, as in call {}", view.viewport, view.call))
                .cure(ONE_PASS));
        }
        affine(view.view_projection.inverse() * geometry.mvp).ok_or_else(|| {
            SceneError::at("/uniforms", "the draw call has another projection")
                .expected(format!("the projection of call {}", view.call))
                .cure(LEAVE_OUT)
        })
    }

    /// Uses the light of the fixed function, unless there is a better one.
    fn use_light(&mut self, reader: &mut DrawReader<'_>, geometry: &GlGeometry, world: DMat4) {
        let Some(view) = self.view.as_mut().filter(|view| view.light_is_guess && is_fixed(reader.dump)) else { return };
        let Some(model_view) = geometry.last.as_ref().map(|(matrix, _)| *matrix) else { return };
        let positions = || geometry.mesh.positions.iter().map(|position| DVec3::from(position.map(f64::from)));
        let [low, high] = [positions().reduce(DVec3::min), positions().reduce(DVec3::max)].map(Option::unwrap_or_default);
        if let Some(light) = to_light(reader, (low + high) / 2.0) {
            let to_light = (world * model_view.inverse()).transform_vector3(light).normalize_or(light);
            (view.camera.to_light, view.light_is_guess) = (to_light.to_array(), false);
        }
    }
}

/// Multiplies the base colour by the colour of all vertices, if they have the same.
fn join_constant_color(mesh: &mut GlMesh, surface: &mut GlSurface) {
    let Some([first, rest @ ..]) = mesh.colors.as_deref() else { return };
    if rest.iter().all(|color| color == first) {
        let factors = surface.base_color.iter_mut().zip(first);
        factors.for_each(|(channel, factor)| *channel *= f64::from(*factor).clamp(0.0, 1.0));
        mesh.colors = None;
    }
}

/// Cure of draw calls that belong to different passes.
const ONE_PASS: &str = "import one pass of the frame: give its dumps to `basrelief import-gl`";

/// Returns the number of the frame buffer that a draw call draws into.
fn target(reader: &DrawReader<'_>) -> u64 {
    Parameters(reader.dump).value("GL_DRAW_FRAMEBUFFER_BINDING").and_then(|value| value.as_u64()).unwrap_or_default()
}

/// Returns the matrix from object to world space: a factor of the product, or the model-view matrix.
fn world_of(reader: &mut DrawReader<'_>, geometry: &GlGeometry) -> DMat4 {
    if let Some((name, world)) = geometry.last.as_ref().and_then(|(last, name)| Some((name, affine(*last)?))) {
        reader.note(format!("world space is behind the matrix {name}"));
        return world;
    }
    let uniforms = reader.dump.uniforms.iter();
    let normal = uniforms.filter(|(name, _)| name.to_ascii_lowercase().contains("normal"));
    let found = normal.filter_map(|(name, value)| Some((name, from_normal_matrix(matrix(value)?)?))).next();
    if let Some((name, world)) = found {
        reader.note(format!("world space is eye space (guessed: inverse transpose of {name})"));
        return world;
    }
    match model_view_of(geometry.mvp).and_then(affine) {
        Some(world) => {
            reader.note("world space is eye space (guessed: mvp without its projection)");
            world
        }
        None => {
            reader.note("world space is object space (guessed)");
            DMat4::IDENTITY
        }
    }
}

/// Returns the view with the directions to light and viewer: mapped, or guessed. The flag is true if nothing names the light.
fn camera(reader: &mut DrawReader<'_>, view_projection: DMat4) -> Result<(Camera, bool), SceneError> {
    let mapped = reader.mapped(MapKey::Viewer).and_then(three);
    let viewer = match mapped.map(DVec3::from).and_then(DVec3::try_normalize) {
        Some(viewer) => viewer,
        None => {
            let viewer = to_viewer(view_projection);
            reader.note(format!("viewer = {} (guessed: against the view axis)", shown(viewer)));
            viewer
        }
    };
    let is_light = |name: &str| name.contains("light") && (name.contains("dir") || name.contains("pos"));
    let light = reader.vector(MapKey::Light, &is_light)?.and_then(|light| DVec3::from(light).try_normalize());
    let is_guess = light.is_none() && reader.mapped(MapKey::Light).is_none();
    if light.is_none() && !is_fixed(reader.dump) {
        reader.note("light = the direction to the viewer (guessed)");
    }
    let camera = Camera {
        view_projection: view_projection.transpose().to_cols_array(),
        to_light: light.unwrap_or(viewer).to_array(),
        to_viewer: viewer.to_array(),
    };
    Ok((camera, is_guess))
}

/// Returns a vector as the mapping takes it.
fn shown(vector: DVec3) -> String {
    // The sum turns -0 into 0.
    let [x, y, z] = (vector * 1e4).round().to_array().map(|number| number / 1e4 + 0.0);
    format!("{x}:{y}:{z}")
}
