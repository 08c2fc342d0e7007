//! Tests of the unit's steps.

use super::*;
use crate::Components;
use basrelief_kernel::{OperatorConfig, Request};
use basrelief_shading::{LEVELS, ReferenceNormals, brightness, reference_normals};
use basrelief_signals::{
    Camera, Fragment, Frame, Light, LightKind, Lighting, Material, ObjectInfo, Polygon, Vertex, quantization_memory,
};
use glam::Vec3;
use proptest::prelude::*;

fn tables(entries: u32) -> TableSet {
    TableSet { entries: [entries; LEVELS], table: ReferenceNormals::Fibonacci, distinct: true, entry_bits: 16 }
}

fn unit(config: BrightnessConfig) -> BrightnessFetch {
    BrightnessFetch::new(config, tables(256), 2, &Operators::default())
}

fn frame(kind: LightKind) -> Control {
    let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    Control::Frame(Arc::new(Frame {
        width: 6,
        height: 6,
        camera,
        lights: vec![Light { kind, intensity: 1.0 }],
        ..Frame::default()
    }))
}

fn sun(x: f32) -> Control {
    frame(LightKind::Directional { to_light: [x, 0.0, (1.0 - x * x).sqrt()] })
}

fn lamp() -> Control {
    frame(LightKind::Point { position: [0.0, 0.0, 10.0] })
}

fn object(centre: [f32; 3], entries: Option<u32>) -> Control {
    Control::Object(Arc::new(ObjectInfo { name: "ball".into(), centre, entries, ..ObjectInfo::default() }))
}

fn polygon(lighting: Lighting) -> Control {
    Control::Polygon(Arc::new(Polygon {
        vertices: vec![Vertex::default(); 3],
        material: Arc::new(Material { lighting, ..Material::default() }),
        object: 0,
        lod: 0,
        bump: true,
        arrival: 0,
    }))
}

fn book(lists: &[&[[i16; 3]]]) -> Control {
    Control::CodeBook(Arc::new(lists.iter().map(|l| l.to_vec()).collect()))
}

fn indexes(samples: &[(u8, u16, f32)]) -> NormalIndexes {
    NormalIndexes {
        stamp: Stamp::from_iter([Fragment::default()]),
        samples: samples.iter().map(|&(level, index, weight)| StampSample::all(level, weight, index)).collect(),
    }
}

/// Feeds control tokens. All but code books pass.
fn tell(unit: &mut BrightnessFetch, controls: &[Control]) {
    for control in controls {
        let step = unit.step(Some(Flow::Control(control.clone())), &mut MemoryPorts::default());
        let passes = !matches!(control, Control::CodeBook(_));
        assert_eq!(step.out, passes.then(|| Flow::Control(control.clone())));
    }
}

/// Feeds one fragment and steps until it leaves.
fn fetch(unit: &mut BrightnessFetch, samples: &[(u8, u16, f32)]) -> (ShadedFragment, Vec<Request>, Out) {
    let mut requests = Vec::new();
    let mut input = Some(Flow::Item(indexes(samples)));
    loop {
        let mut traffic = MemoryPorts::default();
        let step = unit.step(input.take(), &mut traffic);
        assert!(traffic.requests().len() <= unit.largest_step(1) as usize);
        assert!(traffic.look_ups().len() <= unit.largest_step(0) as usize);
        requests.extend_from_slice(traffic.requests());
        requests.extend_from_slice(traffic.look_ups());
        match &step.out {
            Some(Flow::Item(shaded)) => return (shaded[0], requests, step),
            other => assert_eq!((other, unit.demand(), unit.is_empty()), (&None, Demand::Nothing, false)),
        }
    }
}

fn alpha(unit: &mut BrightnessFetch, level: u8, index: u16) -> f32 {
    fetch(unit, &[(level, index, 1.0)]).0.brightness
}

// Claim: as claim_4_8_clut_per_level_holds_brightness_of_normals.
#[test]
fn claims_4_and_8_clut_holds_reference_brightness() {
    let mut unit = unit(BrightnessConfig::default());
    tell(&mut unit, &[sun(0.6), object([0.0; 3], None), polygon(Lighting::default())]);
    let lights = light_vectors(unit.state.frame.as_ref().unwrap(), [0.0; 3]);
    for level in 0..8 {
        for (i, n) in reference_normals(level, 256, ReferenceNormals::Fibonacci, true, 16).unwrap().iter().enumerate() {
            let exact = brightness(Vec3::from(n.map(|c| f32::from(c) / 32_767.0)), &Lighting::default(), &lights);
            let stored = alpha(&mut unit, level, i as u16);
            assert!((stored - exact[0] - exact[1]).abs() <= 0.5 * 1.3 / 255.0 + 1e-6);
        }
    }
    assert_eq!(unit.state.counters.rebuilds, 8, "each level when it is first needed");
}

