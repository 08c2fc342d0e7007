//! Tests of the unit's steps.

use super::*;
use basrelief_kernel::OperatorConfig;
use basrelief_signals::{Material, Sampler, StampLanes, TexelFilter, Texture, Vertex};
use proptest::prelude::*;

/// Creates a map whose level k has `side >> k` texels per side, filled by `texel(level, x, y)`.
fn map(side: u32, levels: u32, texel: impl Fn(u32, u32, u32) -> [u8; 3]) -> Arc<Texture> {
    let image = |k: u32| {
        let n = (side >> k).max(1);
        let at = |i: u32| texel(k, i % n, i / n);
        Image { width: n, height: n, texels: (0..n * n).map(at).map(|[r, g, b]| [r, g, b, 255]).collect() }
    };
    let levels = (0..levels).map(image).collect();
    Arc::new(Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

/// Creates a unit square in the plane z = 0 facing +z, u along x, v against y (glTF).
fn square(lod: u8, normal_map: Option<Arc<Texture>>) -> Arc<Polygon> {
    let vertex = |u: f32, v: f32| Vertex { tangent: [1.0, 0.0, 0.0, 1.0], uv_normal: [u, v], ..Vertex::default() };
    let vertices = vec![vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(1.0, 1.0), vertex(0.0, 1.0)];
    let material = Arc::new(Material { normal_map, ..Material::default() });
    Arc::new(Polygon { vertices, material, object: 0, lod, bump: true, arrival: 0 })
}

fn fragment(u: f32, v: f32) -> Fragment {
    // Triangle 0 of the fan is (0,0), (1,0), (1,1): weights u - v and v.
    Fragment { x: 3, y: 4, z: 5, weights: [u - v, v], triangle: 0 }
}

/// Returns divisions of seven cycles, not pipelined.
fn operators() -> Operators {
    Operators { divide: OperatorConfig::new(7, 7), ..Operators::default() }
}

fn unit(config: NormalMappingConfig, levels: u8, polygon: Arc<Polygon>) -> NormalMapping {
    let mut unit = NormalMapping::new(config, &operators(), levels, 4, 64);
    let control = Flow::Control(Control::Polygon(polygon));
    let step = unit.step(Some(control.clone().into_item_type()), &mut MemoryPorts::default());
    assert_eq!(step.out, Some(control));
    unit
}

trait IntoItemType {
    fn into_item_type(self) -> Flow<Stamp<Fragment>>;
}

impl IntoItemType for Flow<PseudoNormals> {
    fn into_item_type(self) -> Flow<Stamp<Fragment>> {
        match self {
            Flow::Control(c) => Flow::Control(c),
            Flow::Item(p) => Flow::Item(p.stamp),
        }
    }
}

fn mapped(unit: &mut NormalMapping, at: Fragment, traffic: &mut MemoryPorts) -> PseudoNormals {
    match unit.step(Some(Flow::Item(Stamp::from_iter([at]))), traffic).out {
        Some(Flow::Item(p)) => p,
        other => panic!("{other:?}"),
    }
}

// Claim: as claim_1_7_each_level_has_its_own_map_and_table.
#[test]
fn claims_1_and_5_each_level_reads_its_own_map() {
    // Level k leans along +x for even k and along +y for odd k.
    let lean = map(16, 5, |k, _, _| if k % 2 == 0 { [255, 128, 128] } else { [128, 255, 128] });
    let mut unit = unit(NormalMappingConfig::default(), 2, square(3, Some(lean)));
    let p = mapped(&mut unit, fragment(0.4, 0.2), &mut MemoryPorts::default());
    assert_eq!(p.samples.iter().map(|s| (s.level, s.weight[0])).collect::<Vec<_>>(), [(0, 5.0 / 8.0), (1, 3.0 / 8.0)]);
    let [a, b] = [0, 1].map(|i| p.samples[i].value.lane(0));
    assert_eq!((a[0], b[1]), (32_767, 32_767));
    assert!(a[1].abs() < 200 && b[0].abs() < 200);
    assert_eq!((p.stamp[0].x, p.stamp[0].y, p.stamp[0].z), (3, 4, 5));
}

#[test]
fn green_channel_leans_against_v() {
    let up = map(4, 1, |_, _, _| [128, 255, 128]);
    let mut left_handed = (*square(0, Some(up))).clone();
    left_handed.vertices.iter_mut().for_each(|v| v.tangent[3] = -1.0);
    let mut unit = unit(NormalMappingConfig::default(), 1, Arc::new(left_handed));
    assert_eq!(mapped(&mut unit, fragment(0.5, 0.5), &mut MemoryPorts::default()).samples[0].value.lane(0)[1], -32_767);
}

#[test]
fn missing_map_or_zero_scale_keeps_normal() {
    let mut bare = unit(NormalMappingConfig::default(), 2, square(3, None));
    let p = mapped(&mut bare, fragment(0.4, 0.2), &mut MemoryPorts::default());
    assert_eq!(p.samples.iter().map(|s| s.value.lane(0)).collect::<Vec<_>>(), [[0, 0, 32_767]; 2]);
    let mut flat = (*square(0, Some(map(4, 1, |_, _, _| [255, 0, 200])))).clone();
    flat.material = Arc::new(Material { normal_scale: 0.0, ..(*flat.material).clone() });
    let mut flat = unit(NormalMappingConfig::default(), 1, Arc::new(flat));
    assert_eq!(mapped(&mut flat, fragment(0.4, 0.2), &mut MemoryPorts::default()).samples[0].value.lane(0), [0, 0, 32_767]);
}

#[test]
fn filtered_brightness_needs_four_searches() {
    let config = NormalMappingConfig { filter_at: FilterAt::Brightness, ..NormalMappingConfig::default() };
    assert_eq!(config.samples(2), 8);
    let ramp = map(8, 4, |_, x, y| [(16 * x) as u8, (16 * y) as u8, 255]);
    let mut unit = unit(config, 2, square(3, Some(ramp)));
    let p = mapped(&mut unit, fragment(0.5, 0.3), &mut MemoryPorts::default());
    let sum = |samples: &[StampSample<StampNormals>]| samples.iter().map(|s| s.weight[0]).sum::<f32>();
    assert!((sum(&p.samples) - 1.0).abs() < 1e-6 && (sum(&p.samples[..4]) - 5.0 / 8.0).abs() < 1e-6);
    assert_eq!(p.samples.iter().map(|s| s.level).collect::<Vec<_>>(), [0, 0, 0, 0, 1, 1, 1, 1]);
    assert_ne!(p.samples[0].value.lane(0), p.samples[3].value.lane(0));
}

#[test]
fn footprint_within_block_touches_one_line() {
    let flat = map(16, 1, |_, _, _| [128, 128, 255]);
    let mut unit = unit(NormalMappingConfig::default(), 1, square(0, Some(flat)));
    let lines = |unit: &mut NormalMapping, u, v| {
        let mut traffic = MemoryPorts::default();
        mapped(unit, fragment(u, v), &mut traffic);
        traffic.look_ups().iter().map(|r| r.address / 64).collect::<Vec<_>>()
    };
    assert_eq!(lines(&mut unit, 2.0 / 16.0, 2.0 / 16.0), [0]);
    assert_eq!(lines(&mut unit, 4.0 / 16.0, 2.0 / 16.0), [0, 1]);
    assert_eq!(lines(&mut unit, 4.0 / 16.0, 4.0 / 16.0), [0, 1, 4, 5]);
    assert_eq!(unit.state.counters.texels, 12);
}

#[test]
fn control_passes_and_unit_holds_nothing() {
    let mut unit = NormalMapping::new(NormalMappingConfig::default(), &operators(), 2, 4, 64);
    let step = unit.step(Some(Flow::Control(Control::FrameEnd)), &mut MemoryPorts::default());
    assert_eq!(step.out, Some(Flow::Control(Control::FrameEnd)));
    assert_eq!(unit.demand(), Demand::All);
    assert!(unit.is_empty());
}

#[test]
fn fragment_without_triangle_has_no_direction() {
    let mut unit = unit(NormalMappingConfig::default(), 2, square(0, None));
    let stray = Fragment { triangle: 77, ..Fragment::default() };
    let p = mapped(&mut unit, stray, &mut MemoryPorts::default());
    assert_eq!(p.samples[..], [StampSample::all(0, 1.0, [0; 3])]);
}

#[test]
fn operators_limit_fragment_rate() {
    let flat = || Some(map(16, 8, |_, _, _| [128, 128, 255]));
    let kept = |dividers, levels, normal_map| {
        let config = NormalMappingConfig { dividers, ..NormalMappingConfig::default() };
        let mut unit = unit(config, levels, square(19, normal_map));
        let latency = unit.timing.latency;
        let all = unit.step(Some(Flow::Item(Stamp::from_iter([fragment(0.5, 0.5); 3]))), &mut MemoryPorts::default());
        assert_eq!(all.latency, latency + all.occupancy * 2 / 3, "the last enters behind the others");
        all.occupancy
    };
    assert_eq!([1, 2, 3].map(|levels| kept(14, levels, flat())), [3, 3, 3 * 2]);
    assert_eq!([1, 2, 3].map(|levels| kept(7, levels, flat())), [3, 3 * 2, 3 * 3], "half the dividers");
    assert_eq!(kept(1, 2, flat()), 3 * 14);
    assert_eq!(kept(1, 2, None), 3 * 7, "without a map N' is scaled once for all levels");
}

#[test]
fn four_searches_need_four_rotations_of_one_footprint() {
    let kept = |filter_at| {
        let config = NormalMappingConfig { filter_at, multipliers: 1, dividers: 256, ..NormalMappingConfig::default() };
        let mut unit = unit(config, 1, square(0, Some(map(16, 1, |_, _, _| [128, 128, 255]))));
        unit.step(Some(Flow::Item(Stamp::from_iter([fragment(0.5, 0.5)]))), &mut MemoryPorts::default()).occupancy
    };
    // Frame 22, footprint 3, filter 12, and one rotation and scale of 14, or four of these.
    assert_eq!(kept(FilterAt::Normal), 22 + 3 + 12 + 14);
    assert_eq!(kept(FilterAt::Brightness), 22 + 3 + 4 * 14);
}

#[test]
fn unit_reports_its_operators() {
    let mut facts = UnitStats::default();
    unit(NormalMappingConfig { dividers: 5, ..NormalMappingConfig::default() }, 2, square(0, None)).report_stats(&mut facts);
    let dividers = facts.all_hardware().iter().find(|h| h.kind == HardwareKind::Divider);
    assert_eq!(dividers.map(|h| (h.count, h.width)), Some((5, 32)));
}

#[test]
fn state_survives_checkpoint() {
    let mut a = unit(NormalMappingConfig::default(), 2, square(3, Some(map(8, 4, |k, x, _| [x as u8, k as u8, 255]))));
    mapped(&mut a, fragment(0.3, 0.1), &mut MemoryPorts::default());
    let text = serde_json::to_string(&a.state).unwrap();
    let mut b = NormalMapping::new(NormalMappingConfig::default(), &operators(), 2, 4, 64);
    b.state = serde_json::from_str(&text).unwrap();
    assert_eq!(a.state, b.state);
    let at = fragment(0.7, 0.6);
    assert_eq!(mapped(&mut a, at, &mut MemoryPorts::default()), mapped(&mut b, at, &mut MemoryPorts::default()));
}

#[test]
fn filter_rotation_and_scale_begin_with_their_texels() {
    let operators =
        Operators { multiply: OperatorConfig::new(10, 1), divide: OperatorConfig::new(100, 1), ..Operators::default() };
    let mut unit = NormalMapping::new(NormalMappingConfig::default(), &operators, 2, 4, 64);
    let polygon = square(0, Some(map(4, 3, |_, _, _| [128, 128, 255])));
    unit.step(Some(Flow::Control(Control::Polygon(polygon))), &mut MemoryPorts::default());
    let step = unit.step(Some(Flow::Item(Stamp::from_iter([fragment(0.5, 0.25)]))), &mut MemoryPorts::default());
    // Filter, rotation and scale: a product and two sums each, and a quotient. Before them: attribute and footprint.
    assert_eq!((step.after_data, step.latency), (3 * 10 + 6 + 100, 5 * 10 + 10 + 100));
}

proptest! {
    #[test]
    fn bilinear_normals_match_double_precision(u in 0f32..1.0, t in 0f32..1.0) {
        let (side, v) = (8u32, u * t);
        let texel = |_: u32, x: u32, y: u32| [(x * 37 % 256) as u8, (y * 53 % 256) as u8, 255 - (x * y % 100) as u8];
        let mut unit = unit(NormalMappingConfig::default(), 1, square(0, Some(map(side, 1, texel))));
        let at = fragment(u, v);
        let p = mapped(&mut unit, at, &mut MemoryPorts::default());
        let uv = [f64::from(at.weights[0] + at.weights[1]), f64::from(at.weights[1])];
        let [x, y] = uv.map(|c| c * f64::from(side) - 0.5);
        let wrapped = |i: f64| (i as i64).rem_euclid(i64::from(side)) as u32;
        let mut n = [0.0; 3];
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let weight = (1.0 - (x - x.floor() - dx).abs()) * (1.0 - (y - y.floor() - dy).abs());
            let stored = texel(0, wrapped(x.floor() + dx), wrapped(y.floor() + dy));
            for i in 0..3 {
                n[i] += weight * (f64::from(stored[i]) / 127.5 - 1.0);
            }
        }
        let largest = n.iter().fold(0f64, |m, c| m.max(c.abs()));
        for i in 0..3 {
            prop_assert!((f64::from(p.samples[0].value.lane(0)[i]) - 32_767.0 * n[i] / largest).abs() < 3.0, "{:?} {:?}", p.samples[0], n);
        }
    }

    #[test]
    fn no_step_exceeds_largest_step(
        u in any::<f32>(), v in any::<f32>(), lod in 0u8..64, levels in 1u8..=8, line in 2u32..=8, texel_bytes in 1u32..=8,
        brightness in any::<bool>(), nearest in any::<bool>(), side in 0u32..6, triangle in 0u16..4, fragments in 1usize..=4,
    ) {
        let filter = if nearest { TexelFilter::Nearest } else { TexelFilter::Bilinear };
        let filter_at = if brightness { FilterAt::Brightness } else { FilterAt::Normal };
        let config = NormalMappingConfig { filter, filter_at, texel_bytes, ..NormalMappingConfig::default() };
        let mut unit = NormalMapping::new(config, &operators(), levels, fragments as u32, 1 << line);
        let polygon = square(lod, Some(map(1 << side, 8, |_, _, _| [1, 2, 3])));
        unit.step(Some(Flow::Control(Control::Polygon(polygon))), &mut MemoryPorts::default());
        let mut traffic = MemoryPorts::default();
        let at = Fragment { weights: [u, v], triangle, ..Fragment::default() };
        let other = |i: usize| Fragment { weights: [u + 0.3 * i as f32, v - 0.2 * i as f32], ..at };
        let stamp: Stamp<Fragment> = (0..fragments).map(other).collect();
        let Some(Flow::Item(p)) = unit.step(Some(Flow::Item(stamp)), &mut traffic).out else { panic!("nothing left") };
        prop_assert!((1..=MAX_SAMPLES).contains(&p.samples.len()) && p.stamp.len() == fragments);
        let mut lines: Vec<u64> = traffic
            .look_ups()
            .iter()
            .flat_map(|r| (r.address >> line)..=((r.address + u64::from(r.bytes) - 1) >> line))
            .collect();
        lines.sort_unstable();
        lines.dedup();
        prop_assert!(lines.len() <= unit.largest_step(0) as usize);
    }
}
