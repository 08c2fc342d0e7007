//! Tests of the unit's steps.

use super::*;
use crate::{NearestSearch, PerLevel, TableSource};
use basrelief_kernel::Request;
use basrelief_kernel::stats::UnitStats;
use basrelief_shading::{ReferenceNormals, reference_normals};
use basrelief_signals::{Fragment, Material, ObjectInfo, Polygon, Stamp, Vertex, quantization_memory};
use proptest::prelude::*;

fn config() -> ReplacementConfig {
    ReplacementConfig::default()
}

fn sample(x: u16, samples: &[(u8, [i16; 3])]) -> PseudoNormals {
    let weight = 1.0 / samples.len() as f32;
    PseudoNormals {
        stamp: Stamp::from_iter([Fragment { x, ..Fragment::default() }]),
        samples: samples.iter().map(|&(level, normal)| StampSample::all(level, weight, normal)).collect(),
    }
}

fn object(id: u32, entries: Option<u32>) -> Control {
    Control::Object(Arc::new(ObjectInfo { id, name: format!("object {id}"), entries, ..ObjectInfo::default() }))
}

fn polygon() -> Control {
    Control::Polygon(Arc::new(Polygon {
        vertices: vec![Vertex::default(); 3],
        material: Arc::new(Material::default()),
        object: 0,
        lod: 0,
        bump: true,
        arrival: 0,
    }))
}

/// Runs a list of tokens through the unit. Returns its outputs and all requests.
fn run(unit: &mut Replacement, input: Vec<Flow<PseudoNormals>>) -> (Vec<Out>, Vec<Request>) {
    let (mut steps, mut requests) = (Vec::new(), Vec::new());
    let mut input = input.into_iter();
    loop {
        let token = if unit.demand() == Demand::All { input.next() } else { None };
        if token.is_none() && unit.demand() == Demand::All {
            break;
        }
        let mut traffic = MemoryPorts::default();
        steps.push(unit.step(token, &mut traffic));
        for client in 0..2 {
            let issued = traffic.requests().iter().filter(|r| r.client == client).count();
            assert!(issued as u32 <= unit.largest_step(client as usize));
        }
        requests.extend_from_slice(traffic.requests());
    }
    (steps, requests)
}

fn out(steps: &[Out]) -> Vec<&Flow<NormalIndexes>> {
    steps.iter().filter_map(|s| s.out.as_ref()).collect()
}

fn indexes(steps: &[Out]) -> Vec<NormalIndexes> {
    let item = |f: &&Flow<NormalIndexes>| match f {
        Flow::Item(i) => Some(i.clone()),
        Flow::Control(_) => None,
    };
    out(steps).iter().filter_map(item).collect()
}

// Claim: as claim_1_7_each_level_has_its_own_map_and_table.
#[test]
fn claims_1_and_7_each_level_uses_its_own_table() {
    let n = [12_000, -30_000, 5_000];
    let mut unit = Replacement::new(config(), 16, &Operators::default()).unwrap();
    let (steps, _) = run(&mut unit, vec![Flow::Item(sample(1, &[(0, n), (1, n)]))]);
    let found = indexes(&steps)[0].samples.clone();
    assert_eq!([0, 1].map(|i| (found[i].level, found[i].weight[0])), [(0, 0.5), (1, 0.5)]);
    let chosen =
        |level: u8, i: u16| reference_normals(level, 256, ReferenceNormals::Fibonacci, true, 16).unwrap()[usize::from(i)];
    let (a, b) = (chosen(0, found[0].value[0]), chosen(1, found[1].value[0]));
    assert_ne!(a, b, "the same N' at two levels gives two slightly different vectors");
    for q in [a, b] {
        let dot: f64 = (0..3).map(|i| f64::from(q[i]) * f64::from(n[i])).sum();
        assert!(dot / 32_767.0 / f64::from(n[0]).hypot(f64::from(n[1])).hypot(f64::from(n[2])) > 0.98);
    }
}

