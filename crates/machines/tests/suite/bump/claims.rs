//! The patent's claims, its worked example, its flow chart and its erratum. The table is docs/reference/claims.csv.

use crate::bump::chain::{Chain, TO_LIGHT, bumpy_map, indexes, pseudo_normals, single, uniform_map};
use crate::bump::recipe::{Part, SceneRecipe, Shape, Surface};
use crate::bump::runs::{Ran, config, functional, run_probed, small_demo, timed};
use basrelief_kernel::stats::FigureValue;
use basrelief_kernel::{Engine, Interval, Recorder};
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_signals::Lighting;
use std::collections::BTreeSet;

fn table(config: &BumpProcessorConfig, level: u8) -> Vec<[i16; 3]> {
    let set = config.replacement.table_set();
    set.normals(level, set.entries(level, None)).unwrap()
}

/// Returns the first index with the largest inner product, by exhaustive search.
fn nearest(table: &[[i16; 3]], n: [i16; 3]) -> u16 {
    let dot = |q: &[i16; 3]| (0..3).map(|i| i64::from(q[i]) * i64::from(n[i])).sum::<i64>();
    let best = table.iter().map(dot).max().unwrap();
    table.iter().position(|q| dot(q) == best).unwrap() as u16
}

/// Brightness of a reference normal: the lighting formula of the specification in double precision, viewer at +z.
fn formula(normal: [i16; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>().max(0.0);
    let (n, l) = (normal.map(|c| f64::from(c) / 32_767.0), TO_LIGHT.map(f64::from));
    let half = [l[0], l[1], l[2] + 1.0].map(|c| c / (2.0 + 2.0 * l[2]).sqrt());
    let Lighting { ka, kd, ks, n: exponent } = Lighting::default();
    f64::from(ka) + f64::from(kd) * dot(n, l) + f64::from(ks) * libm::pow(dot(n, half), f64::from(exponent))
}

/// Largest error of an 8-bit CLUT entry: half a step of full scale, ka + kd + ks.
const HALF_STEP: f64 = 0.5 * 1.3 / 255.0 + 1e-6;

fn used(ran: &Ran) -> Vec<u64> {
    let Some(FigureValue::Counts(used)) = ran.facts.get("reference_normals_used") else { panic!("{:?}", ran.facts) };
    used.clone()
}

// Claim: bump, 1, 7: Each MIP level has its own normal map and VQ table, without common vectors. N' becomes the nearest vector of
// its level.
#[test]
fn claim_1_7_each_level_has_its_own_map_and_table() {
    let config = config(&[]);
    let tables: Vec<_> = (0..8).map(|level| table(&config, level)).collect();
    let all: BTreeSet<_> = tables.iter().flatten().collect();
    assert_eq!(all.len(), 8 * 256, "no reference normal stands in two tables");
    let mut chain = Chain::new(&config);
    chain.begin_polygon(12, bumpy_map());
    let mut differ = 0;
    for i in 0..100 {
        let seen = chain.fragment([i as f32 / 200.0, (i * 7 % 50) as f32 / 100.0]);
        let n_prime = pseudo_normals(&seen);
        assert_eq!(n_prime.iter().map(|s| s.0).collect::<Vec<_>>(), [1, 2], "LOD 12 lies between levels 1 and 2");
        differ += usize::from(n_prime[0].2 != n_prime[1].2);
        for ((level, _, n), (_, _, index)) in n_prime.into_iter().zip(indexes(&seen)) {
            assert_eq!(index, nearest(&tables[usize::from(level)], n));
        }
    }
    assert!(differ > 90, "the maps of two levels differ");
}

// Claim: bump, 2, 6: The size of a table depends on the level and grows with resolution.
#[test]
fn claim_2_6_table_size_grows_with_resolution() {
    let entries = [64, 32, 16, 8, 4, 2, 1, 1];
    let ran = timed(
        &small_demo("brick", 1),
        &[("replacement.entries", "[64, 32, 16, 8, 4, 2, 1]"), ("replacement.resident_tables", "8")],
    );
    let used = used(&ran);
    let levels = || used.iter().zip(entries).filter(|(used, _)| **used > 0);
    assert!(levels().count() >= 5 && levels().all(|(used, entries)| *used <= entries), "{used:?}");
    // Each table is loaded once: three components of 16 bits per entry.
    assert_eq!(ran.count("vq_table_load_bytes"), levels().map(|(_, entries)| 6 * entries).sum::<u64>());
    assert_eq!(ran.bytes("tables"), ran.count("vq_table_load_bytes"));
}

// Claim: bump, 3: Tables are smaller than the number of distinct N'. The report shows exceptions.
#[test]
fn claim_3_tables_are_smaller_than_distinct_pseudo_normals() {
    let ran = timed(&small_demo("sphere", 1), &[("replacement.entries", "64")]);
    let tables = used(&ran).iter().filter(|n| **n > 0).count() as u64;
    assert!(ran.count("distinct_pseudo_normals") > 64 * tables, "{}", ran.count("distinct_pseudo_normals"));
    // The figure shows violations of the claim: a smooth surface has few N', with any table.
    let smooth = SceneRecipe { parts: vec![Part { bump: Some(true), ..sheet(Surface::Plain) }], ..one_frame() };
    assert!(timed(&smooth.scene(), &[]).count("distinct_pseudo_normals") < 256);
}

// Claim: bump, 4, 8: A CLUT per level holds, for each reference normal, its brightness under the light.
#[test]
fn claim_4_8_clut_per_level_holds_brightness_of_normals() {
    let config = config(&[]);
    let mut chain = Chain::new(&config);
    for level in 0..8 {
        for (i, q) in table(&config, level).into_iter().enumerate() {
            let seen = chain.replaced(single(level, q));
            assert_eq!((seen.indexes.samples[0].value[0], seen.indexes.samples[0].level), (i as u16, level));
            let error = f64::from(seen.shaded.brightness) - formula(q);
            assert!(error.abs() <= HALF_STEP, "level {level}, index {i}: {error}");
        }
    }
}

// Claim: bump, 7: Brightness computed per index, without a CLUT, differs by at most one step of the CLUT.
#[test]
fn claim_7_direct_brightness_differs_by_at_most_a_clut_step() {
    let scene = small_demo("sphere", 1);
    let (clut, direct) = (timed(&scene, &[]), timed(&scene, &[("brightness.source", "direct")]));
    assert!(clut.bytes("clut_read") > 0 && clut.bytes("clut_build") > 0);
    assert!(direct.bytes("clut_read") > 0, "reference normals instead of entries");
    assert_eq!((direct.bytes("clut_build"), direct.count("clut_rebuilds")), (0, 0));
    let (a, b) = (clut.frames[0].rgb.as_flattened(), direct.frames[0].rgb.as_flattened());
    assert!(a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1), "half a step of 1.3 / 255, and rounding");
    assert_ne!(a, b);
}

