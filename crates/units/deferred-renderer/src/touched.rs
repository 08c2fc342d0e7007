//! Texels of a sample, as look-ups in the cache of the texture-data memory (130).

use crate::TexturePage;
use crate::page::AxisTap;
use basrelief_kernel::MemoryPorts;

/// Maximum number of lines of the texel cache that a block of 4 x 4 pixels touches: four texels of two layers each.
pub const MOST_LINES: u32 = 16 * 2 * 4;

/// Page, layer, and blocks of texels of the previous pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LastTexels(Option<(u16, u8, [u32; 4])>);

impl LastTexels {
    /// Looks up the blocks of 4 x 4 texels of a sample through a client with a cache, unless the previous pixel read the same
    /// blocks.
    #[inline]
    pub(crate) fn look_up(
        &mut self,
        page: &TexturePage,
        layer: u8,
        [x, y]: &[AxisTap; 2],
        client: u32,
        traffic: &mut MemoryPorts,
    ) {
        let blocks = [x.first >> 2, x.second >> 2, y.first >> 2, y.second >> 2];
        let touched = Some((page.number, layer, blocks));
        if self.0 == touched {
            return;
        }
        self.0 = touched;
        let mut one = |x: u32, y: u32| traffic.look_up(client, page.address_of(layer, [x, y]), 4);
        one(x.first, y.first);
        let (wide, high) = (blocks[0] != blocks[1], blocks[2] != blocks[3]);
        if wide {
            one(x.second, y.first);
        }
        if high {
            one(x.first, y.second);
        }
        if wide && high {
            one(x.second, y.second);
        }
    }
}