#[test]
fn identical_tables_give_same_index_at_every_level() {
    let n = [12_000, -30_000, 5_000];
    let mut unit =
        Replacement::new(ReplacementConfig { tables: TableSource::Identical, ..config() }, 16, &Operators::default()).unwrap();
    let (steps, _) = run(&mut unit, vec![Flow::Item(sample(1, &[(0, n), (1, n), (5, n)]))]);
    let found: Vec<u16> = indexes(&steps)[0].samples.iter().map(|s| s.value[0]).collect();
    assert_eq!(found, [found[0]; 3]);
}

// Claim: as claim_2_6_table_size_grows_with_resolution.
#[test]
fn claims_2_and_6_table_size_depends_on_level() {
    let entries = PerLevel::Levels(vec![256, 128, 64, 32]);
    let mut unit =
        Replacement::new(ReplacementConfig { entries, resident_tables: 8, ..config() }, 16, &Operators::default()).unwrap();
    let directions = reference_normals(7, 4_000, ReferenceNormals::Fibonacci, true, 16).unwrap();
    let input = directions.iter().map(|&n| Flow::Item(sample(0, &[(0, n), (1, n), (2, n), (7, n)]))).collect();
    let (_, requests) = run(&mut unit, input);
    assert_eq!(unit.state.counters.reference_normals_used(), [256, 128, 64, 0, 0, 0, 0, 32]);
    assert_eq!(unit.state.counters.table_loads, 4);
    let bytes = 6 * (256 + 128 + 64 + 32);
    assert_eq!(unit.state.counters.table_load_bytes, bytes);
    assert_eq!(requests.iter().map(|r| u64::from(r.bytes)).sum::<u64>(), bytes);
}

#[test]
fn missing_table_is_loaded_in_bursts_first() {
    let mut unit = Replacement::new(config(), 16, &Operators::default()).unwrap();
    let (steps, requests) =
        run(&mut unit, vec![Flow::Item(sample(1, &[(2, [1, 2, 3])])), Flow::Item(sample(2, &[(2, [3, 2, 1])]))]);
    assert_eq!(requests.len(), 24);
    assert_eq!(requests[0].address, quantization_memory::vq_table(2));
    assert!(steps[..24].iter().all(|s| s.out.is_none()) && steps[24].out.is_some());
    assert_eq!(steps.len(), 26, "the second fragment finds the table");
}

#[test]
fn least_recently_used_table_is_replaced() {
    let mut unit = Replacement::new(ReplacementConfig { resident_tables: 2, ..config() }, 16, &Operators::default()).unwrap();
    let at = |level| Flow::Item(sample(0, &[(level, [1, 2, 3])]));
    run(&mut unit, [0, 1, 0, 2, 0, 1].map(at).to_vec());
    assert_eq!(unit.state.counters.table_loads, 4, "0, 1, 2 (for 1), 1 (for 2)");
}

#[test]
fn object_fixes_entries_and_bias_coarsens_table() {
    let mut unit = Replacement::new(ReplacementConfig { vq_bias: 3, ..config() }, 16, &Operators::default()).unwrap();
    let n = [0, 0, -32_767];
    let input = vec![Flow::Control(object(0, Some(16))), Flow::Item(sample(0, &[(1, n), (6, n)]))];
    let (steps, _) = run(&mut unit, input);
    let found = indexes(&steps)[0].samples.clone();
    assert_eq!([found[0].level, found[1].level], [4, 7]);
    assert!(found[0].value[0] < 16);
    let expected = NearestSearch::new(&reference_normals(4, 16, ReferenceNormals::Fibonacci, true, 16).unwrap(), 0).nearest(n);
    assert_eq!(found[0].value[0], expected);
}

#[test]
fn impossible_table_is_an_error() {
    let tetrahedron = ReplacementConfig { table: ReferenceNormals::Tetrahedron, ..config() };
    assert!(
        Replacement::new(ReplacementConfig { entries: PerLevel::One(200), ..tetrahedron.clone() }, 16, &Operators::default())
            .is_err()
    );
    let mut unit = Replacement::new(tetrahedron, 16, &Operators::default()).unwrap();
    unit.step(Some(Flow::Control(object(0, Some(5)))), &mut MemoryPorts::default());
    let mut traffic = MemoryPorts::default();
    unit.step(Some(Flow::Item(sample(0, &[(0, [1, 0, 0])]))), &mut traffic);
    unit.step(None, &mut traffic);
    assert!(format!("{traffic:?}").contains("object `object 0` fixes"), "{traffic:?}");
}

