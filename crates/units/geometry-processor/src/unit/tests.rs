use super::*;
use crate::DisplayListSource;
use crate::config::{Arrival, DisplayListConfig};
use basrelief_signals::{Camera, Image, Light, LightKind, Material, Mesh, Sampler, Texture};
use proptest::prelude::*;

const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
const MIRROR: [f64; 16] = [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// Perspective, 90 degrees, near 1, far 3.
const PERSPECTIVE: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -2.0, -3.0, 0.0, 0.0, -1.0, 0.0];

fn frame(view_projection: [f64; 16]) -> Draw {
    let camera = Camera { view_projection, to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let lights = vec![Light { kind: LightKind::Directional { to_light: [0.0, 0.0, 1.0] }, intensity: 1.0 }];
    Draw::Frame(Arc::new(Frame {
        index: 0,
        width: 64,
        height: 32,
        camera,
        lights,
        textures: Vec::new(),
        shading: Default::default(),
    }))
}

fn texture(side: u32) -> Arc<Texture> {
    let levels = vec![Image { width: side, height: side, texels: vec![[0; 4]; (side * side) as usize] }];
    Arc::new(Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset: 0 })
}

/// A triangle that faces +z.
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
        bump,
        shading: Default::default(),
    }))
}

fn step(unit: &mut GeometryProcessor, draw: Draw) -> Step<Option<Control>> {
    unit.step(Some(draw), &mut Traffic::default())
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
    polygon(&mut GeometryProcessor::new(GeometryConfig::default(), bump), draws)
}

