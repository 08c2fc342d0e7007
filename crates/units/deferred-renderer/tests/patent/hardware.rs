//! Tables of the units follow from the rates at which they are accessed.

use basrelief_deferred_renderer::{
    CellConfig, EngineConfig, PyramidCut, RenderMode, TableSizes, TileLists, TileOrder, ViewpointEnds,
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