#[test]
fn cycles_follow_lanes_and_pipelining() {
    let timing = |lanes, pipelined| {
        let mut unit = Replacement::new(ReplacementConfig { lanes, pipelined, ..config() }, 16, &Operators::default()).unwrap();
        let two = sample(0, &[(0, [1, 2, 3]), (1, [1, 2, 3])]);
        let (steps, _) = run(&mut unit, vec![Flow::Item(two.clone()), Flow::Item(two)]);
        let last = steps.last().unwrap();
        (last.occupancy, last.latency)
    };
    // Product, two sums, and trees of comparisons over all lanes and over all rows. The last row enters after the others.
    assert_eq!(timing(64, true), (2, 3 + 6 + 2 + 4));
    assert_eq!(timing(64, false), (8, 3 + 6 + 2 + 7));
    assert_eq!(timing(1, false), (512, 3 + 8 + 511));
    assert_eq!(timing(256, false), (2, 3 + 8 + 1));
}

#[test]
fn pipelined_search_passes_normals_from_row_to_row() {
    let bits = |lanes, pipelined| {
        let unit = Replacement::new(ReplacementConfig { lanes, pipelined, ..config() }, 16, &Operators::default()).unwrap();
        let mut stats = UnitStats::default();
        unit.report_stats(&mut stats);
        let registers = stats.all_hardware().iter().filter(|piece| piece.about.starts_with("N' on its way"));
        registers.map(|piece| piece.bits()).sum::<u64>()
    };
    // 256 entries in rows of 64 lanes: N' waits once before each row but the first.
    assert_eq!([bits(64, true), bits(64, false), bits(256, true)], [3 * 3 * 16, 0, 0]);
}

#[test]
fn each_resident_table_has_an_entry_of_the_directory() {
    let pieces = |resident_tables, codebook| {
        let unit =
            Replacement::new(ReplacementConfig { resident_tables, codebook, ..config() }, 16, &Operators::default()).unwrap();
        let mut stats = UnitStats::default();
        unit.report_stats(&mut stats);
        let of = |about: &str| {
            let piece = stats.all_hardware().iter().find(|piece| piece.about.starts_with(about));
            piece.map_or((0, 0), |piece| (piece.count, piece.width))
        };
        ["resident VQ tables", "key of an entry", "order of use"].map(of)
    };
    // Level, size, a valid bit, and the position among 8.
    assert_eq!(pieces(8, CodeBookMode::Fixed), [(8, 3 + 17 + 1 + 3), (8, 3), (16, 3)]);
    assert_eq!(pieces(1, CodeBookMode::Fixed), [(1, 3 + 17 + 1), (1, 3), (0, 0)]);
    assert_eq!(pieces(8, CodeBookMode::PerObject), [(0, 0); 3], "there is only the table in use");
}

#[test]
fn stamp_occupancy_follows_its_samples() {
    let timing = |pipelined| {
        let mut unit =
            Replacement::new(ReplacementConfig { lanes: 64, pipelined, ..config() }, 16, &Operators::default()).unwrap();
        let mut three = sample(0, &[(0, [1, 2, 3]), (1, [1, 2, 3])]);
        let fragment = three.stamp[0];
        three.stamp.extend([fragment; 2]);
        let (steps, _) = run(&mut unit, vec![Flow::Item(three.clone()), Flow::Item(three)]);
        let last = steps.last().unwrap();
        assert_eq!((indexes(&steps)[1].stamp.len(), unit.state.counters.searches), (3, 12));
        (last.occupancy, last.latency)
    };
    assert_eq!(timing(true), (6, 11 + 5 + 3));
    assert_eq!(timing(false), (24, 11 + 23));
}

