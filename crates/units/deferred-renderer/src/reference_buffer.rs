//! Reference buffer (126): one cell per pixel of the screen.

use crate::config::{EngineConfig, RenderMode};
use crate::tokens::{CellBlock, CellFlow, PassFlow, PassRound, PlacedCell};
use crate::{ReferenceCell, TableSizes, TexturePage};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit, UnitTable};
use basrelief_shading::{BLOCK, pixel_offset};
use basrelief_signals::{Frame, GatheredLines, LineFlags, Stamp, layout};
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::sync::Arc;

/// Cells of a block of 4 x 4 pixels.
const BLOCK_CELLS: usize = 16;

/// Phase of the reference buffer within a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum BufferPhase {
    /// Clears the blocks without flags, then receives cells (454), up to the end of the frame.
    #[default]
    Fill,
    /// Writes the remaining gathered blocks, one per step.
    Flush,
    /// Passes over all blocks from this one on, for the identification of tiles (461).
    Identify(usize),
    /// Before a pass for the final rasterization (463, 472).
    Begin,
    /// Passes over all blocks from this one on, for the final rasterization.
    Colour(usize),
    /// Waits for the tile load list (136).
    Wait,
}

/// A filled buffer, for auxiliary outputs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FilledBuffer {
    /// Number of the frame.
    pub frame: u32,
    /// Width of the picture \[pixels\].
    pub width: u32,
    /// Height of the picture \[pixels\].
    pub height: u32,
    /// All pages so far, by number.
    pub pages: Vec<Arc<TexturePage>>,
    /// Cells, row by row.
    pub cells: Vec<ReferenceCell>,
}

/// Observer of a real path. The model has none.
pub trait PreviewObserver: Debug + Send + Sync {
    /// Called when the reference buffer (126) of a view is filled, before its tiles are requested.
    fn filled(&self, filled: FilledBuffer);
}

/// Counters of the reference buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReferenceBufferCounters {
    /// Cells written.
    pub written: u64,
    /// Passes.
    pub passes: u64,
    /// Cells read by passes.
    pub read: u64,
}

/// State of the reference buffer (126) between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReferenceBufferState {
    phase: BufferPhase,
    /// Frame that fills the buffer.
    pub frame: Option<Arc<Frame>>,
    /// Cells, block by block.
    pub cells: Vec<ReferenceCell>,
    /// Pages so far, by number.
    pub pages: Vec<Arc<TexturePage>>,
    /// Clear flags: set for a block that was not written in this frame.
    pub flags: LineFlags,
    /// Blocks that gather writes.
    pub lines: GatheredLines,
    /// Filled buffers that are not fetched yet, if recording is enabled.
    pub filled: Vec<FilledBuffer>,
    /// Counters.
    pub counters: ReferenceBufferCounters,
}

/// Reference buffer (126). The initial rasterization fills it, and then passes read it. In the mode of best resolution there is
/// one pass to identify tiles and one to colour. In the progressive mode there is one per picture. A colouring pass also sends
/// blocks without drawn pixels, because the picture has its background there.
///
/// Inputs: cells, and the news of another round. Outputs: passes to identification and to the final rasterization. Client 0
/// reads, client 1 writes: 4 x 4 cells at a time. Some blocks gather writes (`engine.write_lines`).
///
/// A frame begins with a clear. It sets a flag for each block (`engine.clear_flags`, as many as `engine.flags`), and the first write to
/// a block resets the flag. All other cells of this write are empty. Blocks without a flag are cleared by writes at the beginning of the
/// frame, one per step. A pass does not read a block with a flag, but keeps its pace (assumed).
#[derive(Clone, Debug)]
pub struct ReferenceBuffer {
    /// Parameters.
    pub config: EngineConfig,
    mode: RenderMode,
    cell_bytes: u32,
    sizes: TableSizes,
    /// True if filled buffers are kept for auxiliary outputs.
    pub keep: bool,
    onlooker: Option<Arc<dyn PreviewObserver>>,
    /// State between steps.
    pub state: ReferenceBufferState,
}

type Out = (Option<PassFlow>, Option<PassFlow>);

impl ReferenceBuffer {
    /// Creates the buffer in its power-on state. `cell_bytes` is the size of a cell in memory.
    pub fn new(config: EngineConfig, mode: RenderMode, cell_bytes: u32, sizes: TableSizes) -> Self {
        Self { config, mode, cell_bytes, sizes, keep: false, onlooker: None, state: ReferenceBufferState::default() }
    }

    /// Sets the observer of each filled buffer.
    #[must_use]
    pub fn shown_to(self, onlooker: Option<Arc<dyn PreviewObserver>>) -> Self {
        Self { onlooker, ..self }
    }