// Claim: as figures_5_and_6_index_map_becomes_brightness_map.
#[test]
fn figures_5_and_6_index_map_becomes_brightness_map() {
    const MAP: [[u16; 6]; 6] =
        [[2, 1, 2, 3, 2, 7], [1, 5, 1, 5, 1, 5], [3, 1, 3, 1, 3, 1], [1, 6, 1, 6, 1, 6], [7, 8, 7, 7, 4, 7], [8, 4, 2, 4, 8, 4]];
    let mut unit = BrightnessFetch::new(BrightnessConfig::default(), tables(8), 1, &Operators::default());
    tell(&mut unit, &[sun(0.3), object([0.0; 3], None), polygon(Lighting::default())]);
    // The figure counts indexes from 1.
    let alphas: Vec<f32> = (0..8).map(|i| alpha(&mut unit, 0, i)).collect();
    let mut different = alphas.clone();
    different.dedup();
    assert!(different.len() > 4, "{alphas:?}");
    for (y, row) in MAP.iter().enumerate() {
        for (x, i) in row.iter().enumerate() {
            assert_eq!(alpha(&mut unit, 0, i - 1), alphas[usize::from(i - 1)], "pixel {x}, {y}");
        }
    }
}

// Claim: as claim_5_9_brightness_is_fetched_per_level_then_interpolated.
#[test]
fn claims_5_and_9_lod_3_interpolates_levels_5_to_3() {
    let mut unit = unit(BrightnessConfig::default());
    tell(&mut unit, &[sun(0.3), object([0.0; 3], None), polygon(Lighting::default())]);
    let set = basrelief_shading::select_levels(3, 2, 8);
    let (a0, a1) = (alpha(&mut unit, 0, 5), alpha(&mut unit, 1, 90));
    let (shaded, _, _) = fetch(&mut unit, &[(0, 5, set.weight[0]), (1, 90, set.weight[1])]);
    assert!(a0 != a1 && (shaded.brightness - (a0 + (a1 - a0) * 3.0 / 8.0)).abs() < 1e-6);
}

/// Creates a unit with tables of 40, 7 and 1 entries, in a machine whose power takes 5 cycles.
fn small_tables() -> BrightnessFetch {
    let set = TableSet { entries: [40, 7, 1, 1, 1, 1, 1, 1], ..tables(1) };
    let operators = Operators { power: OperatorConfig::new(6, 5), ..Operators::default() };
    BrightnessFetch::new(BrightnessConfig::default(), set, 2, &operators)
}

#[test]
fn levels_are_calculated_at_first_use() {
    let mut unit = small_tables();
    tell(&mut unit, &[sun(0.3), object([0.0; 3], None), polygon(Lighting::default())]);
    let (_, requests, _) = fetch(&mut unit, &[(0, 3, 1.0)]);
    let (clut, table) = (quantization_memory::CLUTS, quantization_memory::vq_table(0));
    let moved = |write| requests.iter().filter(move |r| r.client == 1 && r.write == write).map(|r| (r.address, r.bytes));
    assert_eq!(moved(true).collect::<Vec<_>>(), [(clut, 32), (clut + 32, 8)]);
    assert_eq!(moved(false).collect::<Vec<_>>(), [(table, 6 * 32), (table + 6 * 32, 6 * 8)], "reference normals are read");
    let (_, requests, step) = fetch(&mut unit, &[(1, 3, 1.0)]);
    assert_eq!(requests.iter().filter(|r| r.write).map(|r| r.bytes).collect::<Vec<_>>(), [7]);
    let last = requests.last().unwrap();
    assert_eq!((last.client, last.write, last.address, last.bytes), (0, false, clut + 64 + 3, 1));
    assert_eq!((step.occupancy, step.latency), (1, 2));
    let c = unit.state.counters;
    assert_eq!((c.rebuilds, c.rebuild_bytes, c.normal_bytes), (2, 47, 6 * 47));
}