#[test]
fn a_triangle_lands_in_window_coordinates_with_y_down() {
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
fn commands_pass_with_the_objects_centre() {
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
fn faces_that_look_away_are_culled_mirrored_objects_the_other_way_round() {
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
fn back_faces_turn_their_normals_where_asked() {
    let mut back = mesh();
    back.indices = vec![0, 2, 1];
    back.tangents = vec![[1.0, 0.0, 0.0, 1.0]; 3];
    let material = Material { double_sided: true, ..Material::default() };
    let first = |two_sided_lighting, mesh: &Mesh| {
        let config = GeometryConfig { two_sided_lighting, ..GeometryConfig::default() };
        let mut unit = GeometryProcessor::new(config, BumpConfig::default());
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
fn a_triangle_through_the_near_plane_becomes_one_polygon_in_front_of_it() {
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
fn outside_the_view_nothing_is_drawn() {
    let mut unit = GeometryProcessor::default();
    let mut behind = mesh();
    behind.positions.iter_mut().for_each(|p| p[2] = 5.0);
    assert!(polygon(&mut unit, [frame(PERSPECTIVE), object(behind, IDENTITY, Material::default(), None)]).is_none());
    assert_eq!(unit.state.counters.outside, 1);
}

#[test]
fn lod_and_threshold_decide_what_is_a_bump_target_unless_the_model_says_so() {
    // 16 x 8 / 2 pixels, 64 x 64 / 2 texels: 8 log2 sqrt(4096 / 128) = 20.
    let mapped = Material { normal_map: Some(texture(64)), color_texture: Some(texture(1)), ..Material::default() };
    let plain = Material { color_texture: Some(texture(64)), ..Material::default() };
    let decide = |targets, max_lod, material: &Material, bump| {
        let draws = [frame(IDENTITY), object(mesh(), IDENTITY, material.clone(), bump)];
        let polygon = drawn(BumpConfig { targets, max_lod }, draws).expect("visible");
        assert_eq!(polygon.lod, 20);
        polygon.bump
    };
    assert!(decide(Targets::Mapped, 63, &mapped, None));
    assert!(decide(Targets::Mapped, 20, &mapped, None));
    assert!(!decide(Targets::Mapped, 19, &mapped, None));
    assert!(!decide(Targets::Mapped, 63, &plain, None));
    assert!(decide(Targets::All, 63, &plain, None));
    assert!(!decide(Targets::All, 19, &plain, None));
    assert!(decide(Targets::Mapped, 0, &plain, Some(true)));
    assert!(!decide(Targets::All, 63, &mapped, Some(false)));
}

#[test]
fn vertices_in_the_cache_cost_nothing() {
    let mut strip = mesh();
    strip.positions.push([0.5, 0.5, 0.0]);
    strip.normals.push([0.0, 0.0, 1.0]);
    strip.indices = vec![0, 1, 2, 2, 1, 3];
    let costs = |vertex_cache| {
        let config = GeometryConfig { cycles_per_vertex: 10, cycles_per_polygon: 3, vertex_cache, ..GeometryConfig::default() };
        let mut unit = GeometryProcessor::new(config, BumpConfig::default());
        let draws =
            [frame(IDENTITY), object(strip.clone(), IDENTITY, Material::default(), None), Draw::Triangle(0), Draw::Triangle(1)];
        draws.map(|d| step(&mut unit, d).occupancy)
    };
    assert_eq!(costs(16), [1, 1, 33, 13]);
    assert_eq!(costs(0), [1, 1, 33, 33]);
    // Two entries hold vertices 1 and 2 after the first triangle.
    assert_eq!(costs(2), [1, 1, 33, 13]);
    assert_eq!(costs(1), [1, 1, 33, 23]);
}

/// A mesh of random triangles in and around the view.
fn random_mesh() -> impl Strategy<Value = Mesh> {
    let point = [-3f32..3.0, -3f32..3.0, -3f32..0.5];
    (prop::collection::vec(point, 3..30), prop::collection::vec(any::<prop::sample::Index>(), 3..90)).prop_map(
        |(positions, picks)| {
            let indices = picks.iter().map(|i| i.index(positions.len()) as u32).collect();
            Mesh { normals: vec![[0.0, 0.0, 1.0]; positions.len()], positions, indices, ..Mesh::default() }
        },
    )
}

/// Runs all triangles; commands with their unblocked delivery cycles.
fn run(config: GeometryConfig, mesh: &Mesh) -> (GeometryProcessor, Vec<(Control, u64)>) {
    let mut unit = GeometryProcessor::new(config, BumpConfig::default());
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
    fn every_triangle_is_accounted_for_and_polygons_are_sound(mesh in random_mesh()) {
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
    fn the_size_of_the_vertex_cache_changes_cycles_only(mesh in random_mesh(), entries in 0u32..8) {
        let polygons = |vertex_cache| -> Vec<_> {
            let (_, all) = run(GeometryConfig { vertex_cache, ..GeometryConfig::default() }, &mesh);
            all.into_iter().filter_map(|(c, _)| if let Control::Polygon(p) = c { Some(p.vertices.clone()) } else { None }).collect()
        };
        prop_assert_eq!(polygons(entries), polygons(16));
    }

    #[test]
    fn a_replay_delivers_at_the_cycles_of_the_geometry_processor(mesh in random_mesh(), all_known in any::<bool>()) {
        let (_, recorded) = run(GeometryConfig::default(), &mesh);
        let commands = recorded.iter().map(|(control, at)| match control {
            Control::Polygon(p) => Ok::<_, String>((control.clone(), Some(p.arrival))),
            _ => Ok((control.clone(), all_known.then_some(*at))),
        });
        let mut source = DisplayListSource::new(DisplayListConfig { arrival: Arrival::Recorded }, commands);
        let mut free = 0;
        for (control, at) in &recorded {
            let step = source.step((), &mut Traffic::default());
            if all_known || matches!(control, Control::Polygon(_)) {
                prop_assert_eq!(free + step.latency, *at);
            }
            prop_assert_eq!(step.out.as_ref(), Some(control));
            free += step.occupancy;
        }
        prop_assert_eq!(source.demand(), Demand::Finished);
    }
}
