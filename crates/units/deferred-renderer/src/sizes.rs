//! Sizes of the device's tables, computed from the configuration.

use crate::config::{CellConfig, EngineConfig, RenderMode, TileOrder, WRAP_BITS};
use crate::page::PyramidCut;
use basrelief_kernel::HardwareKind;
use basrelief_kernel::stats::UnitStats;
use basrelief_signals::LINE_NUMBER;

/// Longest side of a texture \[texels\].
const LONGEST_SIDE: u32 = 16_384;
/// Address in a memory, or number of a tile \[bits\].
const ADDRESS: u32 = 32;
/// Side of a layer, or tile pitch (138) \[bits\].
const SIDE: u32 = 15;
/// Most sources of a tile.
const SOURCES: u32 = 4;
/// Cells of a block.
const BLOCK_CELLS: u32 = 16;

/// Sizes of tables and registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TableSizes {
    /// Width of a cell of the reference buffer (126) \[bits\].
    pub cell_bits: u32,
    /// Width of the page pointer (310) of a cell \[bits\].
    pub page_bits: u32,
    /// Maximum number of layers of a page.
    pub layers: u32,
    /// Tiles that fit in the texture-data memory (130).
    pub tiles: u64,
    /// Texels of a tile.
    pub tile_texels: u64,
}

impl TableSizes {
    /// Computes the sizes of a configuration.
    pub fn new(cell: &CellConfig, cut: PyramidCut, engine: &EngineConfig) -> Self {
        let [width, height] = cut.tile;
        let layers = (LONGEST_SIDE / width.min(height)).max(1).ilog2().min(cut.most_depth.into()) + 1;
        let tile_texels = u64::from(width) * u64::from(height);
        Self {
            cell_bits: cell.bits(),
            page_bits: cell.page_bits,
            layers,
            tiles: engine.texture_memory / (4 * tile_texels).max(1),
            tile_texels,
        }
    }

    /// Returns the width of the number of a page and of a tile in it \[bits\].
    pub(crate) fn tile_bits(self) -> u32 {
        self.page_bits + ADDRESS
    }

    /// Reports the tables of the two units that find texels of pages. Both passes over the reference buffer (126) use them, one after
    /// the other, so one copy suffices. It has a port per layer that the faster of them looks up in a cycle. The conventional mode has no
    /// search for layers. The tables hold: Dmax (133), position and size of each page; width, height, tile pitch (138) and tile base
    /// (140) of each layer.
    pub(crate) fn tell_pages(self, config: &EngineConfig, mode: RenderMode, stats: &mut UnitStats) {
        let searched = if mode == RenderMode::Conventional { 0 } else { config.scan_rate };
        let ports = searched.max(config.interpolation_rate);
        let pages = 1_u64 << self.page_bits;
        stats.ported_table("pages (132): Dmax (133), place, size", pages, 5 + ADDRESS + 2 * SIDE, ports);
        let layer = 2 * SIDE + SIDE + ADDRESS;
        stats.ported_table("layers: size, pitch (138), base (140)", pages * u64::from(self.layers), layer, ports);
    }

    /// Reports the registers of a unit that works on a block of cells.
    pub(crate) fn tell_block(self, stats: &mut UnitStats) {
        stats.hardware(HardwareKind::Registers, "block of cells", BLOCK_CELLS, self.cell_bits);
    }

    /// Reports `count` blocks of cells that gather writes. Each holds cells and a mask of written cells.
    pub(crate) fn tell_gathered(self, count: u32, stats: &mut UnitStats) {
        stats.gathered_lines(count, BLOCK_CELLS * (1 + self.cell_bits), LINE_NUMBER);
    }

    /// Reports the tile load lists (136), in words of `engine.list_rate` tiles. If tiles are requested in an order, it includes the keys of
    /// the order.
    ///
    /// The lists have a port for reading and a port for writing, because each mark changes the state of its tile. Four more ports read the
    /// sources of a word of tiles, which are four words. In the progressive mode, the search of Figure 7B reads up to `engine.scan_rate`
    /// words per cycle. Each port chooses a tile of its word. A circuit finds the first tile of a word in state L.
    ///
    /// In the order of the lists, the tiles to acquire have no table of their own: the circuit could request each tile when it finds it
    /// in state L. It would then need no more cycles than the unit takes, which finds all tiles before the first request.
    pub(crate) fn tell_lists(self, config: &EngineConfig, mode: RenderMode, order: TileOrder, stats: &mut UnitStats) {
        let tiles = self.tiles;
        let searched = if mode == RenderMode::Progressive { config.scan_rate } else { 0 };
        let ports = 2 + SOURCES + searched;
        stats.searched_list("tile load lists (136): N, L or E", tiles, [2, config.list_rate], ports);
        stats.hardware(HardwareKind::Registers, "pitch (138) and base (140) of a page's layers", self.layers, SIDE + ADDRESS);
        stats.hardware(HardwareKind::Adder, "numbers of sources", SOURCES, ADDRESS);
        if order != TileOrder::Listed {
            stats.ported_table("pixels and distance of tiles", tiles, 2 * 32, 2);
            stats.hardware(HardwareKind::Table, "tiles to acquire, in order, twice for merging", 2 * tiles, self.tile_bits() + 1);
            stats.hardware(HardwareKind::Adder, "order of tiles", 2_u32, 32);
        }
    }

    /// Returns the width of the wrap modes and page of a surface, and of a texture's size \[bits\].
    pub(crate) fn surface_bits(self) -> u32 {
        self.page_bits + WRAP_BITS + 2 * SIDE + 5
    }
}
