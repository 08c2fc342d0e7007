//! What a run holds because its input says so, beside what the readers count.

use crate::settings::RunOptions;
use basrelief_input::{Budget, Held, OverBudget};
use basrelief_signals::{Scene, Texture};
use basrelief_trace::Begin;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Bytes per pixel of a picture under way: cells, colour and depth of the machine, the finished picture, its file. Measured on
/// pictures covered all over: 15, and 58 with `defer`.
const PIXEL: u64 = 64;
/// The same with the exact picture.
const PIXEL_BESIDE_EXACT: u64 = 96;
/// What the metrics between both take per pixel, of as many as are looked at at a time.
const MEASURED_PIXEL: u64 = 48;
/// Pixels that the metrics look at at a time, and rows at least.
const MEASURED: u64 = 1 << 19;
const MEASURED_ROWS: u64 = 64;
/// Bytes per pixel of a picture that waits.
pub(crate) const WAITING_PIXEL: u64 = 4;
/// What is remembered of a frame for the report: cycles, digest, quality, their places in texts \[bytes\].
pub(crate) const FRAME: u64 = 1 << 10;

/// For the pictures that the beginning of a trace asks for.
pub(crate) fn pictures(settings: &RunOptions, begin: &Begin) -> Result<Held, OverBudget> {
    let &Begin { width, height, .. } = begin;
    let pixels = u64::from(width) * u64::from(height);
    let bytes = match settings.exact {
        true => PIXEL_BESIDE_EXACT * pixels + MEASURED_PIXEL * pixels.min(MEASURED).max(MEASURED_ROWS * u64::from(width)),
        false => PIXEL * pixels,
    };
    settings.budget.take(bytes, format!("pictures of {width} x {height} pixels"))
}

/// For the copies that are made of a scene's textures: by a machine, and of one at a time where they are hashed or recorded.
///
/// # Errors
/// More than is left.
pub fn textures(scene: &Scene, copies: u64, budget: &Budget) -> Result<Held, OverBudget> {
    let sizes: BTreeMap<u32, u64> = textures_of(scene).map(|t| (t.id, texel_bytes(t))).collect();
    let (all, largest) = (sizes.values().fold(0, |sum: u64, bytes| sum.saturating_add(*bytes)), sizes.values().max().copied());
    let bytes = u64::saturating_mul(copies, all).saturating_add(largest.unwrap_or_default());
    budget.take(bytes, "copies of textures")
}

fn textures_of(scene: &Scene) -> impl Iterator<Item = &Arc<Texture>> {
    let materials = scene.objects.iter().map(|object| &object.material);
    materials.flat_map(|material| [&material.color_texture, &material.normal_map]).flatten()
}

fn texel_bytes(texture: &Texture) -> u64 {
    // By their sizes: a machine makes copies of texels that are elsewhere, too.
    let texels = texture.levels.iter().map(|level| u64::from(level.width).saturating_mul(level.height.into()));
    texels.fold(0, u64::saturating_add).saturating_mul(size_of::<[u8; 4]>() as u64)
}
