//! Tables of the units follow from the rates at which they are accessed.

use basrelief_deferred_renderer::{
    CellConfig, CellFormat, EngineConfig, Identification, PyramidCut, Rasterization, RenderMode, TableSizes, TileLists,
    TileOrder, ViewpointEnds,
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
    let ordered = lists(16, 1, RenderMode::Best, TileOrder::Pixels);
    assert_eq!(table(&ordered, "pixels and distance"), (65_536, 64, 2), "a mark is added to its tile");
}

#[test]
fn layer_table_ends_at_largest_dmax() {
    let rows = |most_depth| {
        let engine = EngineConfig::default();
        let sizes = sizes(PyramidCut { most_depth, ..PyramidCut::default() }, &engine);
        ["pages (132)", "layers: size"].map(|about| table(&Identification::new(engine.clone(), sizes), about).0)
    };
    // 2,048 pages. A texture of 16,384 texels has 256 tiles of 64 in a row, so 9 layers.
    assert_eq!([0, 3, 8, 31].map(rows), [1, 4, 9, 9].map(|layers| [2_048, 2_048 * layers]));
}

#[test]
fn page_tables_have_a_port_per_layer_of_a_cycle() {
    let ports = |scan_rate, interpolation_rate| {
        let engine = EngineConfig { scan_rate, interpolation_rate, ..EngineConfig::default() };
        let sizes = sizes(PyramidCut::default(), &engine);
        ["pages (132)", "layers: size"].map(|about| table(&Identification::new(engine.clone(), sizes), about).2)
    };
    assert_eq!([ports(1, 1), ports(16, 2), ports(2, 4)], [[1; 2], [16; 2], [4; 2]]);
}

#[test]
fn progressive_search_has_multipliers_of_its_rate() {
    let multipliers = |mode| {
        let engine = EngineConfig { scan_rate: 4, interpolation_rate: 2, ..EngineConfig::default() };
        let (format, sizes) = (CellFormat::new(&CellConfig::default(), 1.0), sizes(PyramidCut::default(), &engine));
        piece(&Rasterization::new(engine, mode, ViewpointEnds::default(), format, sizes), "texels and tiles").count
    };
    // Four products place a pixel, and one finds its tile.
    assert_eq!([RenderMode::Best, RenderMode::Progressive].map(multipliers), [2 * 5, 4 * 5]);
}