// Claim: bump, 5, 9: 2, 3 and 8 levels are mapped, quantized and fetched, then brightness is interpolated.
#[test]
fn claim_5_9_brightness_is_fetched_per_level_then_interpolated() {
    for levels in ["2", "3", "8"] {
        let config = config(&[("brightness.levels", levels), ("memory.normal_map.outstanding", "32")]);
        let mut chain = Chain::new(&config);
        // Five levels: LODs above 32 are clamped to the last.
        for lod in 0..=63 {
            chain.begin_polygon(lod, bumpy_map());
            let seen = chain.fragment([0.3, 0.4]);
            let all = indexes(&seen);
            assert!((all.iter().map(|s| s.1).sum::<f32>() - 1.0).abs() < 1e-6);
            let alone = |(level, weight, index): (u8, f32, u16)| {
                let reference = table(&config, level)[usize::from(index)];
                weight * chain.replaced(single(level, reference)).shaded.brightness
            };
            let sum: f32 = all.into_iter().map(alone).sum();
            assert!((seen.shaded.brightness - sum).abs() < 1e-5, "LOD {lod}");
        }
    }
}

// Claim: bump, worked example: LOD 3 divides the difference of two levels 3 : 5.
#[test]
fn lod_3_divides_the_difference_of_two_levels_3_to_5() {
    let mut chain = Chain::new(&config(&[]));
    let map = || uniform_map(&[[200, 100, 220], [60, 140, 210]]);
    let mut alpha = |lod| {
        chain.begin_polygon(lod, map());
        f64::from(chain.fragment([0.3, 0.3]).shaded.brightness)
    };
    let (fine, coarse) = (alpha(0), alpha(8));
    assert!((fine - coarse).abs() > 0.1);
    assert!((alpha(3) - (fine + (coarse - fine) * 3.0 / 8.0)).abs() < 1e-6);
}

