//! The geometry processor (102) and the two sources keep the unit contract.

use basrelief_geometry_processor::{
    BumpConfig, BumpTargets, CommandArrival, DisplayListConfig, DisplayListSource, DisplayListSourceState, GeometryConfig,
    GeometryProcessor, PolygonLink, SceneDraws, SceneSource,
};
use basrelief_kernel::{OperatorConfig, Operators};
use basrelief_kernel_conformance::unit_contract;
use basrelief_signals::{
    Camera, Control, Draw, Frame, Light, LightKind, LightingStage, Material, Mesh, Object, ObjectInfo, Polygon, Scene, Vertex,
    VertexAttributes,
};
use std::sync::Arc;

const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// Perspective of 90 degrees, near 1, far 3.
const PERSPECTIVE: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -2.0, -3.0, 0.0, 0.0, -1.0, 0.0];

/// Returns two frames with two cameras and two kinds of light.
fn frames() -> Vec<Arc<Frame>> {
    let camera = |view_projection| Camera { view_projection, to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let kinds = [LightKind::Directional { to_light: [0.0, 0.6, 0.8] }, LightKind::Point { position: [1.0 / 3.0, 2.0, 0.1] }];
    let frame = |(index, (view, kind))| {
        let lights = vec![Light { kind, intensity: 0.7 }];
        Arc::new(Frame { index, width: 64, height: 48, camera: camera(view), lights, ..Frame::default() })
    };
    (0..).zip([PERSPECTIVE, IDENTITY].into_iter().zip(kinds)).map(frame).collect()
}

/// Creates a strip of triangles that winds through the view volume: visible, culled, cut, outside and degenerate ones.
fn mesh() -> Arc<Mesh> {
    let position = |i: u32| {
        let t = i as f32 / 5.0;
        [1.7 * t - 1.9, if i.is_multiple_of(2) { -0.6 } else { 0.7 }, -0.4 - 1.1 * t + 0.3 * (i % 3) as f32]
    };
    let count = 12;
    let mut indices: Vec<u32> =
        (0..count - 2).flat_map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] }).collect();
    indices.extend([4, 4, 5, 0, 2, 1, 5, 6, 7]);
    Arc::new(Mesh {
        positions: (0..count).map(position).collect(),
        normals: vec![[0.0, 0.0, 1.0]; count as usize],
        indices,
        ..Mesh::default()
    })
}

fn scene() -> Arc<Scene> {
    let object = |id, double_sided, bump| {
        let material = Arc::new(Material { double_sided, ..Material::default() });
        let (name, mesh, entries) = (format!("strip {id}"), mesh(), Some(16));
        Arc::new(Object { id, name, mesh, world: IDENTITY, material, entries, bias: None, bump, shading: Default::default() })
    };
    let objects = vec![object(0, false, None), object(1, true, Some(true)), object(2, true, Some(false))];
    Arc::new(Scene { name: "strips".into(), objects, frames: frames(), warnings: Vec::new() })
}

fn draws() -> Vec<Draw> {
    SceneDraws::new(scene()).collect()
}

#[test]
fn strips_have_every_kind_of_triangle() {
    use basrelief_kernel::{MemoryPorts, Unit};
    let mut unit = unit();
    for draw in draws() {
        unit.step(Some(draw), &mut MemoryPorts::default());
    }
    let c = unit.state.counters;
    let kinds =
        [c.outside, c.culled, c.degenerate, c.clipped, c.bump_polygons, c.polygons - c.bump_polygons, c.vertex_cache_hits];
    assert!(kinds.iter().all(|n| *n > 0), "{c:?}");
    assert_eq!(c.triangles, c.outside + c.culled + c.degenerate + c.polygons);
}

/// Vertex attributes that the bump-mapping processor accepts.
const TAKEN: VertexAttributes = VertexAttributes { lit: LightingStage::Targets, normal_maps: true, textures: true };

fn unit() -> GeometryProcessor {
    let config = GeometryConfig { vertex_cache: 4, two_sided_lighting: true, ..GeometryConfig::default() };
    let operators = Operators { divide: OperatorConfig::new(7, 7), ..Operators::default() };
    GeometryProcessor::new(config, BumpConfig { targets: BumpTargets::All, ..BumpConfig::default() }, TAKEN, operators)
}

unit_contract! {
    name: geometry_processor,
    unit: unit(),
    inputs: draws(),
    state,
}

unit_contract! {
    name: scene_source,
    unit: SceneSource::new(SceneDraws::new(scene())),
    inputs: (),
    state: |unit| unit.state => |unit, state| *unit = SceneSource::resumed(SceneDraws::new(scene()), state),
}

/// Returns a display list whose polygons arrive in time, late, and not at all.
fn display_list() -> Vec<Result<(Control, Option<u64>), String>> {
    let polygon = |arrival| {
        let (vertices, material) = (vec![Vertex::default(); 3], Arc::default());
        Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: true, arrival }))
    };
    let object = ObjectInfo { name: "o".into(), ..ObjectInfo::default() };
    let mut list = vec![(Control::Frame(Arc::clone(&frames()[0])), None), (Control::Object(Arc::new(object)), None)];
    list.extend([40, 44, 44, 90, 3, 91].map(|arrival| (polygon(arrival), Some(arrival))));
    list.push((Control::FrameEnd, None));
    list.into_iter().map(Ok).collect()
}

type Commands = std::vec::IntoIter<Result<(Control, Option<u64>), String>>;

fn replay(arrival: CommandArrival, state: DisplayListSourceState) -> DisplayListSource<Commands> {
    let link = PolygonLink { bytes_per_cycle: 16, taken: TAKEN };
    DisplayListSource::resumed(DisplayListConfig { arrival }, link, display_list().into_iter(), state)
}

unit_contract! {
    name: display_list_source_as_recorded,
    unit: replay(CommandArrival::Recorded, DisplayListSourceState::default()),
    inputs: (),
    state: |unit| unit.state => |unit, state| *unit = replay(CommandArrival::Recorded, state),
}

unit_contract! {
    name: display_list_source_asap,
    unit: replay(CommandArrival::Asap, DisplayListSourceState::default()),
    inputs: (),
    state: |unit| unit.state => |unit, state| *unit = replay(CommandArrival::Asap, state),
}
