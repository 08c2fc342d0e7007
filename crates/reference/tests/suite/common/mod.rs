//! Generated scenes.

use basrelief_signals::{
    Camera, Frame, Image, Light, LightKind, Material, Mesh, Object, ObjectInfo, Polygon, Sampler, Scene, Texture, Vertex,
};
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

pub const IDENTITY: [f64; 16] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];

/// Creates a unit sphere of `rings * 2 * rings * 2` triangles, less those at the poles.
pub fn sphere(rings: u32) -> Mesh {
    let segments = 2 * rings;
    let mut mesh = Mesh::default();
    for (ring, segment) in (0..=rings).flat_map(|ring| (0..=segments).map(move |segment| (ring, segment))) {
        let (u, v) = (f64::from(segment) / f64::from(segments), f64::from(ring) / f64::from(rings));
        let (longitude, latitude) = (u * TAU, v * PI);
        let (sin, cos) = (libm::sin(longitude), libm::cos(longitude));
        let normal = DVec3::new(libm::sin(latitude) * sin, libm::cos(latitude), libm::sin(latitude) * cos);
        mesh.positions.push(normal.as_vec3().to_array());
        mesh.normals.push(normal.as_vec3().to_array());
        mesh.tangents.push([cos as f32, 0.0, -sin as f32, 1.0]);
        mesh.uv.push([3.0 * u as f32, 2.0 * v as f32]);
        mesh.uv_normal.push([4.0 * u as f32, 3.0 * v as f32]);
        mesh.colors.push([1.0, 0.5 + 0.5 * v as f32, 0.75, 1.0]);
    }
    for (ring, segment) in (0..rings).flat_map(|ring| (0..segments).map(move |segment| (ring, segment))) {
        let a = ring * (segments + 1) + segment;
        let b = a + segments + 1;
        if ring > 0 {
            mesh.indices.extend([a, b, a + 1]);
        }
        if ring + 1 < rings {
            mesh.indices.extend([a + 1, b, b + 1]);
        }
    }
    mesh
}

