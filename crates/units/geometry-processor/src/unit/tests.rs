use super::*;
use crate::config::{CommandArrival, DisplayListConfig};
use crate::{DisplayListSource, PolygonLink};
use basrelief_kernel::OperatorConfig;
use basrelief_signals::{Camera, Image, Light, LightKind, Lighting, LightingStage, Material, Mesh, Sampler, Texture};
use proptest::prelude::*;

const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
const MIRROR: [f64; 16] = [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// Perspective of 90 degrees, near 1, far 3.
const PERSPECTIVE: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -2.0, -3.0, 0.0, 0.0, -1.0, 0.0];

fn frame(view_projection: [f64; 16]) -> Draw {
    let camera = Camera { view_projection, to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let lights = vec![Light { kind: LightKind::Directional { to_light: [0.0, 0.0, 1.0] }, intensity: 1.0 }];
    Draw::Frame(Arc::new(Frame { width: 64, height: 32, camera, lights, ..Frame::default() }))
}

fn texture(side: u32) -> Arc<Texture> {
    let levels = vec![Image { width: side, height: side, texels: vec![[0; 4]; (side * side) as usize] }];
    Arc::new(Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

/// Creates a triangle that faces +z.
fn mesh() -> Mesh {
    Mesh {
        positions: vec![[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]],
        normals: vec![[0.0, 0.0, 1.0]; 3],
        uv: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
        uv_normal: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
        indices: vec![0, 1, 2],
        ..Mesh::default()
    }
}

fn object(mesh: Mesh, world: [f64; 16], material: Material, bump: Option<bool>) -> Draw {
    let (mesh, material) = (Arc::new(mesh), Arc::new(material));
    Draw::Object(Arc::new(Object {
        id: 5,
        name: "o".into(),
        mesh,
        world,
        material,
        entries: Some(64),
        bias: None,
        bump,
        shading: Default::default(),
    }))
}

/// Vertex attributes that the bump-mapping processor accepts.
const TAKEN: VertexAttributes = VertexAttributes { lit: LightingStage::Targets, normal_maps: true, textures: true };

/// Creates a unit whose operators take one cycle each, except division, root and power.
fn unit(config: GeometryConfig, bump: BumpConfig) -> GeometryProcessor {
    let slow = |cycles| OperatorConfig::new(cycles, cycles);
    let operators = Operators { divide: slow(7), square_root: slow(7), power: slow(40), ..Operators::default() };
    GeometryProcessor::new(config, bump, TAKEN, operators)
}

fn step(unit: &mut GeometryProcessor, draw: Draw) -> Step<Option<Control>> {
    unit.step(Some(draw), &mut MemoryPorts::default())
}

fn polygon(unit: &mut GeometryProcessor, draws: [Draw; 2]) -> Option<Arc<Polygon>> {
    for draw in draws {
        step(unit, draw);
    }
    match step(unit, Draw::Triangle(0)).out {
        Some(Control::Polygon(polygon)) => Some(polygon),
        None => None,
        other => panic!("{other:?}"),
    }
}

fn drawn(bump: BumpConfig, draws: [Draw; 2]) -> Option<Arc<Polygon>> {
    polygon(&mut unit(GeometryConfig::default(), bump), draws)
}

#[test]
fn triangle_has_window_coordinates_with_y_down() {
    let draws = [frame(IDENTITY), object(mesh(), IDENTITY, Material::default(), None)];
    let polygon = drawn(BumpConfig::default(), draws).expect("visible");
    let positions: Vec<_> = polygon.vertices.iter().map(|v| v.position).collect();
    assert_eq!(positions, [[32.0, 16.0, 0.5, 1.0], [48.0, 16.0, 0.5, 1.0], [32.0, 8.0, 0.5, 1.0]]);
    assert_eq!((polygon.object, polygon.lod, polygon.bump), (5, 0, false));
    let lighting = Material::default().lighting;
    let lit = [lighting.ka + lighting.kd, lighting.ks];
    assert_eq!(polygon.vertices[0].brightness, lit, "no bump target: lit at its vertices");
}

#[test]
fn commands_pass_with_object_centre() {
    let mut unit = GeometryProcessor::default();
    assert!(matches!(step(&mut unit, frame(IDENTITY)).out, Some(Control::Frame(_))));
    match step(&mut unit, object(mesh(), MIRROR, Material::default(), None)).out {
        Some(Control::Object(info)) => {
            assert_eq!((info.id, info.centre, info.entries), (5, [-0.25, 0.25, 0.0], Some(64)))
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(step(&mut unit, Draw::FrameEnd).out, Some(Control::FrameEnd));
}

#[test]
fn back_faces_are_culled_also_in_mirrored_objects() {
    let mut back = mesh();
    back.indices = vec![0, 2, 1];
    let double = Material { double_sided: true, ..Material::default() };
    let visible = |mesh: &Mesh, world, material: &Material| {
        drawn(BumpConfig::default(), [frame(IDENTITY), object(mesh.clone(), world, material.clone(), None)]).is_some()
    };
    let single = Material::default();
    assert!(visible(&mesh(), IDENTITY, &single) && visible(&mesh(), MIRROR, &single));
    assert!(!visible(&back, IDENTITY, &single) && !visible(&back, MIRROR, &single));
    assert!(visible(&back, IDENTITY, &double) && visible(&back, MIRROR, &double));
}

#[test]
fn two_sided_lighting_turns_back_face_normals() {
    let mut back = mesh();
    back.indices = vec![0, 2, 1];
    back.tangents = vec![[1.0, 0.0, 0.0, 1.0]; 3];
    let material = Material { double_sided: true, ..Material::default() };
    let first = |two_sided_lighting, mesh: &Mesh| {
        let config = GeometryConfig { two_sided_lighting, ..GeometryConfig::default() };
        let mut unit = unit(config, BumpConfig::default());
        let draws = [frame(IDENTITY), object(mesh.clone(), IDENTITY, material.clone(), None)];
        polygon(&mut unit, draws).expect("visible").vertices[0]
    };
    assert_eq!(first(false, &back).normal, [0.0, 0.0, 1.0]);
    let turned = first(true, &back);
    assert_eq!((turned.normal, turned.tangent), ([0.0, 0.0, -1.0], [-1.0, 0.0, 0.0, -1.0]));
    let bitangent = Vec3::from(turned.normal).cross(Vec3::NEG_X) * turned.tangent[3];
    assert_eq!(bitangent, Vec3::NEG_Y);
    assert_eq!(first(true, &mesh()).normal, [0.0, 0.0, 1.0], "front faces stay");
}

#[test]
fn degenerate_triangles_are_dropped_and_counted() {
    let mut unit = GeometryProcessor::default();
    assert_eq!(step(&mut unit, Draw::Triangle(0)).out, None, "no object");
    let mut bad = mesh();
    bad.positions.push([f32::NAN, 0.0, 0.0]);
    bad.indices = vec![0, 1, 3, 0, 1, 1, 0, 1, 9, 0, 1];
    step(&mut unit, frame(IDENTITY));
    step(&mut unit, object(bad, IDENTITY, Material::default(), None));
    for triangle in [0, 1, 2, 3, u32::MAX] {
        assert_eq!(step(&mut unit, Draw::Triangle(triangle)).out, None);
    }
    let counters = unit.state.counters;
    assert_eq!((counters.triangles, counters.degenerate, counters.polygons), (6, 6, 0));
}

#[test]
fn near_plane_triangle_becomes_one_polygon() {
    let mut long = mesh();
    long.positions = vec![[0.0, -0.5, 2.0], [0.5, -0.5, -2.0], [-0.5, -0.4, -2.0]];
    let mut unit = GeometryProcessor::default();
    let draws = [frame(PERSPECTIVE), object(long, IDENTITY, Material { double_sided: true, ..Material::default() }, None)];
    let polygon = polygon(&mut unit, draws).expect("visible");
    assert_eq!(polygon.vertices.len(), 4);
    assert!(polygon.vertices.iter().all(|v| (-1e-5..=1.00001).contains(&v.position[2]) && v.position[3] > 0.3));
    assert_eq!(unit.state.counters.clipped, 1);
}

#[test]
fn triangle_outside_view_is_not_drawn() {
    let mut unit = GeometryProcessor::default();
    let mut behind = mesh();
    behind.positions.iter_mut().for_each(|p| p[2] = 5.0);
    assert!(polygon(&mut unit, [frame(PERSPECTIVE), object(behind, IDENTITY, Material::default(), None)]).is_none());
    assert_eq!(unit.state.counters.outside, 1);
}

#[test]
fn lod_threshold_decides_bump_targets_unless_model_does() {
    // 16 x 8 / 2 pixels, 64 x 64 / 2 texels: 8 log2 sqrt(4096 / 128) = 20.
    let mapped = Material { normal_map: Some(texture(64)), color_texture: Some(texture(1)), ..Material::default() };
    let plain = Material { color_texture: Some(texture(64)), ..Material::default() };
    let decide = |targets, max_lod, material: &Material, bump| {
        let draws = [frame(IDENTITY), object(mesh(), IDENTITY, material.clone(), bump)];
        let polygon = drawn(BumpConfig { targets, max_lod, ..BumpConfig::default() }, draws).expect("visible");
        assert_eq!(polygon.lod, 20);
        polygon.bump
    };
    assert!(decide(BumpTargets::Mapped, 63, &mapped, None));
    assert!(decide(BumpTargets::Mapped, 20, &mapped, None));
    assert!(!decide(BumpTargets::Mapped, 19, &mapped, None));
    assert!(!decide(BumpTargets::Mapped, 63, &plain, None));
    assert!(decide(BumpTargets::All, 63, &plain, None));
    assert!(!decide(BumpTargets::All, 19, &plain, None));
    assert!(decide(BumpTargets::Mapped, 0, &plain, Some(true)));
    assert!(!decide(BumpTargets::All, 63, &mapped, Some(false)));
}

#[test]
fn object_scope_gives_all_polygons_one_lod() {
    // Two triangles of one size, one twice as far away as the other.
    let mut far = mesh();
    far.positions.extend([[0.0, 0.0, -1.0], [0.5, 0.0, -1.0], [0.0, 0.5, -1.0]]);
    far.normals.extend([[0.0, 0.0, 1.0]; 3]);
    far.uv_normal.extend_from_within(..);
    far.indices.extend([3, 4, 5]);
    far.uv.clear();
    let world = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.5, 0.0, 0.0, 0.0, 1.0];
    let lods = |by| {
        let mut unit = unit(GeometryConfig::default(), BumpConfig { unit: by, ..BumpConfig::default() });
        let material = Material { normal_map: Some(texture(64)), ..Material::default() };
        step(&mut unit, frame(PERSPECTIVE));
        step(&mut unit, object(far.clone(), world, material, None));
        [0, 1].map(|number| match step(&mut unit, Draw::Triangle(number)).out {
            Some(Control::Polygon(polygon)) => polygon.lod,
            other => panic!("{other:?}"),
        })
    };
    let [near, far] = lods(BumpUnit::Polygon);
    assert!(near < far);
    let [a, b] = lods(BumpUnit::Object);
    assert!(a == b && near < a && a < far, "{near} {a} {far}");
}

/// Creates two triangles that share an edge.
fn strip() -> Mesh {
    let mut strip = mesh();
    strip.positions.push([0.5, 0.5, 0.0]);
    strip.normals.push([0.0, 0.0, 1.0]);
    strip.uv.push([1.0, 1.0]);
    strip.uv_normal.push([1.0, 1.0]);
    strip.tangents = vec![[1.0, 0.0, 0.0, 1.0]; 4];
    strip.indices = vec![0, 1, 2, 2, 1, 3];
    strip
}

/// Returns the occupancy of both triangles of the strip \[cycles\].
fn kept(config: GeometryConfig, taken: VertexAttributes, material: &Material) -> [u64; 2] {
    let mut unit = GeometryProcessor { taken, ..unit(config, BumpConfig::default()) };
    step(&mut unit, frame(IDENTITY));
    step(&mut unit, object(strip(), IDENTITY, material.clone(), None));
    [0, 1].map(|number| step(&mut unit, Draw::Triangle(number)).occupancy)
}

/// Returns a configuration with more of every resource than the strip needs. Tests change the resource under test.
fn ample() -> GeometryConfig {
    let fast = GeometryConfig {
        multipliers: 256,
        adders: 256,
        dividers: 256,
        square_roots: 256,
        powers: 256,
        ..GeometryConfig::default()
    };
    GeometryConfig { fetch_bytes_per_cycle: 4096, link_bytes: 4096, ..fast }
}

fn mapped() -> Material {
    Material { normal_map: Some(texture(64)), ..Material::default() }
}

#[test]
fn tangent_adds_divisions_and_roots_to_vertex() {
    let one = |dividers, square_roots| GeometryConfig { dividers, square_roots, ..ample() };
    // Three vertices, then one. The LOD adds a division.
    assert_eq!(kept(one(1, 256), TAKEN, &mapped()), [7 * 10, 7 * 4]);
    assert_eq!(kept(one(2, 256), TAKEN, &mapped()), [7 * 5, 7 * 2]);
    assert_eq!(kept(one(256, 1), TAKEN, &mapped()), [7 * 6, 7 * 2]);
    let unlit = VertexAttributes { lit: LightingStage::Nowhere, ..TAKEN };
    assert_eq!(kept(one(1, 256), unlit, &Material::default()), [7 * 3, 7], "neither normal nor tangent nor LOD");
    let lit = VertexAttributes { lit: LightingStage::InMachine, normal_maps: false, ..TAKEN };
    assert_eq!(kept(one(1, 256), lit, &mapped()), [7 * 6, 7 * 2], "a machine without normal maps takes no tangent");
}

#[test]
fn plain_vertex_is_lit_once_with_a_power_per_light() {
    let one = || GeometryConfig { powers: 1, ..ample() };
    assert_eq!(kept(one(), TAKEN, &Material::default()), [40 * 3, 40]);
    let dull = Lighting { ks: 0.0, ..Lighting::default() };
    let without_highlight = Material { lighting: dull, ..Material::default() };
    assert!(kept(one(), TAKEN, &without_highlight)[0] < 40);
    assert!(kept(one(), TAKEN, &mapped())[0] < 40, "bump targets are lit behind their search");
    let by_machine = VertexAttributes { lit: LightingStage::InMachine, ..TAKEN };
    assert!(kept(one(), by_machine, &Material::default())[0] < 40);
}

#[test]
fn clipped_corners_are_charged() {
    let mut long = mesh();
    long.positions = vec![[0.0, -0.5, 2.0], [0.5, -0.5, -2.0], [-0.5, -0.4, -2.0]];
    let mut unit = unit(GeometryConfig { dividers: 1, ..ample() }, BumpConfig::default());
    step(&mut unit, frame(PERSPECTIVE));
    step(&mut unit, object(long, IDENTITY, Material { double_sided: true, ..Material::default() }, Some(true)));
    // Two divisions for each of three vertices: normal, place. Three for each of two corners: share, normal, place.
    assert_eq!(step(&mut unit, Draw::Triangle(0)).occupancy, 7 * (3 * 2 + 2 * 3));
}

#[test]
fn cached_vertex_fetches_only_its_index() {
    let fetched = |vertex_cache, taken, material: Material| {
        let config = GeometryConfig { vertex_cache, fetch_bytes_per_cycle: 1, ..ample() };
        let mut unit = GeometryProcessor { taken, ..unit(config, BumpConfig::default()) };
        step(&mut unit, frame(IDENTITY));
        step(&mut unit, object(strip(), IDENTITY, material, None));
        let cycles = [0, 1].map(|number| step(&mut unit, Draw::Triangle(number)).occupancy);
        assert_eq!(unit.state.counters.vertex_bytes, cycles[0] + cycles[1]);
        cycles
    };
    let geometry_only = VertexAttributes { lit: LightingStage::Nowhere, ..TAKEN };
    let dull = || Material { lighting: Lighting { ks: 0.0, ..Lighting::default() }, ..Material::default() };
    // Indices of 2 bytes, positions of 12.
    assert_eq!(fetched(16, geometry_only, dull()), [6 + 3 * 12, 6 + 12]);
    assert_eq!(fetched(0, geometry_only, dull()), [6 + 3 * 12, 6 + 3 * 12]);
    // Two entries hold vertices 1 and 2 after the first triangle.
    assert_eq!(fetched(2, geometry_only, dull()), [6 + 3 * 12, 6 + 12]);
    assert_eq!(fetched(1, geometry_only, dull()), [6 + 3 * 12, 6 + 2 * 12]);
    assert_eq!(fetched(16, TAKEN, dull()), [6 + 3 * 24, 6 + 24], "a normal");
    assert_eq!(fetched(16, TAKEN, mapped()), [6 + 3 * 48, 6 + 48], "and tangent, handedness, coordinates");
}

#[test]
fn polygon_occupies_link_for_its_bytes() {
    let config = || GeometryConfig { link_bytes: 1, ..ample() };
    assert_eq!(kept(config(), TAKEN, &mapped()), [12 + 3 * (16 + 36); 2]);
    assert_eq!(kept(config(), VertexAttributes::default(), &mapped()), [12 + 3 * 16; 2]);
    let mut unit = unit(config(), BumpConfig::default());
    polygon(&mut unit, [frame(IDENTITY), object(mesh(), IDENTITY, mapped(), None)]);
    assert_eq!(unit.state.counters.polygon_bytes, 12 + 3 * (16 + 36));
}

#[test]
fn polygon_is_delivered_after_its_last_part() {
    let latency = |dividers| {
        let mut unit = unit(GeometryConfig { dividers, ..ample() }, BumpConfig::default());
        step(&mut unit, frame(IDENTITY));
        step(&mut unit, object(mesh(), IDENTITY, mapped(), None));
        let step = step(&mut unit, Draw::Triangle(0));
        (step.latency, step.occupancy)
    };
    let ((fast, least), (slow, most)) = (latency(256), latency(1));
    assert_eq!(slow - fast, most - least);
    assert!(most > least);
}

#[test]
fn unit_reports_operators_and_vertex_cache() {
    let mut facts = UnitStats::default();
    let config = GeometryConfig { multipliers: 5, vertex_cache: 3, ..GeometryConfig::default() };
    let unit = unit(config, BumpConfig::default());
    unit.tell_hardware(&mut facts);
    let count = |kind| facts.all_hardware().iter().filter(|h| h.kind == kind).map(|h| h.count).sum::<u64>();
    use basrelief_kernel::HardwareKind::{Divider, Multiplier, Table};
    assert_eq!([Multiplier, Divider, Table].map(count), [5, 2, 3]);
}

/// Generates a mesh of random triangles in and around the view.
fn random_mesh() -> impl Strategy<Value = Mesh> {
    let point = [-3f32..3.0, -3f32..3.0, -3f32..0.5];
    (prop::collection::vec(point, 3..30), prop::collection::vec(any::<prop::sample::Index>(), 3..90)).prop_map(
        |(positions, picks)| {
            let indices = picks.iter().map(|i| i.index(positions.len()) as u32).collect();
            Mesh { normals: vec![[0.0, 0.0, 1.0]; positions.len()], positions, indices, ..Mesh::default() }
        },
    )
}

/// Runs all triangles. Returns the commands with their unblocked delivery cycles.
fn run(config: GeometryConfig, mesh: &Mesh) -> (GeometryProcessor, Vec<(Control, u64)>) {
    let mut unit = unit(config, BumpConfig::default());
    let triangles = (0..mesh.indices.len() as u32 / 3).map(Draw::Triangle);
    let head = [frame(PERSPECTIVE), object(mesh.clone(), IDENTITY, Material::default(), None)];
    let (mut free, mut all) = (0, Vec::new());
    for draw in head.into_iter().chain(triangles).chain([Draw::FrameEnd]) {
        let step = step(&mut unit, draw);
        all.extend(step.out.map(|c| (c, free + step.latency)));
        assert_eq!(unit.state.arrival, free + step.latency);
        free += step.occupancy;
    }
    (unit, all)
}

proptest! {
    #[test]
    fn every_triangle_is_counted_and_polygons_are_valid(mesh in random_mesh()) {
        let (unit, all) = run(GeometryConfig::default(), &mesh);
        let c = unit.state.counters;
        prop_assert_eq!(c.triangles, mesh.indices.len() as u64 / 3);
        prop_assert_eq!(c.triangles, c.outside + c.culled + c.degenerate + c.polygons);
        prop_assert_eq!(c.vertices + c.vertex_cache_hits, 3 * c.triangles);
        prop_assert_eq!(all.len() as u64, c.polygons + 3);
        for (control, _) in &all {
            if let Control::Polygon(p) = control {
                prop_assert!((3..=9).contains(&p.vertices.len()));
                prop_assert!(p.vertices.iter().all(|v| v.position.iter().all(|x| x.is_finite()) && v.position[3] > 0.0));
            }
        }
    }

    #[test]
    fn vertex_cache_size_changes_only_cycles(mesh in random_mesh(), entries in 0u32..8) {
        let polygons = |vertex_cache| -> Vec<_> {
            let (_, all) = run(GeometryConfig { vertex_cache, ..GeometryConfig::default() }, &mesh);
            all.into_iter().filter_map(|(c, _)| if let Control::Polygon(p) = c { Some(p.vertices.clone()) } else { None }).collect()
        };
        prop_assert_eq!(polygons(entries), polygons(16));
    }

    #[test]
    fn replay_delivers_at_geometry_processor_cycles(mesh in random_mesh(), all_known in any::<bool>()) {
        let (_, recorded) = run(GeometryConfig::default(), &mesh);
        let commands = recorded.iter().map(|(control, at)| match control {
            Control::Polygon(p) => Ok::<_, String>((control.clone(), Some(p.arrival))),
            _ => Ok((control.clone(), all_known.then_some(*at))),
        });
        let link = PolygonLink { bytes_per_cycle: GeometryConfig::default().link_bytes, taken: TAKEN };
        let mut source = DisplayListSource::new(DisplayListConfig { arrival: CommandArrival::Recorded }, link, commands);
        let mut free = 0;
        for (control, at) in &recorded {
            let step = source.step((), &mut MemoryPorts::default());
            if all_known || matches!(control, Control::Polygon(_)) {
                prop_assert_eq!(free + step.latency, *at);
            }
            prop_assert_eq!(step.out.as_ref(), Some(control));
            free += step.occupancy;
        }
        prop_assert_eq!(source.demand(), Demand::Finished);
    }
}