    /// Returns the buffers filled since the last call, if they are kept.
    pub fn drain_filled(&mut self) -> Vec<FilledBuffer> {
        std::mem::take(&mut self.state.filled)
    }

    /// Begins a frame. Returns the cycles that its flags take.
    fn begin(&mut self, frame: &Arc<Frame>) -> u64 {
        // The pixel buffer reports a picture that is too large.
        let room = if layout::fits(frame.width, frame.height) { [frame.width, frame.height] } else { [0, 0] };
        let blocks = room.map(|n| n.div_ceil(BLOCK) as usize);
        let blocks = blocks[0] * blocks[1];
        self.state.cells.clear();
        self.state.cells.resize(blocks * BLOCK_CELLS, ReferenceCell::default());
        self.state.frame = Some(Arc::clone(frame));
        self.state.lines = GatheredLines::default();
        self.state.flags.begin(blocks as u64, self.flags(), self.config.flags_per_cycle)
    }

    fn flags(&self) -> u32 {
        if self.config.clear_flags { self.config.flags } else { 0 }
    }

    #[inline]
    fn put(&mut self, cells: &Stamp<PlacedCell>, traffic: &mut MemoryPorts) {
        let Some(frame) = &self.state.frame else { return };
        let width = frame.width;
        for placed in cells {
            let offset = pixel_offset(width, [placed.x.into(), placed.y.into()]);
            let Some(cell) = self.state.cells.get_mut(offset as usize) else { continue };
            *cell = placed.cell;
            self.state.counters.written += 1;
            let block = offset / BLOCK_CELLS as u64;
            self.state.flags.draw(block);
            if let Some(gone) = self.state.lines.touch(block, self.config.write_lines) {
                self.write(gone, traffic);
            }
        }
    }

    fn write(&self, block: u64, traffic: &mut MemoryPorts) {
        let bytes = BLOCK_CELLS as u32 * self.cell_bytes;
        traffic.write(1, block * u64::from(bytes), bytes);
    }

    fn filled(&self) -> Option<FilledBuffer> {
        let frame = self.state.frame.as_ref()?;
        let (width, height) = (frame.width, frame.height);
        let cell = |x: u32, y: u32| self.state.cells.get(pixel_offset(width, [x, y]) as usize).copied().unwrap_or_default();
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| cell(x, y))).collect();
        Some(FilledBuffer { frame: frame.index, width, height, pages: self.state.pages.clone(), cells })
    }

    fn fill(&mut self, token: CellFlow, traffic: &mut MemoryPorts) -> Step<Out> {
        let latency = u64::from(self.config.latency);
        match token {
            CellFlow::Frame(frame) => {
                let cycles = self.begin(&frame);
                Step::after(latency, (Some(PassFlow::Frame(Arc::clone(&frame))), Some(PassFlow::Frame(frame)))).busy(cycles)
            }
            CellFlow::Page(page) => {
                self.state.pages.push(Arc::clone(&page));
                Step::after(latency, (Some(PassFlow::Page(Arc::clone(&page))), Some(PassFlow::Page(page))))
            }
            CellFlow::Cells(cells) => {
                self.put(&cells, traffic);
                Step::over(cells.len(), 1, latency, (None, None))
            }
            CellFlow::FrameEnd => self.flush(traffic),
        }
    }

    /// Clears a block without a flag.
    fn clear(&mut self, traffic: &mut MemoryPorts) -> Step<Out> {
        if let Some(block) = self.state.flags.take_unflagged() {
            self.write(block, traffic);
        }
        Step::after(self.config.latency.into(), (None, None))
    }

    /// Writes a gathered block. After the last of them, the buffer is filled.
    fn flush(&mut self, traffic: &mut MemoryPorts) -> Step<Out> {
        if let Some(block) = self.state.lines.take() {
            self.write(block, traffic);
        }
        if self.state.lines.is_empty() {
            return self.end_of_fill();
        }
        self.state.phase = BufferPhase::Flush;
        Step::after(self.config.latency.into(), (None, None))
    }

    fn end_of_fill(&mut self) -> Step<Out> {
        let latency = u64::from(self.config.latency);
        if let Some(onlooker) = &self.onlooker {
            self.filled().into_iter().for_each(|filled| onlooker.filled(filled));
        }
        if self.keep {
            let filled = self.filled();
            self.state.filled.extend(filled);
        }
        if self.mode == RenderMode::Best {
            self.state.counters.passes += 1;
            self.state.phase = BufferPhase::Identify(0);
            Step::after(latency, (None, None))
        } else {
            self.state.phase = BufferPhase::Begin;
            Step::after(latency, (Some(PassFlow::End), None))
        }
    }

    /// Reads one block. A block with a flag is not read, because all its cells are empty.
    #[inline]
    fn read(&mut self, block: usize, traffic: &mut MemoryPorts) -> Option<CellBlock> {
        let cells: &[ReferenceCell; BLOCK_CELLS] = self.state.cells[block * BLOCK_CELLS..].first_chunk()?;
        if !self.state.flags.is_clear(block as u64) {
            let bytes = BLOCK_CELLS as u32 * self.cell_bytes;
            traffic.read(0, block as u64 * u64::from(bytes), bytes);
            self.state.counters.read += BLOCK_CELLS as u64;
        }
        let mask = cells.iter().enumerate().fold(0, |mask, (i, c)| mask | u16::from(c.is_drawn()) << i);
        let columns = self.state.frame.as_ref()?.width.div_ceil(BLOCK) as usize;
        let at = [(block % columns) as u16, (block / columns) as u16];
        Some(CellBlock { at, mask, cells: *cells })
    }

    /// Returns the next block of a pass, or its end, with the cycles, and true at the end.
    #[inline]
    fn pass(&mut self, block: usize, traffic: &mut MemoryPorts) -> (Option<PassFlow>, u64, bool) {
        let wants_all = matches!(self.state.phase, BufferPhase::Colour(_));
        if (block + 1) * BLOCK_CELLS > self.state.cells.len() {
            return (Some(PassFlow::End), 1, true);
        }
        let cycles = (BLOCK_CELLS as u64).div_ceil(self.config.scan_rate.into());
        let cells = self.read(block, traffic).filter(|cells| wants_all || cells.mask != 0);
        (cells.map(PassFlow::Cells), cycles, false)
    }
}