// Claim: bump, two levels: The same N' at two levels gives two slightly different brightness values.
#[test]
fn same_n_prime_at_two_levels_gives_different_brightness() {
    let mut chain = Chain::new(&config(&[]));
    let mut differ = 0;
    for i in 0..200_i16 {
        let n = [100 * i, 32_767 - 50 * i, 20_000];
        let [a, b] = [0, 1].map(|level| chain.replaced(single(level, n)).shaded.brightness);
        assert!((a - b).abs() < 0.3, "{a} {b}");
        differ += usize::from(a != b);
    }
    assert!(differ > 150, "{differ} of 200");
}

// Claim: bump, 10: The functional model, without time, gives the same images.
#[test]
fn claim_10_functional_model_gives_the_same_pictures() {
    for settings in [&[][..], &[("rasterizer.early_z", "false"), ("graphics.draw", "after_list"), ("replacement.lanes", "1")]] {
        let scene = small_demo("coin", 3);
        let (pictures, _) = functional(&scene, &config(settings));
        let ran = timed(&scene, settings);
        assert_eq!(ran.frames, pictures);
        assert!(pictures.iter().all(|p| p.covered.contains(&true)));
    }
}

// Claim: bump, erratum: The nearest reference normal has the largest inner product; ties go to the lowest index.
#[test]
fn erratum_nearest_normal_has_the_largest_inner_product() {
    let config = config(&[]);
    let mut chain = Chain::new(&config);
    // Towards the light: the vector with the smallest inner product would be in the dark, ambient light alone.
    let seen = chain.replaced(single(0, TO_LIGHT.map(|c| (c * 32_767.0) as i16)));
    let q = table(&config, 0)[usize::from(seen.indexes.samples[0].value[0])];
    let cosine: f64 = (0..3).map(|i| f64::from(q[i]) / 32_767.0 * f64::from(TO_LIGHT[i])).sum();
    assert!(cosine > 0.98);
    assert!(seen.shaded.brightness > 0.8);
}

/// Figure 5B, indexes from 1.
const FIGURE_5B: [[u16; 6]; 6] =
    [[2, 1, 2, 3, 2, 7], [1, 5, 1, 5, 1, 5], [3, 1, 3, 1, 3, 1], [1, 6, 1, 6, 1, 6], [7, 8, 7, 7, 4, 7], [8, 4, 2, 4, 8, 4]];

// Claim: bump, Figures 5, 6: The index map becomes the brightness map, at three levels.
#[test]
fn figures_5_and_6_index_map_becomes_brightness_map() {
    let config = config(&[]);
    let mut chain = Chain::new(&config);
    // 6 x 6 pixels at level 0, 4 x 4 at level 1, 2 x 2 at level 2.
    for (level, side) in [(0, 6), (1, 4), (2, 2)] {
        let table = table(&config, level);
        for row in &FIGURE_5B[..side] {
            for &number in &row[..side] {
                let index = number - 1;
                // A little off the reference normal, as N' are.
                let n = table[usize::from(index)].map(|c| c / 2 + 300);
                let seen = chain.replaced(single(level, n));
                assert_eq!(seen.indexes.samples[0].value[0], index, "Figure 5B");
                let alpha = formula(table[usize::from(index)]);
                assert!((f64::from(seen.shaded.brightness) - alpha).abs() <= HALF_STEP, "Figure 5C");
            }
        }
    }
}

fn one_frame() -> SceneRecipe {
    SceneRecipe { parts: Vec::new(), size: [40, 30], frames: 1, point_light: false, moving: false }
}

fn sheet(surface: Surface) -> Part {
    let (shape, at, size) = (Shape::Sheet(3), [0.5, 0.5, 0.2], 1.0);
    Part { surface, shape, at, size, repeat: 2.0, entries: None, bump: None, double_sided: false }
}

// Claim: bump, Figure 4, S12: A trace without bump targets maps, searches and fetches nothing.
#[test]
fn figure_4_s12_list_without_bump_targets_is_drawn_at_once() {
    let parts = vec![sheet(Surface::Textured), Part { at: [0.7, 0.6, 0.0], ..sheet(Surface::Plain) }];
    let ran = timed(&SceneRecipe { parts, ..one_frame() }.scene(), &[]);
    assert!(ran.count("pixels") > 0);
    for none in ["bump_fragments", "searches", "clut_samples", "clut_rebuilds", "vq_table_loads"] {
        assert_eq!(ran.count(none), 0, "{none}");
    }
    for client in ["texels", "tables", "gathered", "clut_read", "clut_build"] {
        assert_eq!(ran.bytes(client), 0, "{client}");
    }
}

