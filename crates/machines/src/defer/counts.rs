//! Device figures of the rate-limited renderer.

use super::{DeferredRenderer, FrontEnd};
use crate::counts::Counts;
use basrelief_deferred_renderer::{DepthPixel, LayerCounts, PageTexels};

impl<F: FrontEnd> DeferredRenderer<F> {
    /// What the units counted, in the order of the block diagram.
    pub(super) fn count(&self) -> Counts {
        let mut counts = Counts::default();
        self.front.counts(&mut counts);
        counts.add("fragments", self.rasterizer.unit.state.counters.fragments);
        self.count_path(&mut counts);
        let depth = &self.depth.unit.state.counters;
        counts.add("z_tested", depth.tested);
        counts.add("z_passed", depth.passed);
        let cells = &self.cell_maker.unit.state.counters;
        counts.add("cells_textured", cells.textured);
        counts.add("cells_direct", cells.direct);
        let buffer = &self.reference_buffer.unit.state.counters;
        counts.add("cell_bits", self.config.cell.bits());
        counts.add("reference_passes", buffer.passes);
        counts.add("tiles_marked", self.identification.unit.state.counters.marked);
        self.count_tiles(&mut counts);
        self.count_colours(&mut counts);
        counts
    }

    fn count_path(&self, counts: &mut Counts) {
        let server = &self.server.unit.state.counters;
        counts.add("path_bytes", self.path.unit.state.counters.bytes);
        counts.add("path_polygon_bytes", server.polygon_bytes);
        counts.add("path_texture_size_bytes", server.size_bytes);
        counts.add("path_tile_bytes", server.tile_bytes);
        counts.add("path_tiles", server.tiles);
        let conventional = self.server.unit.conventional_bytes(self.cut());
        counts.add("conventional_tile_bytes", conventional);
        let share = if conventional == 0 { 0.0 } else { server.tile_bytes as f64 / conventional as f64 };
        counts.add("tile_bytes_of_conventional", (share * 1e6).round() / 1e6);
    }

    /// Tiles in all, and a table with a row per texture and layer.
    fn count_tiles(&self, counts: &mut Counts) {
        let pages = self.rasterization.unit.pages();
        let rows: Vec<(&PageTexels, u8, LayerCounts)> =
            pages.iter().flat_map(|p| (0..=p.page.dmax()).map(move |layer| (p, layer, p.counts(layer)))).collect();
        counts.add("textures", pages.len());
        counts.add("tiles", pages.iter().map(|p| u64::from(p.page.tiles())).sum::<u64>());
        let lists = &self.tile_lists.unit.state.counters;
        counts.add("tiles_loaded", lists.loaded);
        counts.add("tiles_synthesized", lists.synthesized);
        counts.add("tiles_reused", rows.iter().map(|r| r.2.reused).sum::<u64>());
        counts.add("tiles_never_needed", rows.iter().map(|r| r.2.never_needed).sum::<u64>());
        counts.add("acquisitions", lists.acquisitions);
        let mut column = |name: &str, of: fn(&(&PageTexels, u8, LayerCounts)) -> u64| {
            counts.add(&format!("layers_{name}"), rows.iter().map(of).collect::<Vec<u64>>());
        };
        column("texture", |r| r.0.page.texture.into());
        column("layer", |r| r.1.into());
        column("tiles", |r| {
            let layer = &r.0.page.layers[usize::from(r.1)];
            (layer.pitch * layer.rows).into()
        });
        column("loaded", |r| r.2.loaded);
        column("synthesized", |r| r.2.synthesized);
        column("reused", |r| r.2.reused);
        column("never_needed", |r| r.2.never_needed);
    }

    fn count_colours(&self, counts: &mut Counts) {
        let colours = &self.rasterization.unit.state.counters;
        counts.add("pixels_textured", colours.textured);
        counts.add("pixels_direct", colours.direct);
        counts.add("interpolations_within_layers", colours.interpolations);
        counts.add("interpolations_between_layers", colours.between_layers);
        let buffer = &self.pixel_buffer.unit.state.counters;
        counts.add("pixels", buffer.pixels);
        counts.add("frames", buffer.frames);
        counts.add("pictures", buffer.pictures);
        counts.add("most_pictures_per_frame", colours.most_pictures);
        let saved = if self.config.defer.depth_pixel == DepthPixel::Shared { self.pixel_buffer.unit.bytes() } else { 0 };
        counts.add("memory_saved_by_sharing_bytes", saved);
        counts.add("video_out_bytes", self.video_out.unit.state.counters.bytes);
    }
}