#[test]
fn entry_costs_arithmetic_per_light() {
    let mut cycles = |lights: usize| {
        let mut unit = small_tables();
        let Control::Frame(frame) = sun(0.3) else { panic!("no frame") };
        let lights = vec![frame.lights[0]; lights];
        let frame = Control::Frame(Arc::new(Frame { lights, ..Frame::clone(&frame) }));
        tell(&mut unit, &[frame, object([0.0; 3], None), polygon(Lighting::default())]);
        fetch(&mut unit, &[(1, 3, 1.0)]);
        unit.state.counters.rebuild_cycles
    };
    // Seven entries, with a power of 5 cycles per light. A step reads the reference normals before, and a step writes the entries.
    assert_eq!([1, 2, 4].map(&mut cycles), [7 * 5 + 2, 7 * 10 + 2, 7 * 20 + 2]);
}

#[test]
fn alternating_materials_are_not_recalculated() {
    let rebuilds = |sets| {
        let config = BrightnessConfig { sets, ..BrightnessConfig::default() };
        let mut unit = BrightnessFetch::new(config, tables(256), 2, &Operators::default());
        tell(&mut unit, &[sun(0.3), object([0.0; 3], None)]);
        let materials = [Lighting::default(), Lighting { n: 64.0, ..Lighting::default() }];
        for lighting in materials.into_iter().cycle().take(10) {
            tell(&mut unit, &[polygon(lighting)]);
            alpha(&mut unit, 0, 0);
        }
        unit.state.counters.rebuilds
    };
    assert_eq!([1, 2].map(rebuilds), [10, 2]);
}

#[test]
fn samples_beyond_interpolator_rate_cost_cycles() {
    let occupancy = |samples_per_cycle| {
        let config = BrightnessConfig { samples_per_cycle, ..BrightnessConfig::default() };
        let mut unit = BrightnessFetch::new(config, tables(256), 8, &Operators::default());
        tell(&mut unit, &[sun(0.3), object([0.0; 3], None), polygon(Lighting::default())]);
        fetch(&mut unit, &[(0, 0, 0.125); 8]).2.occupancy
    };
    assert_eq!([1, 2, 3, 8].map(occupancy), [8, 4, 3, 1]);
}

// Claim: as cluts_are_rebuilt_only_when_the_light_moves.
#[test]
fn unchanged_lighting_is_not_recalculated() {
    let mut unit = unit(BrightnessConfig::default());
    let mut rebuilds = |controls: &[Control]| {
        let before = unit.state.counters.rebuilds;
        tell(&mut unit, controls);
        assert_eq!(unit.state.counters.rebuilds, before, "not before a fragment needs it");
        alpha(&mut unit, 0, 0);
        unit.state.counters.rebuilds - before
    };
    let (plain, shiny) = (Lighting::default(), Lighting { n: 64.0, ..Lighting::default() });
    let (here, there) = (object([0.0; 3], None), object([5.0, 0.0, 0.0], None));
    assert_eq!(rebuilds(&[sun(0.3), here.clone(), polygon(plain)]), 1);
    assert_eq!(rebuilds(&[Control::FrameEnd, sun(0.3), there.clone(), polygon(plain)]), 0, "a sun shines everywhere alike");
    assert_eq!(rebuilds(&[sun(0.4)]), 1, "the light moved");
    assert_eq!(rebuilds(&[polygon(shiny)]), 1, "another material");
    assert_eq!(rebuilds(&[polygon(plain), polygon(shiny)]), 0, "back before any fragment");
    assert_eq!(rebuilds(&[lamp(), here.clone()]), 1, "another type of light");
    assert_eq!(rebuilds(&[there]), 1, "the lamp shines from elsewhere");
    assert_eq!(rebuilds(&[sun(0.3), here, polygon(plain)]), 0, "that set is still there");
    assert_eq!(rebuilds(&[object([5.0, 0.0, 0.0], Some(64))]), 1, "another number of reference normals");
    assert_eq!(rebuilds(&[book(&[&[[0, 0, 32_767]]])]), 1);
    assert_eq!(rebuilds(&[book(&[&[[0, 0, 32_767]]])]), 1, "nobody compares code books");
}

#[test]
fn code_books_replace_tables_and_do_not_travel_on() {
    let mut unit = unit(BrightnessConfig::default());
    tell(&mut unit, &[sun(0.0), object([0.0; 3], None), polygon(Lighting::default())]);
    tell(&mut unit, &[book(&[&[[0, 0, -32_767], [0, 0, 32_767]], &[]])]);
    assert!((alpha(&mut unit, 0, 0) - 0.1).abs() < 0.003);
    assert!((alpha(&mut unit, 0, 1) - 1.3).abs() < 1e-6);
    assert_eq!(unit.state.counters.rebuild_bytes, 2);
}