impl Unit for ReferenceBuffer {
    basrelief_kernel::unit_info!("one cell per pixel: filled, then passed over");
    type In = (Option<CellFlow>, Option<PassRound>);
    type Out = Out;

    #[inline]
    fn demand(&self) -> Demand {
        match self.state.phase {
            BufferPhase::Fill if self.state.flags.has_unflagged() => Demand::Nothing,
            BufferPhase::Fill => Demand::Only(0),
            BufferPhase::Wait => Demand::Only(1),
            BufferPhase::Flush | BufferPhase::Identify(_) | BufferPhase::Begin | BufferPhase::Colour(_) => Demand::Nothing,
        }
    }

    #[inline(always)]
    fn step(&mut self, (cells, round): Self::In, traffic: &mut MemoryPorts) -> Step<Out> {
        let latency = u64::from(self.config.latency);
        match self.state.phase {
            BufferPhase::Fill => match cells {
                Some(token) => self.fill(token, traffic),
                None => self.clear(traffic),
            },
            BufferPhase::Flush => self.flush(traffic),
            BufferPhase::Identify(block) => {
                let (token, cycles, end) = self.pass(block, traffic);
                self.state.phase = if end { BufferPhase::Begin } else { BufferPhase::Identify(block + 1) };
                Step::after(latency, (token, None)).busy(cycles)
            }
            BufferPhase::Begin => {
                self.state.counters.passes += 1;
                self.state.phase = BufferPhase::Colour(0);
                Step::after(latency, (None, Some(PassFlow::Begin)))
            }
            BufferPhase::Colour(block) => {
                let (token, cycles, end) = self.pass(block, traffic);
                self.state.phase = if end { BufferPhase::Wait } else { BufferPhase::Colour(block + 1) };
                Step::after(latency, (None, token)).busy(cycles)
            }
            BufferPhase::Wait => {
                self.state.phase = if round == Some(PassRound::Again) { BufferPhase::Begin } else { BufferPhase::Fill };
                Step::after(latency, (None, None))
            }
        }
    }

    /// Returns one read block, and one written block: cleared, evicted by a stamp's block, or written at the end.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client < 2)
    }

    fn is_empty(&self) -> bool {
        self.state.phase == BufferPhase::Fill && !self.state.flags.has_unflagged()
    }

    fn twin_tables(&self) -> Vec<UnitTable> {
        vec![UnitTable::number("cell_bytes", self.cell_bytes)]
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let interval = 16_u32.div_ceil(self.config.scan_rate);
        for output in 0..2 {
            stats.rate(output, self.config.latency, interval);
        }
        stats.figure("reference_passes", self.state.counters.passes, "passes", "Passes over the reference buffer");
        let bytes = self.state.cells.len() as u64 * u64::from(self.cell_bytes);
        stats.figure("reference_buffer_bytes", bytes, "bytes", "Memory that its cells take");
        stats.flags("flags of clear blocks", self.flags(), self.config.flags_per_cycle);
        self.sizes.tell_gathered(self.config.write_lines, stats);
        stats.hardware(HardwareKind::Adder, "place and number of a block", 4_u32, 32);
        self.sizes.tell_block(stats);
    }
}