// Claim: bump, Figure 4, S14 to S22: Every fragment of every bump target is mapped, quantized, fetched.
#[test]
fn figure_4_s14_to_s22_every_bump_fragment_passes_all_steps() {
    let ran = timed(&small_demo("brick", 1), &[]);
    assert_eq!(ran.count("bump_polygons"), ran.count("polygons"));
    assert_eq!(ran.count("bump_fragments"), ran.count("pixels"));
    assert_eq!(ran.count("pseudo_normals"), ran.count("searches"));
    assert_eq!(ran.count("searches"), ran.count("clut_samples"));
    let per_fragment = ran.count("searches") as f64 / ran.count("bump_fragments") as f64;
    assert!(per_fragment > 1.0 && per_fragment <= 2.0, "one or two levels each");
}

/// Returns the first and the last cycle in which a unit was busy.
fn working(recorder: &Recorder, ran: &Ran, name: &str) -> (u64, u64) {
    let stage = ran.report.units.iter().position(|u| u.name == name).unwrap();
    let mut worked = recorder.stages[stage].iter().filter(|i| i.cause.is_none());
    let first: &Interval = worked.next().unwrap();
    (first.from.0, worked.next_back().unwrap_or(first).to.0)
}

// Claim: bump, Figure 4, S24: `after_list` draws after the last bump target; streaming gives the same image.
#[test]
fn figure_4_s24_deferred_and_streamed_pictures_are_equal() {
    let scene = small_demo("mixed", 1);
    let probed = |order| {
        let mut recorder = Recorder::default();
        let ran = run_probed(&scene, &config(&[("graphics.draw", order)]), Engine::Timed, &mut recorder);
        let times = ["brightness", "frame-buffer"].map(|name| working(&recorder, &ran, name));
        (ran, times)
    };
    let (streamed, [shading, drawing]) = probed("streamed");
    assert!(drawing.0 < shading.1);
    let (after, [shading, drawing]) = probed("after_list");
    assert!(drawing.0 >= shading.1, "nothing is drawn before the last bump target is shaded");
    assert_eq!(streamed.frames, after.frames);
    assert_eq!(streamed.bytes("held"), 0);
    let waiting = after.count("bump_fragments");
    assert!(0 < waiting && waiting < after.count("pixels"), "some polygons of this scene are no bump targets");
    assert_eq!(after.count("results_held"), waiting, "and those do not wait");
    // Each entry is written once and read once: a byte of brightness per fragment, and four bytes for the place of a stamp.
    let bytes = after.bytes("held");
    assert!((2 * 2 * waiting..=2 * 5 * waiting).contains(&bytes), "{bytes} bytes of {waiting} fragments");
}

/// The description promises that storing only indexes moves less memory than storing full normals. The test runs both.
// Claim: as indexes_move_fewer_bytes_than_full_normals.
#[test]
fn deferred_indexes_move_less_than_deferred_normals() {
    let scene = small_demo("golf-ball", 1);
    let single = ("rasterizer.stamp", "1");
    let held = |what| timed(&scene, &[("graphics.draw", "after_list"), ("graphics.held", what), single]);
    let [brightness, index, normal] = ["brightness", "index", "normal"].map(held);
    assert_eq!((&index.frames, &index.frames), (&normal.frames, &brightness.frames));
    let waiting = index.count("results_held");
    assert!(waiting > 0 && waiting == normal.count("results_held"));
    // Each fragment is written and read: four bytes of its position, and two levels of an 8-bit index or of three 16-bit components.
    assert_eq!([&brightness, &index, &normal].map(|ran| ran.bytes("held") / (2 * waiting)), [4 + 1, 4 + 2, 4 + 12]);
    let all = |ran: &Ran| {
        ran.report.memories.iter().flat_map(|m| &m.ports).map(|p| p.counts.read_bytes + p.counts.write_bytes).sum::<u64>()
    };
    assert_eq!(all(&normal) - all(&index), 2 * 10 * waiting, "nothing else differs");
}
