//! Building blocks of the demos: curved surfaces, textures, materials.

use crate::camera::{Viewpoint, WorldBounds};
use crate::pyramid::{HeightMap, color_levels, height_levels, normal_levels};
use crate::textures::{TextureContent, TextureStore};
use crate::view::LightOrbit;
use basrelief_signals::MapInline as _;
use basrelief_signals::{Image, Lighting, Material, Mesh, Object, Sampler, ShadingSettings, TexelFilter, Texture, WrapMode};
use basrelief_threads as threads;
use glam::{DMat4, DVec3};
use std::sync::Arc;

/// A demo without view options.
pub(super) struct DemoScene {
    pub objects: Vec<Arc<Object>>,
    pub camera: Viewpoint,
    /// Unit direction.
    pub to_light: DVec3,
    pub frames: u32,
    /// Orbit of the camera \[degrees over all frames\].
    pub orbit: f64,
    pub light_orbit: LightOrbit,
}

/// Returns the camera that frames a box from this azimuth and elevation \[degrees\], with a field of view of 30 degrees.
pub(super) fn framing(low: [f64; 3], high: [f64; 3], azimuth: f64, elevation: f64) -> Viewpoint {
    Viewpoint::framing(&WorldBounds { low: low.into(), high: high.into() }, [azimuth, elevation, 30.0])
}

/// A point of a surface.
pub(super) struct SurfacePoint {
    pub position: DVec3,
    pub normal: DVec3,
    /// Direction of growing u.
    pub tangent: DVec3,
    pub uv: [f64; 2],
}

/// A surface over the unit square: s to the right, t down, as seen from its front; u must grow with s or be mapped
/// without mirroring. A side may be collapsed to a point, as at the poles of a sphere.
pub(super) struct SurfaceGrid {
    pub columns: u32,
    pub rows: u32,
    /// The first row of vertices is a point.
    pub collapsed_top: bool,
    /// The last row of vertices is a point.
    pub collapsed_bottom: bool,
}

impl SurfaceGrid {
    /// No side collapsed.
    pub(super) fn open(columns: u32, rows: u32) -> Self {
        Self { columns, rows, collapsed_top: false, collapsed_bottom: false }
    }

    /// The mesh of a surface.
    pub(super) fn mesh(&self, point: impl Fn(f64, f64) -> SurfacePoint) -> Mesh {
        let mut mesh = Mesh::default();
        for j in 0..=self.rows {
            for i in 0..=self.columns {
                let p = point(f64::from(i) / f64::from(self.columns), f64::from(j) / f64::from(self.rows));
                let t = p.tangent.as_vec3();
                mesh.positions.push(p.position.as_vec3().to_array());
                mesh.normals.push(p.normal.as_vec3().to_array());
                mesh.tangents.push([t.x, t.y, t.z, 1.0]);
                mesh.uv.push(p.uv.map_inline(|c| c as f32));
            }
        }
        mesh.uv_normal = mesh.uv.clone();
        mesh.indices = self.indices();
        mesh
    }

    fn indices(&self) -> Vec<u32> {
        let mut indices = Vec::new();
        for j in 0..self.rows {
            for i in 0..self.columns {
                let a = j * (self.columns + 1) + i;
                let (b, c, d) = (a + self.columns + 1, a + self.columns + 2, a + 1);
                if !(self.collapsed_top && j == 0) {
                    indices.extend([a, b, d]);
                }
                if !(self.collapsed_bottom && j + 1 == self.rows) {
                    indices.extend([d, b, c]);
                }
            }
        }
        indices
    }
}

/// A flat rectangle of two triangles, from its upper left corner as seen from its front. Texture coordinates are `uv[0]`
/// there and `uv[1]` in the opposite corner.
pub(super) fn rectangle(corner: DVec3, right: DVec3, down: DVec3, uv: [[f64; 2]; 2]) -> Mesh {
    let normal = down.cross(right).normalize_or_zero();
    let tangent = right.normalize_or_zero();
    let between = |axis: usize, share: f64| uv[0][axis] + share * (uv[1][axis] - uv[0][axis]);
    SurfaceGrid::open(1, 1).mesh(|s, t| SurfacePoint {
        position: corner + right * s + down * t,
        normal,
        tangent,
        uv: [between(0, s), between(1, t)],
    })
}

/// Texture coordinates of a rectangle that shows its texture once.
pub(super) const WHOLE: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 1.0]];

/// Adds the triangles of another mesh, whose optional arrays are those of the first.
pub(super) fn append(mesh: &mut Mesh, part: Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.indices.extend(part.indices.iter().map(|i| i + first));
    mesh.positions.extend(part.positions);
    mesh.normals.extend(part.normals);
    mesh.tangents.extend(part.tangents);
    mesh.uv.extend(part.uv);
    mesh.uv_normal.extend(part.uv_normal);
}