fn gathered(mode: CodeBookMode) -> (Replacement, Vec<Out>, Vec<Request>) {
    let mut unit = Replacement::new(ReplacementConfig { codebook: mode, ..config() }, 16, &Operators::default()).unwrap();
    let item = |x: u16| Flow::Item(sample(x, &[(0, [x as i16, 100, 7]), (1, [100, x as i16, 7])]));
    let input = vec![
        Flow::Control(object(0, None)),
        Flow::Control(polygon()),
        item(1),
        item(2),
        Flow::Control(polygon()),
        Flow::Control(polygon()),
        item(3),
        Flow::Control(object(1, None)),
        Flow::Control(polygon()),
        Flow::Control(Control::FrameEnd),
    ];
    let (steps, requests) = run(&mut unit, input);
    (unit, steps, requests)
}

fn shape(steps: &[Out]) -> String {
    let letter = |f: &&Flow<NormalIndexes>| match f {
        Flow::Item(i) => char::from(b'0' + i.stamp[0].x as u8),
        Flow::Control(Control::Object(_)) => 'O',
        Flow::Control(Control::Polygon(_)) => 'P',
        Flow::Control(Control::CodeBook(_)) => 'B',
        Flow::Control(Control::Frame(_)) => 'F',
        Flow::Control(Control::FrameEnd) => 'E',
        Flow::Control(Control::Criterion(_)) => 'C',
    };
    out(steps).iter().map(letter).collect()
}

#[test]
fn code_book_precedes_fragments_in_order() {
    let (unit, steps, requests) = gathered(CodeBookMode::PerPolygon);
    assert_eq!(shape(&steps), "OPB12PPB3OPE");
    assert!(unit.is_empty());
    assert_eq!(unit.state.counters.code_books, 2);
    assert!(requests.iter().all(|r| r.client == 1));
    // Two samples of 6 bytes each. Beside them lie position, depth, weights, triangle and two shares: 158 bits.
    let c = &unit.state.counters;
    assert_eq!((c.gathered_bytes, c.held_beside_bytes), (3 * 12, 3 * 20), "control ends both batches");
    let (_, steps, _) = gathered(CodeBookMode::PerObject);
    assert_eq!(shape(&steps), "OPB12PP3OPE");
}

#[test]
fn variants_b_and_e_index_into_the_code_book() {
    for mode in [CodeBookMode::PerPolygon, CodeBookMode::PerObject] {
        let (_, steps, _) = gathered(mode);
        let mut book = Arc::new(Vec::new());
        for flow in out(&steps) {
            match flow {
                Flow::Control(Control::CodeBook(b)) => book = Arc::clone(b),
                Flow::Item(i) => {
                    let q = book[0][usize::from(i.samples[0].value[0])].map(f64::from);
                    let n = [f64::from(i.stamp[0].x), 100.0, 7.0];
                    let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
                    let cosine = (0..3).map(|k| q[k] * n[k]).sum::<f64>() / length(q) / length(n);
                    assert!(cosine > 0.999_999, "few distinct N': each has an entry of its own");
                    assert!(book[1].len() > usize::from(i.samples[1].value[0]) && book[2].is_empty());
                }
                Flow::Control(_) => {}
            }
        }
    }
}

/// Runs 100 directions all over the sphere, one per fragment, as one batch of a code book of `entries` entries.
fn clustered(codebook: CodeBookMode, entries: u32) -> (Replacement, Vec<Out>, Vec<Request>) {
    let config = ReplacementConfig { codebook, entries: PerLevel::One(entries), lanes: 8, ..config() };
    let mut unit = Replacement::new(config, 16, &Operators::default()).unwrap();
    let normals = reference_normals(0, 100, ReferenceNormals::Fibonacci, true, 16).unwrap();
    let mut input: Vec<_> = normals.iter().map(|&n| Flow::Item(sample(0, &[(0, n)]))).collect();
    input.push(Flow::Control(Control::FrameEnd));
    let (steps, requests) = run(&mut unit, input);
    (unit, steps, requests)
}

