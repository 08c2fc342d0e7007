//! Generators of small random scenes and configurations.

use crate::common::settings::{Axis, Settings, choices, choices_and_fifos};
use basrelief_scene::pyramid::{HeightMap, color_levels, height_levels};
use basrelief_signals::{
    Camera, Frame, Image, Light, LightKind, Lighting, Material, Mesh, Object, Sampler, Scene, Texture, WrapMode,
};
use proptest::prelude::*;
use std::sync::Arc;

/// Surface of an object.
#[derive(Clone, Copy, Debug)]
pub enum Surface {
    Plain,
    Textured,
    Mapped,
    MappedAndTextured,
}

/// Mesh of an object.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// A wavy sheet of n x n cells.
    Sheet(u32),
    /// A sheet whose triangles are partly points, lines and doubles.
    Degenerate,
    /// A fan around the viewer's side of the near plane: every triangle is cut.
    Cut,
    /// No triangles at all.
    Nothing,
}

/// An object of a random scene.
#[derive(Clone, Debug)]
pub struct Part {
    pub surface: Surface,
    pub shape: Shape,
    /// Left to right, bottom to top, near to far: 0..=1 each.
    pub at: [f64; 3],
    pub size: f64,
    /// Texels of the map per unit of its own size.
    pub repeat: f32,
    pub entries: Option<u32>,
    pub bump: Option<bool>,
    pub double_sided: bool,
}

/// A random scene.
#[derive(Clone, Debug)]
pub struct SceneRecipe {
    pub parts: Vec<Part>,
    pub size: [u32; 2],
    pub frames: u32,
    pub point_light: bool,
    /// The light moves from frame to frame.
    pub moving: bool,
}

fn part() -> impl Strategy<Value = Part> {
    let surface = prop_oneof![
        3 => Just(Surface::Mapped),
        2 => Just(Surface::MappedAndTextured),
        1 => Just(Surface::Plain),
        1 => Just(Surface::Textured),
    ];
    let shape = prop_oneof![
        4 => (1u32..5).prop_map(Shape::Sheet),
        1 => Just(Shape::Degenerate),
        1 => Just(Shape::Cut),
        1 => Just(Shape::Nothing),
    ];
    let marks =
        (prop::option::weighted(0.3, prop::sample::select(vec![4u32, 16, 64])), prop::option::weighted(0.3, any::<bool>()));
    let place = (prop::array::uniform3(0f64..1.0), 0.2f64..1.5, 0.2f32..12.0);
    (surface, shape, place, marks, any::<bool>()).prop_map(
        |(surface, shape, (at, size, repeat), (entries, bump), double_sided)| Part {
            surface,
            shape,
            at,
            size,
            repeat,
            entries,
            bump,
            double_sided,
        },
    )
}

/// Random scenes.
pub fn scenes() -> impl Strategy<Value = SceneRecipe> {
    (prop::collection::vec(part(), 1..5), [1u32..40, 1u32..30], 1u32..4, any::<bool>(), any::<bool>())
        .prop_map(|(parts, size, frames, point_light, moving)| SceneRecipe { parts, size, frames, point_light, moving })
}

impl SceneRecipe {
    pub fn scene(&self) -> Arc<Scene> {
        let objects = (0..).zip(&self.parts).map(|(id, part)| Arc::new(part.object(id))).collect();
        let frames = (0..self.frames).map(|index| Arc::new(self.frame(index))).collect();
        Arc::new(Scene { name: "random".into(), objects, frames, warnings: Vec::new() })
    }

    fn frame(&self, index: u32) -> Frame {
        let turn = if self.moving { f64::from(index) } else { 0.0 };
        let direction = [0.6 * libm::cos(turn), 0.48, 0.64 - 0.1 * turn];
        let kind = if self.point_light {
            LightKind::Point { position: direction.map(|c| 3.0 * c as f32) }
        } else {
            LightKind::Directional { to_light: direction.map(|c| c as f32) }
        };
        // Perspective, 90 degrees, near 1, far 5.
        let view_projection = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.5, -2.5, 0.0, 0.0, -1.0, 0.0];
        let camera = Camera { view_projection, to_light: direction, to_viewer: [0.0, 0.0, 1.0] };
        let [width, height] = self.size;
        Frame {
            index,
            width,
            height,
            camera,
            lights: vec![Light { kind, intensity: 0.9 }],
            textures: Vec::new(),
            shading: Default::default(),
        }
    }
}

impl Part {
    fn object(&self, id: u32) -> Object {
        let [x, y, z] = self.at;
        let depth = 1.2 + 2.5 * z;
        let (x, y, s) = ((2.0 * x - 1.0) * depth, (2.0 * y - 1.0) * depth, self.size);
        let world = [s, 0.0, 0.0, x, 0.0, s, 0.0, y, 0.0, 0.0, s, -depth, 0.0, 0.0, 0.0, 1.0];
        let mesh = Arc::new(self.shape.mesh(self.repeat));
        let material = Arc::new(self.material(id));
        Object {
            id,
            name: format!("object {id}"),
            mesh,
            world,
            material,
            entries: self.entries,
            bias: None,
            bump: self.bump,
            shading: Default::default(),
        }
    }