#[test]
fn separate_components_keep_highlight_separate() {
    let mut unit = unit(BrightnessConfig { components: Components::Separate, bits: 16, ..BrightnessConfig::default() });
    tell(&mut unit, &[sun(0.0), object([0.0; 3], None), polygon(Lighting::default()), book(&[&[[0, 0, 32_767]]])]);
    let (shaded, requests, _) = fetch(&mut unit, &[(0, 0, 1.0)]);
    assert!((shaded.brightness - 0.9).abs() < 1e-6 && (shaded.highlight - 0.4).abs() < 1e-6);
    assert_eq!(requests.last().unwrap().bytes, 4);
}

// Claim: as claim_7_direct_brightness_differs_by_at_most_a_clut_step.
#[test]
fn claim_7_direct_brightness_needs_no_clut() {
    let mut direct = unit(BrightnessConfig { source: BrightnessSource::Direct, ..BrightnessConfig::default() });
    tell(&mut direct, &[sun(0.6), object([0.0; 3], None), polygon(Lighting::default())]);
    let (shaded, requests, step) = fetch(&mut direct, &[(0, 17, 0.25), (1, 40, 0.75)]);
    let lights = light_vectors(direct.state.frame.as_ref().unwrap(), [0.0; 3]);
    let exact = |level, i: usize| {
        let n = reference_normals(level, 256, ReferenceNormals::Fibonacci, true, 16).unwrap()[i];
        let [d, s] = brightness(Vec3::from(n.map(|c| f32::from(c) / 32_767.0)), &Lighting::default(), &lights);
        d + s
    };
    assert_eq!(shaded.brightness, 0.25 * exact(0, 17) + 0.75 * exact(1, 40));
    let read: Vec<_> = requests.iter().map(|r| (r.client, r.write, r.address, r.bytes)).collect();
    let normal = |level, index: u64| (0, false, quantization_memory::vq_table(level) + 6 * index, 6);
    assert_eq!(read, [normal(0, 17), normal(1, 40)], "the reference normals, and no entries");
    // Two samples of 11 products by four multipliers. Then product and sum, after a chain of products, sums and a power.
    assert_eq!((step.occupancy, step.latency, direct.state.counters.rebuilds), (6, 2 + 8, 0));
}

#[test]
fn stamp_fragments_get_brightness_of_their_samples() {
    let mut unit = BrightnessFetch::new(BrightnessConfig::default(), tables(256), 4, &Operators::default());
    tell(&mut unit, &[sun(0.3), object([0.0; 3], None), polygon(Lighting::default())]);
    let alphas = [(0, 5), (1, 90), (0, 6), (1, 91)].map(|(level, index)| alpha(&mut unit, level, index));
    let mut two = indexes(&[(0, 5, 0.25), (1, 90, 0.75)]);
    two.stamp.push(Fragment { x: 1, ..Fragment::default() });
    for (sample, index) in two.samples.iter_mut().zip([6, 91]) {
        (sample.weight[1], sample.value[1]) = (0.5, index);
    }
    let step = unit.step(Some(Flow::Item(two)), &mut MemoryPorts::default());
    let Some(Flow::Item(shaded)) = step.out else { panic!("nothing left") };
    let expected = [0.25 * alphas[0] + 0.75 * alphas[1], 0.5 * alphas[2] + 0.5 * alphas[3]];
    assert_eq!(shaded.iter().map(|s| (s.fragment.x, s.brightness)).collect::<Vec<_>>(), [(0, expected[0]), (1, expected[1])]);
    assert_eq!((step.occupancy, step.latency), (2, 3));
}

#[test]
fn impossible_entries_of_an_object_are_a_fault() {
    let mut unit = BrightnessFetch::new(
        BrightnessConfig::default(),
        TableSet { table: ReferenceNormals::Tetrahedron, ..tables(256) },
        2,
        &Operators::default(),
    );
    tell(&mut unit, &[sun(0.6), object([0.0; 3], Some(5)), polygon(Lighting::default())]);
    let mut traffic = MemoryPorts::default();
    unit.step(Some(Flow::Item(indexes(&[(0, 0, 1.0)]))), &mut traffic);
    assert!(format!("{traffic:?}").contains("object `ball` fixes its number of reference normals"), "{traffic:?}");
}