#[test]
fn clustering_pass_reads_all_gathered_normals() {
    let (unit, _, requests) = clustered(CodeBookMode::PerPolygon, 4);
    let c = &unit.state.counters;
    let means = c.clustering_passes - 1 - 4;
    assert!((2..=8).contains(&means), "{c:?}");
    let sent_back = c.gathered_bytes + c.held_beside_bytes;
    let read: u64 = requests.iter().filter(|r| !r.write).map(|r| u64::from(r.bytes)).sum();
    assert_eq!(read, (1 + 4 + means) * 600 + 4 * 400 + sent_back, "and the best product so far with each seed");
    let written: u64 = requests.iter().filter(|r| r.write).map(|r| u64::from(r.bytes)).sum();
    assert_eq!(written, sent_back + 600 + 4 * 400 + 4 * 6, "directions, best products, the code book itself");
    let table = |r: &&Request| r.write && r.address == quantization_memory::vq_table(0);
    assert_eq!(requests.iter().filter(table).map(|r| r.bytes).collect::<Vec<_>>(), [24]);
}

#[test]
fn directions_seeds_and_small_books_take_arithmetic() {
    // One divider and one square-root unit per direction. A seed costs an inner product per direction, eight at a time.
    let cycles = |entries| clustered(CodeBookMode::PerPolygon, entries).0.state.counters;
    let small = cycles(100);
    assert_eq!(
        (small.clustering_passes, small.clustering_cycles),
        (1, 100 * 13 + 10),
        "each searched in 100 entries, and ten writes"
    );
    let large = cycles(4);
    let means = large.clustering_passes - 5;
    assert_eq!(large.clustering_cycles, 100 + 4 * 16 + means * (100 + 4) + 1, "16 steps of 64 bytes, at least a cycle each");
}

#[test]
fn variants_b_and_e_cluster_surplus_normals() {
    for mode in [CodeBookMode::PerPolygon, CodeBookMode::PerObject] {
        let (unit, steps, _) = clustered(mode, 4);
        assert_eq!(unit.state.counters.code_books, 1);
        let book = out(&steps).into_iter().find_map(|f| if let Flow::Control(Control::CodeBook(b)) = f { Some(b) } else { None });
        assert_eq!(book.unwrap()[0].len(), 4);
        let mut members = [0; 4];
        indexes(&steps).iter().for_each(|i| members[usize::from(i.samples[0].value[0])] += 1);
        assert_eq!(members.iter().sum::<i32>(), 100);
        assert!(members.iter().all(|n| *n > 10), "all are quantized to few: {members:?}");
    }
}

#[test]
fn table_loads_do_not_depend_on_stamp_size() {
    let loads = |resident_tables, stamp: u16| {
        let mut unit = Replacement::new(ReplacementConfig { resident_tables, ..config() }, 16, &Operators::default()).unwrap();
        let fragments = (0..12).collect::<Vec<u16>>();
        let token = |columns: &[u16]| {
            let one = sample(0, &[(0, [1, 2, 3]), (1, [1, 2, 3])]);
            let stamp = columns.iter().map(|&x| Fragment { x, ..Fragment::default() }).collect();
            Flow::Item(PseudoNormals { stamp, ..one })
        };
        run(&mut unit, fragments.chunks(usize::from(stamp)).map(token).collect());
        unit.state.counters.table_loads
    };
    assert_eq!([1, 2, 4].map(|stamp| loads(1, stamp)), [24; 3], "both tables for every fragment");
    assert_eq!([1, 2, 4].map(|stamp| loads(2, stamp)), [2; 3]);
}

#[test]
fn object_importance_coarsens_its_table() {
    let level = |bias| {
        let mut unit = Replacement::new(ReplacementConfig { vq_bias: 1, ..config() }, 16, &Operators::default()).unwrap();
        let object = ObjectInfo { bias, ..ObjectInfo::default() };
        let input = vec![Flow::Control(Control::Object(Arc::new(object))), Flow::Item(sample(0, &[(1, [0, 0, 1])]))];
        indexes(&run(&mut unit, input).0)[0].samples[0].level
    };
    assert_eq!([None, Some(0), Some(3)].map(level), [2, 1, 4], "its own word goes before the configuration's");
}