    fn material(&self, id: u32) -> Material {
        let (mapped, textured) = match self.surface {
            Surface::Plain => (false, false),
            Surface::Textured => (false, true),
            Surface::Mapped => (true, false),
            Surface::MappedAndTextured => (true, true),
        };
        Material {
            id,
            base_color: [0.9, 0.8, 0.3 + 0.1 * id as f32, 1.0],
            color_texture: textured.then(|| texture(2 * id, checks())),
            normal_map: mapped.then(|| texture(2 * id + 1, bumps())),
            // Two objects in three share their lighting, and so their CLUTs.
            lighting: Lighting { ks: if id % 3 == 2 { 0.2 } else { 0.4 }, ..Lighting::default() },
            double_sided: self.double_sided,
            ..Material::default()
        }
    }
}

impl Shape {
    fn mesh(self, repeat: f32) -> Mesh {
        let cells = match self {
            Self::Sheet(n) => n,
            Self::Degenerate | Self::Cut | Self::Nothing => 2,
        };
        let mut mesh = sheet(cells, repeat);
        match self {
            Self::Sheet(_) => {}
            Self::Degenerate => mesh.indices.extend([0, 0, 0, 0, 1, 0, 0, 4, 8, 0, 1, 4, 0, 1, 4]),
            // Corners come so near that the near plane cuts most triangles.
            Self::Cut => mesh.positions.iter_mut().step_by(2).for_each(|p| p[2] += 4.0),
            Self::Nothing => mesh.indices.clear(),
        }
        mesh
    }
}

/// A wavy sheet of n x n cells from -1 to 1, its front towards +z.
fn sheet(n: u32, repeat: f32) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=n {
        for i in 0..=n {
            let (s, t) = (i as f32 / n as f32, j as f32 / n as f32);
            let slope = 0.4 * (s - 0.5);
            mesh.positions.push([2.0 * s - 1.0, 1.0 - 2.0 * t, -0.2 * (2.0 * s - 1.0) * (2.0 * s - 1.0)]);
            let length = (1.0 + slope * slope).sqrt();
            mesh.normals.push([slope / length, 0.0, 1.0 / length]);
            mesh.tangents.push([1.0 / length, 0.0, -slope / length, 1.0]);
            mesh.uv.push([repeat * s, repeat * t]);
            mesh.uv_normal.push([repeat * s, repeat * t]);
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            mesh.indices.extend([a, a + n + 1, a + 1, a + 1, a + n + 1, a + n + 2]);
        }
    }
    mesh
}

fn texture(id: u32, levels: Vec<Image>) -> Arc<Texture> {
    Arc::new(Texture {
        id,
        name: format!("texture {id}"),
        sampler: Sampler::default(),
        levels,
        offset: 1024 * u64::from(id),
        elsewhere: None,
    })
}

/// A normal map of 16 x 16 texels with its pyramid.
pub fn bumps() -> Vec<Image> {
    let height = |i: u32| f64::from((i * i + 3 * (i / 16) * i) % 17) / 17.0;
    height_levels(HeightMap { width: 16, height: 16, heights: (0..256).map(height).collect() }, 2.0, [WrapMode::Repeat; 2])
}

fn checks() -> Vec<Image> {
    let texel = |i: u32| if (i + i / 8).is_multiple_of(2) { [250, 200, 90, 255] } else { [20, 60, 120, 255] };
    color_levels(Image { width: 8, height: 8, texels: (0..64).map(texel).collect() })
}

/// Parameters that change the work.
const MEANING: &[Axis] = &[
    &[&[], &[("rasterizer.early_z", "false")]],
    &[
        &[],
        &[("brightness.levels", "1")],
        &[("brightness.levels", "3")],
        &[("brightness.levels", "8"), ("memory.normal_map.outstanding", "64")],
        &[("normal_mapping.filter_at", "brightness")],
        &[("normal_mapping.filter_at", "brightness"), ("brightness.levels", "1")],
    ],
    &[
        &[],
        &[("replacement.codebook", "per_polygon")],
        &[("replacement.codebook", "per_object")],
        &[("replacement.codebook", "per_object"), ("replacement.kmeans_iterations", "1")],
    ],
    &[&[], &[("normal_mapping.filter", "nearest")]],
    &[&[], &[("rasterizer.order", "rows")], &[("rasterizer.order", "columns")]],
    &[&[], &[("brightness.components", "separate")], &[("brightness.components", "separate"), ("brightness.bits", "13")]],
    &[&[], &[("brightness.source", "direct")]],
    &[&[], &[("graphics.draw", "after_list")], &[("graphics.draw", "after_list"), ("graphics.held", "normal")]],
    &[&[], &[("graphics.filter", "nearest"), ("graphics.mip", "off")]],
    &[
        &[],
        &[("replacement.entries", "1")],
        &[("replacement.entries", "[256, 128, 64]")],
        &[("replacement.entries", "36"), ("replacement.table", "tetrahedron")],
        &[("replacement.entries", "17"), ("replacement.tables", "identical"), ("replacement.vq_bias", "3")],
    ],
    &[&[], &[("bump.max_lod", "10")], &[("bump.targets", "all")], &[("bump.targets", "all"), ("bump.max_lod", "0")]],
    &[&[], &[("rasterizer.z_bits", "16"), ("rasterizer.block", "3"), ("rasterizer.subpixel_bits", "4")]],
    &[&[], &[("normal_mapping.normal_bits", "9"), ("replacement.entry_bits", "10"), ("normal_mapping.texel_bytes", "3")]],
];

