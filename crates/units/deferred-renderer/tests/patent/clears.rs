//! The reference buffer (126) is cleared by flags or by writes.

use basrelief_deferred_renderer::tokens::{CellFlow, PlacedCell};
use basrelief_deferred_renderer::{EngineConfig, ReferenceBuffer, ReferenceCell, RenderMode, TableSizes};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Unit};
use basrelief_signals::{Frame, Stamp};
use std::sync::Arc;

/// Bytes of a block of cells.
const BLOCK: u64 = 16 * 16;

fn buffer(config: EngineConfig) -> ReferenceBuffer {
    ReferenceBuffer::new(config, RenderMode::Best, 16, TableSizes::default())
}

fn few_flags(flags: u32) -> EngineConfig {
    EngineConfig { flags, ..EngineConfig::default() }
}

/// Makes a step. Returns its occupancy, and the blocks that it reads and writes.
fn step(unit: &mut ReferenceBuffer, token: Option<CellFlow>) -> (u64, Vec<u64>, Vec<u64>) {
    let mut traffic = MemoryPorts::default();
    let occupancy = unit.step((token, None), &mut traffic).occupancy;
    let blocks = |write| traffic.requests().iter().filter(|r| r.write == write).map(|r| r.address / BLOCK).collect();
    (occupancy, blocks(false), blocks(true))
}

/// Begins a frame. Returns the cycles of its flags, and the blocks that are cleared by writes.
fn begin(unit: &mut ReferenceBuffer, width: u32, height: u32) -> (u64, Vec<u64>) {
    let frame = Arc::new(Frame { width, height, ..Frame::default() });
    let (cycles, _, mut cleared) = step(unit, Some(CellFlow::Frame(frame)));
    while unit.demand() == Demand::Nothing {
        assert!(!unit.is_empty());
        cleared.extend(step(unit, None).2);
    }
    (cycles, cleared)
}

/// Draws one cell and ends the frame. Returns the blocks that each pass reads.
fn passes(unit: &mut ReferenceBuffer, [x, y]: [u16; 2]) -> [Vec<u64>; 2] {
    let cell = PlacedCell { x, y, cell: ReferenceCell::direct([1, 2, 3]) };
    step(unit, Some(CellFlow::Cells(Stamp::from_iter([cell]))));
    step(unit, Some(CellFlow::FrameEnd));
    let blocks = unit.state.cells.len() / 16;
    // The end of the identification, and the beginning of the other pass, are steps without a block.
    [blocks + 2, blocks].map(|steps| (0..steps).flat_map(|_| step(unit, None).1).collect())
}

#[test]
fn pass_reads_only_drawn_blocks() {
    let mut unit = buffer(EngineConfig::default());
    assert_eq!(begin(&mut unit, 16, 8), (1, vec![]));
    assert_eq!(passes(&mut unit, [13, 2]), [[3], [3]]);
}

#[test]
fn blocks_beyond_flags_are_cleared_by_writes() {
    let mut unit = buffer(few_flags(5));
    assert_eq!(begin(&mut unit, 16, 8), (1, vec![5, 6, 7]));
    assert_eq!(passes(&mut unit, [13, 2]), [[3, 5, 6, 7], [3, 5, 6, 7]]);
    let mut unit = buffer(EngineConfig { clear_flags: false, ..EngineConfig::default() });
    assert_eq!(begin(&mut unit, 8, 8), (1, vec![0, 1, 2, 3]));
}

#[test]
fn clear_sets_a_word_of_flags_per_cycle() {
    let cycles = |flags| begin(&mut buffer(few_flags(flags)), 64, 64).0;
    assert_eq!([131_072, 256, 100].map(cycles), [4, 4, 2]);
}

#[test]
fn clear_flags_are_a_table_of_two_ports() {
    let table = |config| {
        let mut stats = UnitStats::default();
        buffer(config).report_stats(&mut stats);
        let flags = stats.all_hardware().iter().find(|piece| piece.about == "flags of clear blocks");
        flags.map(|flags| (flags.count, flags.width, flags.ports))
    };
    assert_eq!(table(EngineConfig::default()), Some((2048, 64, 2)));
    assert_eq!(table(EngineConfig { clear_flags: false, ..EngineConfig::default() }), None);
}