/// Creates a texture of `side` texels with all its levels, each filled by `texel(u, v)` at the texel centres.
pub fn texture(id: u32, side: u32, texel: impl Fn(f64, f64) -> [u8; 3]) -> Arc<Texture> {
    let mut levels = Vec::new();
    let mut size = side;
    while size > 0 {
        let at = |i: u32| ((f64::from(i % size) + 0.5) / f64::from(size), (f64::from(i / size) + 0.5) / f64::from(size));
        let colour = |i| {
            let (u, v) = at(i);
            let [r, g, b] = texel(u, v);
            [r, g, b, 255]
        };
        levels.push(Image { width: size, height: size, texels: (0..size * size).map(colour).collect() });
        size /= 2;
    }
    Arc::new(Texture { id, name: String::new(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

pub fn bumps(side: u32) -> Arc<Texture> {
    texture(1, side, |u, v| {
        let n = DVec3::new(0.5 * libm::sin(TAU * 3.0 * u), 0.5 * libm::cos(TAU * 2.0 * v), 1.0).normalize();
        n.to_array().map(|c| (127.5 * (c + 1.0)).round() as u8)
    })
}

pub fn stripes(side: u32) -> Arc<Texture> {
    texture(0, side, |u, v| [u, v, u * v].map(|c| (127.5 + 120.0 * libm::sin(TAU * c)) as u8))
}

/// Creates a frame: perspective of 40 degrees, from `eye` to the origin, a directional light and a point light.
pub fn frame(width: u32, height: u32, eye: DVec3) -> Frame {
    let back = eye.normalize();
    let right = DVec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let rows = [right, up, back].map(|axis| axis.extend(-axis.dot(eye)));
    let view = DMat4::from_cols(rows[0], rows[1], rows[2], DVec4::W).transpose();
    let (near, far, scale) = (0.5, 20.0, 1.0 / libm::tan(20.0 * PI / 180.0));
    let aspect = f64::from(width) / f64::from(height);
    let projection = DMat4::from_cols(
        DVec4::new(scale / aspect, 0.0, 0.0, 0.0),
        DVec4::new(0.0, scale, 0.0, 0.0),
        DVec4::new(0.0, 0.0, (far + near) / (near - far), -1.0),
        DVec4::new(0.0, 0.0, 2.0 * far * near / (near - far), 0.0),
    );
    let to_light = DVec3::new(0.4, 0.8, 0.45).normalize();
    let camera = Camera {
        view_projection: (projection * view).transpose().to_cols_array(),
        to_light: to_light.to_array(),
        to_viewer: back.to_array(),
    };
    let lights = vec![
        Light { kind: LightKind::Directional { to_light: to_light.as_vec3().to_array() }, intensity: 0.8 },
        Light { kind: LightKind::Point { position: [-4.0, 1.0, 3.0] }, intensity: 0.4 },
    ];
    Frame { index: 0, width, height, camera, lights, textures: Vec::new(), shading: Default::default() }
}

pub fn object(mesh: Mesh, world: [f64; 16], material: Material) -> Arc<Object> {
    let (mesh, material) = (Arc::new(mesh), Arc::new(material));
    Arc::new(Object {
        id: 0,
        name: String::new(),
        mesh,
        world,
        material,
        entries: None,
        bias: None,
        bump: None,
        shading: Default::default(),
    })
}

pub fn scene(objects: Vec<Arc<Object>>) -> Scene {
    Scene { objects, ..Scene::default() }
}

/// Creates the bumpy, striped, shaded sphere.
pub fn bumpy_sphere(rings: u32) -> Scene {
    let material =
        Material { color_texture: Some(stripes(256)), normal_map: Some(bumps(256)), normal_scale: 0.8, ..Material::default() };
    scene(vec![object(sphere(rings), IDENTITY, material)])
}

pub fn row_major(values: &[f64; 16]) -> DMat4 {
    DMat4::from_cols_array(values).transpose()
}

/// Returns the output of a geometry processor for an object that is all in front of the camera and not scaled: window coordinates
/// and attributes in `f32`, back faces left out.
pub fn polygons(object: &Object, frame: &Frame) -> (ObjectInfo, Vec<Polygon>) {
    let world = row_major(&object.world);
    let view_projection = row_major(&frame.camera.view_projection);
    let size = DVec2::new(f64::from(frame.width), f64::from(frame.height));
    let mesh = &object.mesh;
    let vertex = |i: usize| {
        let place = DVec3::from(mesh.positions[i].map(f64::from));
        let clip = view_projection * world.transform_point3(place).extend(1.0);
        let window = DVec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w) * size;
        let [tx, ty, tz, handedness] = mesh.tangents.get(i).map_or([0.0; 4], |tangent| tangent.map(f64::from));
        let turned = |v: DVec3| world.transform_vector3(v).normalize_or_zero();
        Vertex {
            position: [window.x, window.y, 0.5 + 0.5 * clip.z / clip.w, 1.0 / clip.w].map(|c| c as f32),
            normal: turned(DVec3::from(mesh.normals[i].map(f64::from))).as_vec3().to_array(),
            tangent: turned(DVec3::new(tx, ty, tz)).extend(handedness).as_vec4().to_array(),
            uv: mesh.uv.get(i).copied().unwrap_or_default(),
            uv_normal: mesh.uv_normal.get(i).copied().unwrap_or_default(),
            color: mesh.colors.get(i).copied().unwrap_or([1.0; 4]),
            brightness: [1.0, 0.0],
        }
    };
    let polygon = |indices: &[u32]| {
        let vertices: Vec<_> = indices.iter().map(|&i| vertex(i as usize)).collect();
        let material = object.material.clone();
        Polygon { vertices, material, object: object.id, lod: 0, bump: true, arrival: 0 }
    };
    let front = |polygon: &Polygon| {
        let [a, b, c] = [0, 1, 2].map(|k| polygon.vertices[k].position);
        (b[0] - a[0]) * (c[1] - a[1]) < (c[0] - a[0]) * (b[1] - a[1])
    };
    let centre = basrelief_reference::object_centre(object);
    let info = ObjectInfo { id: object.id, centre, ..ObjectInfo::default() };
    (info, mesh.indices.chunks_exact(3).map(polygon).filter(front).collect())
}
