//! Device figures of the figure shading device.

use super::{FigureShadingDevice, FrontEnd};
use crate::counts::Counts;
use basrelief_figure_shading::{Process, Route};

impl<F: FrontEnd> FigureShadingDevice<F> {
    /// What the units counted, in the order of the block diagram.
    pub(super) fn count(&self) -> Counts {
        let mut counts = Counts::default();
        self.front.counts(&mut counts);
        let host = &self.host.unit.state.counters;
        counts.add("host_bytes", host.bytes);
        counts.add("polygons_sent", host.polygons);
        counts.add("polygons_dropped", host.dropped);
        counts.add("polygons_textured", host.textured);
        self.count_routes(&mut counts);
        self.count_short_cuts(&mut counts);
        self.count_processes(&mut counts);
        self.count_circuits(&mut counts);
        let depth = &self.depth.unit.state.counters;
        counts.add("z_tested", depth.tested);
        counts.add("z_passed", depth.passed);
        let frame_memory = &self.frame_memory.unit.state.counters;
        counts.add("pixels", frame_memory.pixels);
        counts.add("frames", frame_memory.frames);
        counts.add("video_out_bytes", self.video_out.unit.state.counters.bytes);
        counts
    }

    /// Polygons and dots on each of the six routes; a dot is a fragment.
    fn count_routes(&self, counts: &mut Counts) {
        let selector = &self.selector_28.unit.state.counters;
        counts.add("fragments", selector.dots.iter().sum::<u64>());
        for route in Route::ALL {
            counts.add(&format!("polygons_{}", route.name()), selector.polygons[route as usize]);
        }
        for route in Route::ALL {
            counts.add(&format!("dots_{}", route.name()), selector.dots[route as usize]);
        }
    }

    fn count_short_cuts(&self, counts: &mut Counts) {
        let counters = &self.microcomputer.unit.state.counters;
        counts.add("short_cut_specular_negligible", counters.specular_negligible);
        counts.add("short_cut_flat", counters.flat);
        counts.add("short_cut_same_plane", counters.reused);
    }

    fn count_processes(&self, counts: &mut Counts) {
        for (process, name) in Process::ALL {
            let counters = self.microcomputer.unit.state.counters.processes[process as usize];
            counts.add(&format!("{name}_runs"), counters.runs);
            counts.add(&format!("{name}_cycles"), counters.cycles);
        }
    }

    /// Of the rest of all cycles the circuits were idle: the accounting has it.
    fn count_circuits(&self, counts: &mut Counts) {
        let (linear, normal) = (&self.interpolation.unit.state.counters, &self.normal_interpolation.unit.state.counters);
        let gate = &self.gate.unit.state.counters;
        counts.add("interpolation_polygons", linear.polygons);
        counts.add("interpolation_dots", linear.drawn);
        counts.add("interpolation_started_cycles", linear.started_cycles);
        counts.add("normal_interpolation_polygons", normal.polygons);
        counts.add("normal_interpolation_dots", normal.drawn);
        counts.add("normal_interpolation_started_cycles", normal.started_cycles);
        counts.add("normal_interpolation_needed_cycles", normal.needed_cycles);
        counts.add("power_table_fills", normal.table_fills);
        counts.add("gate_passed", gate.passed);
        counts.add("gate_blocked", gate.blocked);
        counts.add("adder_sums", self.adder.unit.state.counters.sums);
    }
}
