//! Memory of a run that depends on its input, in addition to the memory that the readers count.

use crate::options::RunOptions;
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use basrelief_signals::{Scene, Texture};
use basrelief_trace::BeginCommand;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Memory per pixel of a picture in progress \[bytes\]: cells, colour and depth of the machine, the finished picture, and its file.
/// Measured on fully covered pictures: 15, and 58 with `defer`.
const PIXEL: u64 = 64;
/// Memory per pixel together with the reference image \[bytes\].
const PIXEL_WITH_EXACT: u64 = 96;
/// Memory of the metrics per pixel that they process at a time \[bytes\].
const METRICS_PIXEL: u64 = 48;
/// Pixels that the metrics process at a time.
const METRICS_PIXELS: u64 = 1 << 19;
/// Minimum number of rows that the metrics process at a time.
const METRICS_ROWS: u64 = 64;
/// Memory per pixel of a finished picture \[bytes\].
pub(crate) const WAITING_PIXEL: u64 = 4;
/// Memory of a frame for the report \[bytes\]: cycles, digest, quality, and their texts.
pub(crate) const FRAME: u64 = 1 << 10;

/// Reserves memory for pictures of the size that a trace states.
pub(crate) fn reserve_pictures(settings: &RunOptions, begin: &BeginCommand) -> Result<MemoryReservation, OverBudget> {
    let &BeginCommand { width, height, .. } = begin;
    let pixels = u64::from(width) * u64::from(height);
    let bytes = match settings.exact {
        true => PIXEL_WITH_EXACT * pixels + METRICS_PIXEL * pixels.min(METRICS_PIXELS).max(METRICS_ROWS * u64::from(width)),
        false => PIXEL * pixels,
    };
    settings.budget.try_reserve(bytes, format!("pictures of {width} x {height} pixels"))
}

/// Reserves memory for copies of a scene's textures: `copies` of all textures, and one copy of the largest texture for hashing or recording.
///
/// # Errors
/// The memory limit is exceeded.
pub fn reserve_textures(scene: &Scene, copies: u64, budget: &MemoryPool) -> Result<MemoryReservation, OverBudget> {
    let sizes: BTreeMap<u32, u64> = textures_of(scene).map(|t| (t.id, texel_bytes(t))).collect();
    let (all, largest) = (sizes.values().fold(0, |sum: u64, bytes| sum.saturating_add(*bytes)), sizes.values().max().copied());
    let bytes = u64::saturating_mul(copies, all).saturating_add(largest.unwrap_or_default());
    budget.try_reserve(bytes, "copies of textures")
}

fn textures_of(scene: &Scene) -> impl Iterator<Item = &Arc<Texture>> {
    let materials = scene.objects.iter().map(|object| &object.material);
    materials.flat_map(|material| [&material.color_texture, &material.normal_map]).flatten()
}

fn texel_bytes(texture: &Texture) -> u64 {
    // Computed from the sizes, because a machine also copies texels that are on a server.
    let texels = texture.levels.iter().map(|level| u64::from(level.width).saturating_mul(level.height.into()));
    texels.fold(0, u64::saturating_add).saturating_mul(size_of::<[u8; 4]>() as u64)
}
