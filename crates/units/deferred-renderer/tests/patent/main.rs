//! Tests of pages, tiles, cells, marking, acquisition and colouring against the patent, with independently computed tables and
//! filters. Also tests the unit contract.

mod acquisition;
mod clears;
mod contract;
mod costs;
mod hardware;
mod layers;
mod marking;
mod pixels;
mod resets;
mod two_wires;

use basrelief_deferred_renderer::{PyramidCut, TexturePage};
use basrelief_signals::{Image, Sampler, Texture};
use std::sync::Arc;

/// Creates a texture of noise.
fn texture(size: [u32; 2]) -> Arc<Texture> {
    let mut state = 0x9e37_79b9_u32 ^ (size[0] << 16 | size[1]);
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    let texels = (0..size[0] * size[1]).map(|_| [byte(), byte(), byte(), 255]).collect();
    let levels = vec![Image { width: size[0], height: size[1], texels }];
    Arc::new(Texture { id: 7, name: "noise".into(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

fn page_of(size: [u32; 2], cut: PyramidCut) -> Arc<TexturePage> {
    Arc::new(TexturePage::new(0, &texture(size), cut, 0))
}

fn page(size: [u32; 2], tile: [u32; 2]) -> Arc<TexturePage> {
    page_of(size, PyramidCut { tile, ..PyramidCut::default() })
}

const SIZES: [[u32; 2]; 12] =
    [[1, 1], [64, 64], [65, 64], [256, 256], [256, 64], [64, 512], [700, 300], [127, 129], [33, 1], [1, 200], [63, 65], [513, 3]];
