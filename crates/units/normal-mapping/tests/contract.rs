//! The mapping unit (108) keeps the unit contract with each filter.

use basrelief_kernel::Operators;
use basrelief_kernel_conformance::unit_contract;
use basrelief_normal_mapping::{FilterAt, NormalMapping, NormalMappingConfig};
use basrelief_signals::{Control, Flow, Fragment, Image, Material, Polygon, Sampler, Stamp, Texture, Vertex};
use std::sync::Arc;

/// Creates a map of five levels, with 16 texels per side on level 0.
fn bumps() -> Arc<Texture> {
    let image = |k: u32| {
        let n = 16 >> k;
        let texel = |i: u32| [(i % n * 29 + k) as u8, (i / n * 31) as u8, 200, 255];
        Image { width: n, height: n, texels: (0..n * n).map(texel).collect() }
    };
    let levels = (0..5).map(image).collect();
    Arc::new(Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

/// Creates a unit square in the plane z = 0.
fn square(lod: u8, normal_map: Option<Arc<Texture>>) -> Flow<Stamp<Fragment>> {
    let vertex = |u: f32, v: f32| Vertex { tangent: [1.0, 0.0, 0.0, 1.0], uv_normal: [u, v], ..Vertex::default() };
    let vertices = vec![vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(1.0, 1.0), vertex(0.0, 1.0)];
    let material = Arc::new(Material { normal_map, ..Material::default() });
    Flow::Control(Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod, bump: true, arrival: 0 })))
}

/// Returns two polygons, with a map and without.
fn two_polygons() -> Vec<Flow<Stamp<Fragment>>> {
    let at = |i: u16| {
        let (u, v) = (f32::from(i) / 40.0, f32::from(i % 7) / 280.0);
        Fragment { x: 3, y: 4, z: 5, weights: [u - v, v], triangle: 0 }
    };
    let item = |i: u16| Flow::Item((0..=i % 4).map(|k| at(i + k)).collect());
    let mapped = [square(11, Some(bumps()))].into_iter().chain((0..40).map(item));
    let bare = [square(3, None)].into_iter().chain((0..10).map(item));
    mapped.chain(bare).chain([Flow::Control(Control::FrameEnd)]).collect()
}

unit_contract! {
    name: two_levels,
    unit: NormalMapping::new(NormalMappingConfig::default(), &Operators::default(), 2, 4, 64),
    inputs: two_polygons(),
    clients: [ClientKind::Cache { line_bytes: 64 }],
    state,
}

unit_contract! {
    name: filtered_brightness,
    unit: NormalMapping::new(
        NormalMappingConfig { filter_at: FilterAt::Brightness, ..NormalMappingConfig::default() }, &Operators::default(), 2, 4, 16,
    ),
    inputs: two_polygons(),
    clients: [ClientKind::Cache { line_bytes: 16 }],
    state,
}