#[test]
fn policy_follows_fragments_of_last_frame() {
    let config = ReplacementConfig { policy: TablePolicy::ByFragments, fragments_per_entry: 1, ..config() };
    let mut unit = Replacement::new(config, 16, &Operators::default()).unwrap();
    let frame = || {
        let (lights, textures) = (vec![], vec![]);
        Flow::Control(Control::Frame(Arc::new(basrelief_signals::Frame {
            width: 1,
            height: 1,
            lights,
            textures,
            ..basrelief_signals::Frame::default()
        })))
    };
    let mut entries = |fragments: usize| {
        let mut input = vec![frame(), Flow::Control(object(3, None))];
        input.extend(vec![Flow::Item(sample(0, &[(0, [1, 2, 3])])); fragments]);
        let (steps, _) = run(&mut unit, input);
        out(&steps).iter().find_map(|f| if let Flow::Control(Control::Object(o)) = f { Some(o.entries) } else { None }).unwrap()
    };
    assert_eq!([60, 10, 500, 0, 0].map(&mut entries), [None, Some(64), Some(16), Some(256), None]);
}

#[test]
fn too_little_gather_room_fault_names_culprit_and_cure() {
    let config = ReplacementConfig { codebook: CodeBookMode::PerObject, gather_bytes: 75, ..config() };
    let mut unit = Replacement::new(config, 16, &Operators::default()).unwrap();
    unit.step(Some(Flow::Control(object(5, None))), &mut MemoryPorts::default());
    let mut traffic = MemoryPorts::default();
    for _ in 0..4 {
        unit.step(Some(Flow::Item(sample(0, &[(0, [1, 2, 3])]))), &mut traffic);
    }
    let text = format!("{traffic:?}");
    for part in ["object 5 `object 5`", "100 bytes so far", "`replacement.gather_bytes` is 75", "per_polygon"] {
        assert!(text.contains(part), "{text}");
    }
    assert!(!unit.is_empty());
}

#[test]
fn state_survives_checkpoint_within_batch() {
    let config = ReplacementConfig { codebook: CodeBookMode::PerPolygon, ..config() };
    let mut a = Replacement::new(config.clone(), 16, &Operators::default()).unwrap();
    let item = |x: u16| Some(Flow::Item(sample(x, &[(0, [x as i16, 100, 7])])));
    for x in 0..9 {
        a.step(item(x), &mut MemoryPorts::default());
    }
    a.step(Some(Flow::Control(Control::FrameEnd)), &mut MemoryPorts::default());
    a.step(None, &mut MemoryPorts::default());
    a.step(None, &mut MemoryPorts::default());
    let mut b = Replacement::new(config, 16, &Operators::default()).unwrap();
    b.state = serde_json::from_str(&serde_json::to_string(&a.state).unwrap()).unwrap();
    assert_eq!(a.state, b.state);
    while a.demand() == Demand::Nothing {
        assert_eq!(a.step(None, &mut MemoryPorts::default()), b.step(None, &mut MemoryPorts::default()));
    }
    assert_eq!(b.demand(), Demand::All);
}

proptest! {
    #[test]
    fn no_token_is_lost_or_reordered(
        tokens in prop::collection::vec(0u8..8, 0..60), mode in 0u8..3, resident in 1u32..4,
    ) {
        let codebook = [CodeBookMode::Fixed, CodeBookMode::PerPolygon, CodeBookMode::PerObject][usize::from(mode)];
        let config = ReplacementConfig { codebook, resident_tables: resident, ..config() };
        let mut unit = Replacement::new(config, 16, &Operators::default()).unwrap();
        let token = |(i, kind): (usize, &u8)| match kind {
            0 => Flow::Control(object(i as u32, None)),
            1 => Flow::Control(polygon()),
            _ => Flow::Item(sample(i as u16, &[(*kind, [i as i16, 3, 1])])),
        };
        let mut input: Vec<_> = tokens.iter().enumerate().map(token).collect();
        input.push(Flow::Control(Control::FrameEnd));
        let (steps, requests) = run(&mut unit, input.clone());
        prop_assert!(unit.is_empty());
        let passed: Vec<Flow<u16>> = out(&steps).iter().filter_map(|f| match f {
            Flow::Control(Control::CodeBook(_)) => None,
            Flow::Control(c) => Some(Flow::Control(c.clone())),
            Flow::Item(i) => Some(Flow::Item(i.stamp[0].x)),
        }).collect();
        let expected: Vec<Flow<u16>> = input.into_iter().map(|f| match f {
            Flow::Control(c) => Flow::Control(c),
            Flow::Item(p) => Flow::Item(p.stamp[0].x),
        }).collect();
        prop_assert_eq!(passed, expected);
        let bytes = |write| requests.iter().filter(|r| r.write == write).map(|r| u64::from(r.bytes)).sum::<u64>();
        let c = &unit.state.counters;
        let book = |f: &&Flow<NormalIndexes>| match f {
            Flow::Control(Control::CodeBook(lists)) => lists.iter().map(|list| 6 * list.len() as u64).sum(),
            _ => 0,
        };
        // Few directions: one pass reads them all, and writes them back.
        let books: u64 = out(&steps).iter().map(book).sum();
        prop_assert_eq!(bytes(true), 2 * c.gathered_bytes + c.held_beside_bytes + books);
        prop_assert_eq!(bytes(false), 2 * c.gathered_bytes + c.held_beside_bytes + c.table_load_bytes);
    }
}

