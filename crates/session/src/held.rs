//! What a run holds because its input says so, beside what the readers count.

use crate::settings::RunOptions;
use basrelief_display_list::Begin;
use basrelief_input::{Budget, Held, OverBudget};
use basrelief_signals::{Scene, Texture};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Bytes per pixel of a picture under way: colour, depth and tags of the machine, the finished picture, its file.
/// Measured on pictures covered all over.
const PIXEL: u64 = 48;
/// The same with the exact picture and the metrics between both.
const PIXEL_BESIDE_EXACT: u64 = 112;
/// Bytes per pixel of a picture that waits.
pub(crate) const WAITING_PIXEL: u64 = 4;
/// What is remembered of a frame for the report: cycles, digest, quality, their places in texts \[bytes\].
pub(crate) const FRAME: u64 = 1 << 10;

/// For the pictures that the beginning of a trace asks for.
pub(crate) fn pictures(settings: &RunOptions, begin: &Begin) -> Result<Held, OverBudget> {
    let &Begin { width, height, .. } = begin;
    let pixel = if settings.exact { PIXEL_BESIDE_EXACT } else { PIXEL };
    let what = format!("pictures of {width} x {height} pixels");
    settings.budget.take(pixel * u64::from(width) * u64::from(height), what)
}

/// For the copies that are made of a scene's textures: by a machine, and of one at a time where they are hashed or recorded.
///
/// # Errors
/// More than is left.
pub fn textures(scene: &Scene, copies: u64, budget: &Budget) -> Result<Held, OverBudget> {
    let sizes: BTreeMap<u32, u64> = textures_of(scene).map(|t| (t.id, texel_bytes(t))).collect();
    let (all, largest) = (sizes.values().sum::<u64>(), sizes.values().max().copied().unwrap_or_default());
    budget.take(copies * all + largest, "copies of textures")
}

fn textures_of(scene: &Scene) -> impl Iterator<Item = &Arc<Texture>> {
    let materials = scene.objects.iter().map(|object| &object.material);
    materials.flat_map(|material| [&material.color_texture, &material.normal_map]).flatten()
}

fn texel_bytes(texture: &Texture) -> u64 {
    texture.levels.iter().map(|level| size_of_val(&*level.texels) as u64).sum()
}
