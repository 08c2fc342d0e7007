//! Memory of a run that depends on its input, in addition to the memory that the readers count.

use crate::options::RunOptions;
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use basrelief_machines::MachineSpec;
use basrelief_signals::{Scene, Texture};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Memory of the reference image and its difference per pixel \[bytes\]. Measured: 16.
const EXACT_PIXEL: u64 = 24;
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

/// Reserves memory for pictures of this size by this machine.
///
/// # Errors
/// The memory limit is exceeded.
pub(crate) fn reserve_pictures<S: MachineSpec>(
    settings: &RunOptions,
    [width, height]: [u32; 2],
) -> Result<MemoryReservation, OverBudget> {
    let pixels = u64::from(width) * u64::from(height);
    let exact = match settings.exact {
        true => EXACT_PIXEL * pixels + METRICS_PIXEL * pixels.min(METRICS_PIXELS).max(METRICS_ROWS * u64::from(width)),
        false => 0,
    };
    settings.budget.try_reserve(S::PIXEL_BYTES * pixels + exact, format!("images of {width} x {height} pixels"))
}

/// Reserves memory for the largest picture of a scene if the process gets only so much memory. The user gives the size.
///
/// # Errors
/// The memory limit is exceeded.
pub(crate) fn reserve_frames<S: MachineSpec>(settings: &RunOptions, scene: &Scene) -> Result<MemoryReservation, OverBudget> {
    let sizes = scene.frames.iter().map(|frame| [frame.width, frame.height]);
    let largest = sizes.max_by_key(|&[width, height]| u64::from(width) * u64::from(height));
    match largest.filter(|_| settings.budget.bounds_process()) {
        Some(size) => reserve_pictures::<S>(settings, size),
        None => Ok(settings.budget.empty_reservation()),
    }
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