#[test]
fn search_waits_for_last_read_of_its_table() {
    let mut unit = Replacement::new(config(), 16, &Operators::default()).unwrap();
    let (steps, _) = run(&mut unit, vec![Flow::Item(sample(1, &[(2, [1, 2, 3])]))]);
    let blocking: Vec<usize> = (0..steps.len()).filter(|&step| steps[step].blocking).collect();
    assert_eq!(blocking, [23], "the last of 24 reads");
}

#[test]
fn search_of_gathered_normals_begins_with_their_data() {
    let config = ReplacementConfig { codebook: CodeBookMode::PerObject, ..config() };
    let mut unit = Replacement::new(config, 16, &Operators::default()).unwrap();
    let item = |x| Flow::Item(sample(x, &[(0, [1, 2, 3])]));
    let (steps, _) = run(
        &mut unit,
        vec![Flow::Control(object(0, None)), Flow::Control(polygon()), item(1), item(2), Flow::Control(Control::FrameEnd)],
    );
    let sent: Vec<&Out> = steps.iter().filter(|step| matches!(step.out, Some(Flow::Item(_)))).collect();
    assert_eq!(sent.len(), 2);
    assert!(sent.iter().all(|step| step.blocking && u64::from(step.after_data) == step.latency));
    let passes = steps.iter().filter(|step| step.blocking && step.out.is_none()).count() as u64;
    assert_eq!(passes, unit.state.counters.clustering_passes, "a pass ends before the next one begins");
}

#[test]
fn index_leaves_after_last_row_and_no_token_overtakes() {
    let mut unit = Replacement::new(ReplacementConfig { lanes: 64, ..config() }, 16, &Operators::default()).unwrap();
    let (steps, _) = run(&mut unit, vec![Flow::Item(sample(1, &[(0, [1, 2, 3])])), Flow::Control(Control::FrameEnd)]);
    let [.., search, end] = &steps[..] else { panic!("two tokens") };
    // Product, two sums, six levels over lanes, two over rows. The last of four rows enters three cycles after the first.
    assert_eq!((search.occupancy, search.latency), (4, 3 + 1 + 2 + 6 + 2));
    assert_eq!(search.occupancy + end.latency, search.latency + 1);
}

// Claim: bump, policy: Memory (120) holds the VQ tables of every size at an address of their own.
#[test]
fn table_of_another_size_is_loaded_from_its_own_address() {
    let mut unit = Replacement::new(config(), 16, &Operators::default()).unwrap();
    let at = |entries| [Flow::Control(object(0, entries)), Flow::Item(sample(0, &[(1, [1, 2, 3])]))];
    let (_, requests) = run(&mut unit, [None, Some(128), Some(64), Some(128)].into_iter().flat_map(at).collect());
    let own = quantization_memory::vq_table(1);
    assert_eq!(requests[0].address, own, "the configured size");
    let (of_128, of_64) = (8 * 768, 8 * 384);
    let other = quantization_memory::OTHER_TABLES;
    assert_eq!(requests[24].address, other + 768, "level 1 of 128 entries");
    assert_eq!(requests[24 + 12].address, other + of_128 + 384, "level 1 of 64 entries");
    assert_eq!(unit.state.places.bytes(), of_128 + of_64);
    assert_eq!(unit.state.counters.table_loads, 3, "two are resident");
}