/// A unit sphere; its poles lie on the y axis, u runs east from -z, v from the north pole to the south pole.
pub(super) fn sphere(columns: u32, rows: u32, tiles: [f64; 2]) -> Mesh {
    let grid = SurfaceGrid { columns, rows, collapsed_top: true, collapsed_bottom: true };
    grid.mesh(|s, t| {
        // A pole is many vertices; each serves the triangle to the left of its column, so it looks half a column west.
        let pole = t == 0.0 || t == 1.0;
        let shift = if t == 0.0 { -0.5 } else { 0.5 } / f64::from(columns);
        let s = if pole { s + shift } else { s };
        let position = direction(s, t);
        let east = direction(s + 0.25, 0.5);
        SurfacePoint { position, normal: position, tangent: east, uv: [s * tiles[0], t * tiles[1]] }
    })
}

/// Direction of a point of a picture of the whole sphere, u and v in 0..=1.
fn direction(u: f64, v: f64) -> DVec3 {
    towards(longitude(u), latitude(v))
}

/// Sine and cosine of a longitude.
fn longitude(u: f64) -> [f64; 2] {
    let angle = u * 2.0 * PI;
    [libm::sin(angle), libm::cos(angle)]
}

/// Radius and height of a circle of latitude.
fn latitude(v: f64) -> [f64; 2] {
    let polar = v * PI;
    // The exact poles would be missed by a rounding error.
    let ring = if v == 0.0 || v == 1.0 { 0.0 } else { libm::sin(polar) };
    [ring, libm::cos(polar)]
}

fn towards([sin, cos]: [f64; 2], [ring, height]: [f64; 2]) -> DVec3 {
    DVec3::new(-ring * sin, height, -ring * cos)
}

/// The texels of a picture of the whole sphere, with sines and cosines computed once per column and row.
pub(super) struct SphereMap {
    pub size: [u32; 2],
    /// Longitude, and direction to the east, which is the same in the whole column.
    columns: Vec<([f64; 2], DVec3)>,
    rows: Vec<[f64; 2]>,
}

impl SphereMap {
    pub(super) fn new(size: [u32; 2]) -> Self {
        let column = |u: f64| (longitude(u), direction(u + 0.25, 0.5));
        let columns = (0..size[0]).map(|i| column(centre(i, size[0]))).collect();
        Self { size, columns, rows: (0..size[1]).map(|i| latitude(centre(i, size[1]))).collect() }
    }

    /// Direction of a texel's centre.
    pub(super) fn direction(&self, [column, row]: [u32; 2]) -> DVec3 {
        towards(self.columns[column as usize].0, self.rows[row as usize])
    }

    /// The unit vector to the east of there.
    pub(super) fn east(&self, [column, _]: [u32; 2]) -> DVec3 {
        self.columns[column as usize].1
    }
}

pub(super) const PI: f64 = std::f64::consts::PI;

/// Makes textures and objects, numbering them.
#[derive(Default)]
pub(super) struct DemoBuilder {
    store: TextureStore,
    materials: u32,
    objects: Vec<Arc<Object>>,
}

impl DemoBuilder {
    /// A repeating normal map from heights over the unit square, `height` texels high.
    pub(super) fn heights(&mut self, name: &str, size: u32, height: f64, at: impl Fn(f64, f64) -> f64 + Sync) -> Arc<Texture> {
        let heights = by_texel([size; 2], |[column, row]| at(centre(column, size), centre(row, size)));
        let wrap = [WrapMode::Repeat; 2];
        let levels = height_levels(HeightMap { width: size, height: size, heights }, height, wrap);
        self.store.add(name, sampler(wrap), TextureContent::Heights(height), levels)
    }

    /// A normal map of the whole sphere from unit tangent-space normals by texel, repeating in u only.
    pub(super) fn globe_normals(&mut self, name: &str, globe: &SphereMap, at: impl Fn([u32; 2]) -> DVec3 + Sync) -> Arc<Texture> {
        let [width, height] = globe.size;
        let texels = by_texel(globe.size, |texel| crate::pyramid::encode_normal(at(texel).to_array()));
        let levels = normal_levels(Image { width, height, texels });
        self.store.add(name, sampler([WrapMode::Repeat, WrapMode::Clamp]), TextureContent::Normals, levels)
    }

    /// A repeating colour texture of the whole sphere, by direction; components 0..=1.
    pub(super) fn globe_colors(&mut self, name: &str, globe: &SphereMap, at: impl Fn(DVec3) -> DVec3 + Sync) -> Arc<Texture> {
        self.colors_as(name, globe.size, [WrapMode::Repeat; 2], |texel| at(globe.direction(texel)))
    }

    /// A repeating colour texture; components 0..=1.
    pub(super) fn colors(&mut self, name: &str, size: [u32; 2], at: impl Fn(f64, f64) -> DVec3 + Sync) -> Arc<Texture> {
        self.colors_as(name, size, [WrapMode::Repeat; 2], |[column, row]| at(centre(column, size[0]), centre(row, size[1])))
    }

