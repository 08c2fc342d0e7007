//! Resets of tile load lists (136) take time.

use crate::page;
use basrelief_deferred_renderer::tokens::{MarkFlow, StoreOrder, TileMark};
use basrelief_deferred_renderer::{EngineConfig, RenderMode, RendererConfig, TableSizes, TileLists, TileOrder, ViewpointEnds};
use basrelief_kernel::{MemoryPorts, Unit};

fn lists(mode: RenderMode, order: TileOrder, ends: &RendererConfig) -> TileLists {
    TileLists::new(EngineConfig::default(), mode, order, TableSizes::default(), ViewpointEnds::new(ends, None))
}

fn marks(tiles: &[(u32, u32)]) -> MarkFlow {
    let mark = |&(tile, pixels): &(u32, u32)| TileMark { page: 0, tile, pixels, distance: 9 };
    MarkFlow::Marks(tiles.iter().map(mark).collect())
}

/// Makes steps with these marks of the identification. Returns the occupancy of the last one.
fn identify(unit: &mut TileLists, marks: impl IntoIterator<Item = MarkFlow>) -> u64 {
    let mut occupancy = |token| unit.step((Some(token), None), &mut MemoryPorts::default()).occupancy;
    marks.into_iter().map(&mut occupancy).last().expect("there is a token")
}

/// Makes steps with these marks of a progressive picture.
fn improve(unit: &mut TileLists, marks: impl IntoIterator<Item = MarkFlow>) {
    for token in marks {
        unit.step((None, Some(token)), &mut MemoryPorts::default());
    }
}

/// Makes the steps of an acquisition. Returns the tiles loaded, and the occupancy of the last step.
fn acquire(unit: &mut TileLists) -> (Vec<u32>, u64) {
    let mut loaded = Vec::new();
    loop {
        let step = unit.step((None, None), &mut MemoryPorts::default());
        match step.out.1 {
            Some(StoreOrder::Load { tile, .. }) => loaded.push(tile),
            Some(StoreOrder::Synthesize { .. }) => {}
            Some(StoreOrder::End | StoreOrder::Left) | None => return (loaded, step.occupancy),
        }
    }
}

#[test]
fn new_view_resets_a_word_per_cycle() {
    let mut unit = lists(RenderMode::Best, TileOrder::Listed, &RendererConfig::default());
    assert_eq!(identify(&mut unit, [MarkFlow::Frame]), 1, "no page yet");
    // 85 tiles, of which 16 fit in a word.
    let page = || MarkFlow::Page(page([512, 512], [64, 64]));
    assert_eq!(identify(&mut unit, [page(), MarkFlow::Frame]), 6);
    assert_eq!(identify(&mut unit, [page(), MarkFlow::Frame]), 11);
    assert_eq!(identify(&mut unit, [MarkFlow::End]), 11, "a test reads the same words");
}

#[test]
fn abandoned_tile_takes_a_cycle() {
    let cycles = |left_at_tile: u32| {
        let ends = RendererConfig { left_at_tile: vec![left_at_tile], ..RendererConfig::default() };
        let mut unit = lists(RenderMode::Progressive, TileOrder::Listed, &ends);
        identify(&mut unit, [MarkFlow::Frame, MarkFlow::Page(page([512, 512], [64, 64])), MarkFlow::End]);
        acquire(&mut unit);
        improve(&mut unit, [marks(&[(5, 1), (6, 1), (7, 1), (8, 1)]), MarkFlow::End]);
        acquire(&mut unit)
    };
    assert_eq!(cycles(2), (vec![], 4));
    assert_eq!(cycles(4), (vec![5, 6], 2));
    assert_eq!(cycles(9), (vec![5, 6, 7, 8], 1), "nothing is abandoned");
}

#[test]
fn priority_of_earlier_view_is_replaced() {
    let ends = RendererConfig { pictures_per_view: 1, ..RendererConfig::default() };
    let mut unit = lists(RenderMode::Progressive, TileOrder::Pixels, &ends);
    identify(&mut unit, [MarkFlow::Frame, MarkFlow::Page(page([512, 512], [64, 64])), MarkFlow::End]);
    acquire(&mut unit);
    improve(&mut unit, [marks(&[(5, 9)]), MarkFlow::End]);
    identify(&mut unit, [MarkFlow::Frame, marks(&[(5, 1), (6, 2), (5, 2), (7, 4)]), MarkFlow::End]);
    assert_eq!(acquire(&mut unit).0, [7, 5, 6], "4, 3 and 2 pixels");
}
