//! Collection of the statistics of a machine.

use super::{SlowFifo, UnitStats};
use crate::hardware::{Hardware, HardwareKind};
use crate::machine::{Machine, Visitor};
use crate::wires::{Outputs, Wires};
use crate::{BoundStage, Unit};

impl UnitStats {
    /// Reports the FIFOs that a unit fills and whose width is known.
    fn report_fifos(&mut self, outputs: &impl Outputs) {
        for link in (0..outputs.count()).map(|i| outputs.link(i)).filter(|link| link.bits() > 0) {
            let (place, count, width) = (link.name().to_owned(), link.depth() as u64, link.bits());
            self.hardware.push(Hardware { place, kind: HardwareKind::Fifo, about: "slots", count, width });
        }
    }
}

/// Collects the statistics of every unit of a machine. Call it after a run, not during one, because some statistics take a while.
pub fn unit_stats(machine: &mut impl Machine) -> UnitStats {
    struct StatsVisitor(UnitStats);
    impl Visitor for StatsVisitor {
        fn stage<P: BoundStage>(&mut self, mut place: P) {
            let (stage, connections) = place.open();
            self.0.place = stage.name().into();
            stage.unit.report_stats(&mut self.0);
            let outputs = &connections.outputs;
            self.0.report_fifos(outputs);
            for rate in std::mem::take(&mut self.0.rates) {
                assert!(rate.output < outputs.count(), "{} tells the rate of output {}", stage.name(), rate.output);
                self.0.slow_fifos.extend(SlowFifo::of(outputs.link(rate.output), rate));
            }
        }
    }
    let mut gather = StatsVisitor(UnitStats::default());
    machine.wire(&mut gather);
    let caches = machine.memories().clients().iter().filter_map(|client| client.cache.as_ref());
    gather.0.hardware.extend(caches.flat_map(|cache| Hardware::of_cache(&cache.name, &cache.config)));
    gather.0
}
