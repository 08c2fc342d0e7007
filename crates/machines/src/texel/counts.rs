//! Device figures of the texture mapping system.

use super::{FrontEnd, TextureMappingSystem};
use crate::counts::Counts;
use basrelief_texel_value_generator::BINS;

impl<F: FrontEnd> TextureMappingSystem<F> {
    /// What the units counted, in the order of the block diagram.
    pub(super) fn count(&self) -> Counts {
        let mut counts = Counts::default();
        self.front.counts(&mut counts);
        let scan = &self.scan_converter.unit.state.counters;
        counts.add("triangles_scanned", scan.triangles);
        counts.add("polygons_empty", scan.empty);
        counts.add("fragments", scan.fragments);
        self.count_segments(&mut counts);
        self.count_arithmetic(&mut counts);
        self.count_displacements(&mut counts);
        counts.add("mip_selections", self.mip_map_selector.unit.state.counters.selections);
        let depth = &self.depth.unit.state.counters;
        counts.add("z_tested", depth.tested);
        counts.add("z_passed", depth.passed);
        let look_up = &self.look_up.unit.state.counters;
        counts.add("pixels_textured", look_up.pixels);
        counts.add("texels_read", look_up.texels);
        let combiner = &self.combiner.unit.state.counters;
        counts.add("pixels", combiner.pixels);
        counts.add("pixels_read_back", combiner.read_back);
        counts.add("frames", self.buffer.unit.state.counters.frames);
        counts.add("video_out_bytes", self.dacs.unit.state.counters.bytes);
        counts
    }

    /// Figures 4A and 4B: spans, their short cuts, segments and their lengths.
    fn count_segments(&self, counts: &mut Counts) {
        let c = &self.step_calculator.unit.state.counters;
        counts.add("textured_fragments", c.textured_pixels);
        counts.add("spans", c.spans);
        counts.add("spans_untextured", c.untextured);
        counts.add("spans_of_one_pixel", c.single);
        counts.add("spans_not_subdivided", c.short);
        counts.add("segments", c.segments);
        let bins = c.lengths.iter().rposition(|n| *n > 0).map_or(0, |i| i + 1).min(BINS);
        // 1, 2, 3..4, 5..8 and so on: the longest of each bin.
        counts.add("segment_lengths_up_to", (0..bins).map(|i| 1u64 << i).collect::<Vec<_>>());
        counts.add("segment_lengths", c.lengths[..bins].to_vec());
        counts.add("segment_longest", c.longest);
        counts.add("division_points", c.division_points);
    }

    /// What is calculated: in the dividers, in the step calculator, at set-up.
    fn count_arithmetic(&self, counts: &mut Counts) {
        let (divider, c) = (&self.divider.unit.state.counters, &self.step_calculator.unit.state.counters);
        let approximation = &self.approximate_calculator.unit.state.counters;
        counts.add("points_divided", divider.points);
        counts.add("divisions", divider.divisions);
        counts.add("reciprocals", divider.reciprocals);
        counts.add("square_roots", if self.step_calculator.unit.table().is_some() { 0 } else { c.roots });
        counts.add("step_table_look_ups", if self.step_calculator.unit.table().is_some() { c.roots } else { 0 });
        counts.add("multiplications", divider.multiplications + approximation.multiplications);
        counts.add("step_divisions", c.step_divisions);
        counts.add("setup_reciprocals", self.scan_converter.unit.state.counters.triangles);
        counts.add("gradient_reciprocals", approximation.gradient_reciprocals);
        let pixels = c.textured_pixels.max(1) as f64;
        counts.add("divisions_per_pixel", (divider.divisions + divider.reciprocals) as f64 / pixels);
        counts.add("points_per_pixel", divider.points as f64 / pixels);
    }

    /// Measured for every pixel with a texture.
    fn count_displacements(&self, counts: &mut Counts) {
        let displacements = &self.approximate_calculator.unit.state.counters.displacements;
        counts.add("displacement_bound", self.step_calculator.unit.config.error_bound);
        counts.add("displacement_largest", displacements.largest);
        counts.add("displacement_mean", displacements.mean());
        if let Some(table) = self.step_calculator.unit.table() {
            counts.add("step_table_largest_error", table.largest_error());
        }
    }
}