    /// A picture that ends at its edges; components 0..=1.
    pub(super) fn picture(&mut self, name: &str, size: [u32; 2], at: impl Fn(f64, f64) -> DVec3 + Sync) -> Arc<Texture> {
        self.colors_as(name, size, [WrapMode::Clamp; 2], |[column, row]| at(centre(column, size[0]), centre(row, size[1])))
    }

    fn colors_as(
        &mut self,
        name: &str,
        size: [u32; 2],
        wrap: [WrapMode; 2],
        at: impl Fn([u32; 2]) -> DVec3 + Sync,
    ) -> Arc<Texture> {
        let texels = by_texel(size, |texel| stored(at(texel)));
        let levels = color_levels(Image { width: size[0], height: size[1], texels });
        self.store.add(name, sampler(wrap), TextureContent::Color, levels)
    }

    /// A material of this colour and these textures.
    pub(super) fn material(
        &mut self,
        name: &str,
        color: [f32; 3],
        color_texture: Option<Arc<Texture>>,
        normal_map: Option<Arc<Texture>>,
    ) -> Arc<Material> {
        let material = self.untextured(name, color);
        Arc::new(Material { color_texture, normal_map, ..material })
    }

    /// Returns a material without textures and with these lighting coefficients.
    pub(super) fn lacquer(&mut self, name: &str, color: [f32; 3], lighting: Lighting) -> Arc<Material> {
        let material = self.untextured(name, color);
        Arc::new(Material { lighting, ..material })
    }

    /// A dull material of this colour, under this texture.
    pub(super) fn dull(&mut self, name: &str, color: [f32; 3], color_texture: Option<Arc<Texture>>) -> Arc<Material> {
        let material = self.untextured(name, color);
        let lighting = Lighting { ka: 0.55, kd: 0.45, ks: 0.0, n: 1.0 };
        Arc::new(Material { color_texture, lighting, ..material })
    }

    fn untextured(&mut self, name: &str, [r, g, b]: [f32; 3]) -> Material {
        let id = self.materials;
        self.materials += 1;
        Material { id, name: name.into(), base_color: [r, g, b, 1.0], ..Material::default() }
    }

    /// Places a mesh in the world, leaving it to the machine how it is drawn.
    pub(super) fn place(&mut self, name: &str, mesh: Mesh, world: DMat4, material: &Arc<Material>) {
        self.place_as(name, mesh, world, material, None, None);
    }

    /// Places a mesh with a fixed number of reference normals or a fixed choice of bump mapping.
    pub(super) fn place_as(
        &mut self,
        name: &str,
        mut mesh: Mesh,
        world: DMat4,
        material: &Arc<Material>,
        entries: Option<u32>,
        bump: Option<bool>,
    ) {
        if material.color_texture.is_none() {
            mesh.uv.clear();
        }
        if material.normal_map.is_none() {
            mesh.uv_normal.clear();
            mesh.tangents.clear();
        }
        self.objects.push(Arc::new(Object {
            id: self.objects.len() as u32,
            name: name.into(),
            mesh: Arc::new(mesh),
            world: crate::camera::rows(world),
            material: material.clone(),
            entries,
            bias: None,
            bump,
            shading: ShadingSettings::default(),
        }));
    }

    /// The finished stage, one frame, under a light from this direction.
    pub(super) fn stage(self, camera: Viewpoint, to_light: [f64; 3]) -> DemoScene {
        let to_light = DVec3::from_array(to_light).normalize_or(DVec3::Y);
        DemoScene { objects: self.objects, camera, to_light, frames: 1, orbit: 0.0, light_orbit: LightOrbit::Degrees(0.0) }
    }
}

fn sampler(wrap: [WrapMode; 2]) -> Sampler {
    Sampler { wrap, filter: TexelFilter::Bilinear }
}

/// A value for each texel, by column and row; row by row.
fn by_texel<T: Clone + Default + Send>([width, height]: [u32; 2], at: impl Fn([u32; 2]) -> T + Sync) -> Vec<T> {
    threads::par_fill_rows(width as usize, height as usize, |row, texels| {
        for (column, texel) in (0..).zip(texels) {
            *texel = at([column, row as u32]);
        }
    })
}

/// Returns the texel of a colour, each component to the nearest of 255 steps. (Without SSE 4.1, `f64::round` is a call.)
fn stored(color: DVec3) -> [u8; 4] {
    let [r, g, b] = (color.clamp(DVec3::ZERO, DVec3::ONE) * 255.0).to_array().map(|steps| {
        let whole = steps as u8;
        whole + u8::from(steps - f64::from(whole) >= 0.5)
    });
    [r, g, b, 255]
}

/// Returns the position of the centre of texel `i` on a side of `size` texels and length 1.
fn centre(i: u32, size: u32) -> f64 {
    (f64::from(i) + 0.5) / f64::from(size)
}
