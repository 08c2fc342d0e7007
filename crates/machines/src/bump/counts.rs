//! Device figures of the bump-mapping processor.

use super::{BumpProcessor, FrontEnd};
use crate::counts::Counts;
use basrelief_normal_mapping::DistinctCounter;

impl<F: FrontEnd> BumpProcessor<F> {
    /// What the units counted, in the order of the block diagram.
    pub(super) fn count(&self) -> Counts {
        let mut counts = Counts::default();
        self.front.counts(&mut counts);
        self.count_fragments(&mut counts);
        self.count_surface(&mut counts);
        let brightness = &self.brightness.unit.state.counters;
        counts.add("clut_samples", brightness.samples);
        counts.add("clut_rebuilds", brightness.rebuilds);
        counts.add("clut_rebuild_cycles", brightness.rebuild_cycles);
        counts.add("clut_rebuild_bytes", brightness.rebuild_bytes);
        let graphics = &self.graphics.unit.state.counters;
        counts.add("pixels", graphics.pixels);
        counts.add("pixels_textured", graphics.textured);
        counts.add("results_held", graphics.held);
        counts.add("frames", self.frame_buffer.unit.state.counters.frames);
        counts.add("video_out_bytes", self.video_out.unit.state.counters.bytes);
        counts
    }

    fn count_fragments(&self, counts: &mut Counts) {
        let rasterizer = &self.rasterizer.unit.state.counters;
        counts.add("fragments", rasterizer.fragments);
        counts.add("bump_fragments", self.mapping.unit.state.counters.bump_fragments);
        let (early, late) = (&self.early_depth.unit.state.counters, &self.late_depth.unit.state.counters);
        counts.add("z_tested", early.tested + late.tested);
        counts.add("z_passed", early.passed + late.passed);
    }

    /// Claim 3 and the promise of the patent: only indexes are kept on the surface, so less is moved than with normals.
    fn count_surface(&self, counts: &mut Counts) {
        let mapping = &self.mapping.unit.state.counters;
        let replacement = &self.replacement.unit.state.counters;
        counts.add("normal_texels", mapping.texels);
        counts.add("pseudo_normals", mapping.pseudo_normals);
        counts.add("distinct_pseudo_normals", u64::from(mapping.distinct.count()));
        counts.add("distinct_pseudo_normals_counted_to", u64::from(DistinctCounter::LIMIT));
        counts.add("searches", replacement.searches);
        counts.add("reference_normals_used", replacement.reference_normals_used().to_vec());
        counts.add("vq_table_loads", replacement.table_loads);
        counts.add("vq_table_load_bytes", replacement.table_load_bytes);
        counts.add("code_books", replacement.code_books);
        counts.add("clustering_cycles", replacement.clustering_cycles);
        counts.add("gathered_bytes", replacement.gathered_bytes);
        counts.add("index_bytes", replacement.searches * self.widths.index_bytes);
        counts.add("full_normal_bytes", replacement.searches * self.widths.normal_bytes);
    }
}