#[test]
fn state_survives_checkpoint_within_rebuild() {
    let mut a = unit(BrightnessConfig::default());
    tell(&mut a, &[sun(0.6), object([0.0; 3], None), polygon(Lighting::default())]);
    a.step(Some(Flow::Item(indexes(&[(0, 9, 1.0)]))), &mut MemoryPorts::default());
    let mut b = unit(BrightnessConfig::default());
    b.state = serde_json::from_str(&serde_json::to_string(&a.state).unwrap()).unwrap();
    assert_eq!(a.state, b.state);
    while a.demand() == Demand::Nothing {
        assert_eq!(a.step(None, &mut MemoryPorts::default()), b.step(None, &mut MemoryPorts::default()));
    }
    assert_eq!((a.state, b.demand()), (b.state, Demand::All));
}

#[test]
fn entries_are_calculated_after_their_normals_arrive() {
    let mut unit = small_tables();
    tell(&mut unit, &[sun(0.3), object([0.0; 3], None), polygon(Lighting::default())]);
    let mut input = Some(Flow::Item(indexes(&[(0, 3, 1.0)])));
    let mut steps = Vec::new();
    loop {
        let mut traffic = MemoryPorts::default();
        let step = unit.step(input.take(), &mut traffic);
        if step.out.is_some() {
            break;
        }
        let moved = |write| traffic.requests().iter().filter(|r| r.write == write).map(|r| r.bytes).sum::<u32>();
        steps.push((moved(false) / 6, step.occupancy / unit.config.entry_cycles(1, &unit.operators), moved(true), step.blocking));
    }
    // Reference normals read, entries calculated, bytes written: 32 and 8 entries, one step after the other.
    assert_eq!(steps, [(32, 0, 0, true), (8, 32, 0, true), (0, 8, 32, true), (0, 0, 8, true)]);
}

#[test]
fn interpolation_begins_with_its_entries() {
    let mut unit = unit(BrightnessConfig::default());
    tell(&mut unit, &[sun(0.6), object([0.0; 3], None), polygon(Lighting::default())]);
    let (_, _, step) = fetch(&mut unit, &[(0, 17, 0.25), (1, 40, 0.75)]);
    assert_eq!((u64::from(step.after_data), step.blocking), (step.latency, false));
}

#[test]
fn fragment_takes_cycles_of_all_its_samples() {
    let mut unit =
        BrightnessFetch::new(BrightnessConfig { levels: 8, ..BrightnessConfig::default() }, tables(4), 8, &Operators::default());
    tell(&mut unit, &[sun(0.6), object([0.0; 3], None), polygon(Lighting::default())]);
    let occupancy = [1_u8, 2, 3, 5, 8].map(|n| {
        let samples: Vec<_> = (0..n).map(|level| (level, 0, 0.1)).collect();
        fetch(&mut unit, &samples).2.occupancy
    });
    assert_eq!(occupancy, [1, 1, 2, 3, 4], "two samples per cycle");
}

#[test]
fn table_of_another_size_is_read_at_its_own_address() {
    let mut unit = unit(BrightnessConfig::default());
    tell(&mut unit, &[sun(0.6), object([0.0; 3], Some(64)), polygon(Lighting::default())]);
    let (_, requests, _) = fetch(&mut unit, &[(1, 17, 1.0)]);
    assert_eq!(requests[0].address, quantization_memory::OTHER_TABLES + 384);
}

proptest! {
    #[test]
    fn brightness_is_weighted_mean_within_full_scale(
        samples in prop::collection::vec((0u8..8, 0u16..256), 1..=8), bits in 4u32..=16,
    ) {
        let mut unit = BrightnessFetch::new(BrightnessConfig { bits, ..BrightnessConfig::default() }, tables(256), 8, &Operators::default());
        tell(&mut unit, &[sun(0.6), object([0.0; 3], None), polygon(Lighting::default())]);
        let weight = 1.0 / samples.len() as f32;
        let weighted: Vec<_> = samples.iter().map(|&(l, i)| (l, i, weight)).collect();
        let (shaded, _, _) = fetch(&mut unit, &weighted);
        let mean = samples.iter().map(|&(l, i)| weight * alpha(&mut unit, l, i)).sum::<f32>();
        prop_assert!((shaded.brightness - mean).abs() < 1e-5);
        prop_assert!((0.0..=1.3001).contains(&shaded.brightness));
        prop_assert_eq!(shaded.highlight, 0.0);
    }
}
