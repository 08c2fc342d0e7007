//! Figures of the final rasterization: totals of tiles, and a table with a row per texture and layer.

use crate::{LayerCounts, PageTexels};
use basrelief_kernel::stats::{FigureGroup, UnitStats};

/// A layer of a page, and the history of its tiles.
struct LayerRow<'a> {
    page: &'a PageTexels,
    layer: u8,
    counts: LayerCounts,
}

pub(crate) fn tell(pages: &[PageTexels], stats: &mut UnitStats) {
    let layers = pages.iter().flat_map(|page| (0..=page.page.dmax()).map(move |layer| (page, layer)));
    let rows: Vec<LayerRow<'_>> = layers.map(|(page, layer)| LayerRow { page, layer, counts: page.counts(layer) }).collect();
    let tiles = pages.iter().map(|p| u64::from(p.page.tiles())).sum::<u64>();
    let sum = |of: fn(&LayerCounts) -> u64| rows.iter().map(|row| of(&row.counts)).sum::<u64>();
    stats.figure("textures", pages.len() as u64, "textures", "Textures that pixels have");
    stats.figure("tiles", tiles, "tiles", "Their tiles, of all layers");
    stats.figure(
        "tiles_reused",
        sum(|c| c.reused),
        "tiles",
        "Tiles of an earlier frame that a frame was coloured from, frame by frame",
    );
    stats.figure("tiles_never_needed", sum(|c| c.never_needed), "tiles", "Tiles that no pixel was coloured from");
    let mut column = |title, unit, about, of: fn(&LayerRow<'_>) -> u64| {
        let values: Vec<u64> = rows.iter().map(of).collect();
        stats.figure(&format!("layers_{title}"), values, unit, about).part(FigureGroup::Column { table: "layers", title });
    };
    column("texture", "", "Number of the texture", |row| row.page.page.texture.into());
    column("layer", "", "Number of the layer", |row| row.layer.into());
    column("tiles", "tiles", "Tiles of the layer", |row| {
        let layer = &row.page.page.layers[usize::from(row.layer)];
        (layer.pitch * layer.rows).into()
    });
    column("loaded", "tiles", "Tiles loaded", |row| row.counts.loaded);
    column("synthesized", "tiles", "Tiles synthesized", |row| row.counts.synthesized);
    column("reused", "tiles", "Tiles of an earlier frame that a frame was coloured from, frame by frame", |row| {
        row.counts.reused
    });
    column("never_needed", "tiles", "Tiles that no pixel was coloured from", |row| row.counts.never_needed);
}