/// Parameters that change only the timing. They must not change a picture.
const TIMING: &[Axis] = &[
    &[&[], &[("texture.layout", "linear")], &[("texture.layout", "blocked_6d"), ("texture.superblock", "8")]],
    &[
        &[],
        &[("display.enabled", "false")],
        &[("display.pixel_hz", "4000000"), ("display.burst_bytes", "100")],
        &[("display.mode", "fifo"), ("display.pixel_hz", "9000000"), ("display.refresh_hz", "9000"), ("display.buffers", "3")],
    ],
    &[
        &[],
        &[("replacement.lanes", "4"), ("replacement.pipelined", "true")],
        &[("replacement.lanes", "9")],
        &[("replacement.lanes", "65536")],
        &[("operators.multiply.latency", "40"), ("operators.add.interval", "3"), ("operators.power.interval", "1")],
    ],
    &[&[], &[("replacement.resident_tables", "1"), ("replacement.load_bytes", "100")]],
    &[
        &[],
        &[("geometry.multipliers", "1"), ("geometry.dividers", "1"), ("geometry.vertex_cache", "0")],
        &[("geometry.fetch_bytes_per_cycle", "1"), ("geometry.powers", "64")],
        &[("geometry.link_bytes", "1"), ("operators.divide.latency", "90")],
    ],
    &[
        &[],
        &[("rasterizer.multipliers", "1"), ("rasterizer.dividers", "2"), ("depth.flags", "7")],
        &[("operators.multiply.latency", "1"), ("operators.add.latency", "1"), ("operators.divide.interval", "1")],
    ],
    &[&[], &[("normal_mapping.dividers", "1"), ("graphics.multipliers", "5")], &[("normal_mapping.multipliers", "11")]],
    &[&[], &[("brightness.sets", "1"), ("brightness.samples_per_cycle", "1"), ("brightness.multipliers", "64")]],
    &[
        &[],
        &[("memory.graphics.part", "ideal")],
        &[("memory.graphics.part", "fpm-80"), ("memory.graphics.channels", "3"), ("memory.graphics.window", "2")],
        &[("memory.graphics.part", "gddr3-1400"), ("memory.graphics.cap", "0"), ("memory.graphics.refi", "200")],
    ],
    &[&[], &[("memory.normal_map.banks", "1"), ("memory.normal_map.burst_bytes", "16"), ("memory.normal_map.cl", "40")]],
    &[&[], &[("memory.quantization.outstanding", "64"), ("memory.quantization.burst_cycles", "9")]],
    &[
        &[],
        &[("memory.graphics.outstanding", "8"), ("memory.graphics.row_bytes", "512"), ("memory.graphics.rp", "60")],
        &[("memory.graphics.burst_bytes", "256"), ("memory.graphics.burst_cycles", "1"), ("memory.graphics.cl", "0")],
    ],
    &[&[], &[("cache.normal_map.sets", "1"), ("cache.normal_map.ways", "1"), ("cache.normal_map.lookups_per_cycle", "1")]],
    &[&[], &[("cache.clut.line_bytes", "8"), ("cache.clut.sets", "3"), ("cache.clut.hit_latency", "20")]],
    &[&[], &[("cache.color_texture.sets", "1"), ("cache.color_texture.ways", "2"), ("cache.color_texture.line_bytes", "16")]],
    &[
        &[],
        &[("cache.depth.sets", "1"), ("cache.depth.ways", "1"), ("cache.depth.line_bytes", "256")],
        &[("cache.depth.line_bytes", "16"), ("depth.clear_flags", "false"), ("frame_buffer.clear_flags", "false")],
    ],
    &[&[], &[("frame_buffer.write_lines", "1"), ("depth.write_lines", "3")], &[("frame_buffer.write_lines", "64")]],
];

/// FIFOs of the machine.
const FIFOS: [&str; 11] = [
    "draws",
    "polygons",
    "fragments",
    "tested_fragments",
    "bump_fragments",
    "plain_fragments",
    "pseudo_normals",
    "indexes",
    "shaded",
    "pixels",
    "tested_pixels",
];

/// Random settings that change the work.
pub fn meanings() -> impl Strategy<Value = Settings> {
    choices(MEANING)
}

/// Random settings that change only the timing: operators, memories, caches, and FIFOs from 1 slot.
pub fn timings() -> impl Strategy<Value = Settings> {
    choices_and_fifos(TIMING, &FIFOS)
}
