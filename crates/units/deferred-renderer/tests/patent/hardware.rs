//! Tables of the units follow from the rates at which they are accessed.

use basrelief_deferred_renderer::{
    CellConfig, CellFormat, EngineConfig, Identification, PyramidCut, Rasterization, ReferenceBuffer, RenderMode, TableSizes,
    TileLists, TileOrder, ViewpointEnds,
};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Hardware, Unit};

/// Returns the hardware of a unit whose purpose starts with `about`.
fn piece(unit: &impl Unit, about: &str) -> Hardware {
    let mut stats = UnitStats::default();
    unit.report_stats(&mut stats);
    stats.all_hardware().iter().find(|piece| piece.about.starts_with(about)).expect("the unit has this piece").clone()
}

/// Returns words, width and ports of a table.
fn table(unit: &impl Unit, about: &str) -> (u64, u32, u32) {
    let Hardware { count, width, ports, .. } = piece(unit, about);
    (count, width, ports)
}

fn sizes(cut: PyramidCut, engine: &EngineConfig) -> TableSizes {
    TableSizes::new(&CellConfig::default(), cut, engine)
}

/// Returns the final rasterization of a device.
fn rasterization(engine: EngineConfig, mode: RenderMode, cut: PyramidCut) -> Rasterization {
    let (format, sizes) = (CellFormat::new(&CellConfig::default(), 1.0), sizes(cut, &engine));
    Rasterization::new(engine, mode, ViewpointEnds::default(), format, sizes)
}

#[test]
fn tile_lists_have_a_port_per_access() {
    let lists = |list_rate, scan_rate, mode, order| {
        let engine = EngineConfig { list_rate, scan_rate, ..EngineConfig::default() };
        let sizes = sizes(PyramidCut::default(), &engine);
        TileLists::new(engine, mode, order, sizes, ViewpointEnds::default())
    };
    let of = |list_rate, scan_rate, mode| table(&lists(list_rate, scan_rate, mode, TileOrder::Listed), "tile load lists");
    // A gigabyte holds 65,536 tiles of 64 x 64 texels. A port reads, one writes, four read sources.
    assert_eq!(of(16, 1, RenderMode::Best), (4096, 32, 6));
    assert_eq!(of(1024, 1, RenderMode::Best), (64, 2048, 6));
    assert_eq!(of(16, 4, RenderMode::Best), (4096, 32, 6), "all tiles are present: no search");
    assert_eq!([1, 4].map(|rate| of(16, rate, RenderMode::Progressive).2), [7, 10], "the search reads words, too");
    let Hardware { entries, finds_first, .. } = piece(&lists(16, 1, RenderMode::Best, TileOrder::Listed), "tile load lists");
    assert_eq!((entries, finds_first), (16, true), "a circuit finds the next tile in state L");
    let ordered = lists(16, 1, RenderMode::Best, TileOrder::Pixels);
    assert_eq!(table(&ordered, "pixels and distance"), (65_536, 64, 2), "a mark is added to its tile");
}

#[test]
fn layer_table_ends_at_largest_dmax() {
    let rows = |most_depth| {
        let cut = PyramidCut { most_depth, ..PyramidCut::default() };
        let unit = rasterization(EngineConfig::default(), RenderMode::Best, cut);
        ["pages (132)", "layers: size"].map(|about| table(&unit, about).0)
    };
    // 2,048 pages. A texture of 16,384 texels has 256 tiles of 64 in a row, so 9 layers.
    assert_eq!([0, 3, 8, 31].map(rows), [1, 4, 9, 9].map(|layers| [2_048, 2_048 * layers]));
}

#[test]
fn page_tables_have_a_port_per_layer_of_a_cycle() {
    let ports = |scan_rate, interpolation_rate, mode| {
        let engine = EngineConfig { scan_rate, interpolation_rate, ..EngineConfig::default() };
        let unit = rasterization(engine, mode, PyramidCut::default());
        ["pages (132)", "layers: size"].map(|about| table(&unit, about).2)
    };
    for mode in [RenderMode::Best, RenderMode::Progressive] {
        assert_eq!([[1, 1], [16, 2], [2, 4]].map(|[scan, between]| ports(scan, between, mode)), [[1; 2], [16; 2], [4; 2]]);
    }
    assert_eq!(ports(16, 2, RenderMode::Conventional), [2; 2], "nothing is searched");
}

#[test]
fn modes_without_identification_have_no_operators_for_it() {
    let operators = |mode| {
        let engine = EngineConfig::default();
        let sizes = sizes(PyramidCut::default(), &engine);
        let mut stats = UnitStats::default();
        Identification::new(engine, mode, sizes).report_stats(&mut stats);
        stats.all_hardware().len()
    };
    assert!(operators(RenderMode::Best) > 0);
    assert_eq!([RenderMode::Progressive, RenderMode::Conventional].map(operators), [0; 2]);
}

#[test]
fn each_gathered_block_has_a_comparator() {
    let comparators = |write_lines| {
        let engine = EngineConfig { write_lines, ..EngineConfig::default() };
        let sizes = sizes(PyramidCut::default(), &engine);
        let buffer = ReferenceBuffer::new(engine, RenderMode::Best, 8, sizes);
        let [lines, search] = ["gathered lines", "whether a line is gathered"].map(|about| piece(&buffer, about));
        (lines.count, lines.width - 16 * (sizes.cell_bits + 1), search.count, search.width)
    };
    // A block has 4 x 4 cells. Both store and comparators hold the number of a block among 2^20.
    assert_eq!([1, 8].map(comparators), [(1, 20, 1, 20), (8, 20, 8, 20)]);
}

#[test]
fn progressive_search_has_multipliers_of_its_rate() {
    let multipliers = |mode| {
        let engine = EngineConfig { scan_rate: 4, interpolation_rate: 2, ..EngineConfig::default() };
        piece(&rasterization(engine, mode, PyramidCut::default()), "texels and tiles").count
    };
    // Four products place a pixel, and one finds its tile.
    assert_eq!([RenderMode::Best, RenderMode::Progressive].map(multipliers), [2 * 5, 4 * 5]);
}
