//! Deep FIFOs. The ring of their times begins small, grows, and uses entries again.

use crate::common::{PlanBuilder, run_both, small_memory};
use basrelief_kernel_conformance::plan::{Plan, PlanRequest, UnitKind};
use proptest::collection::vec;
use proptest::prelude::*;

/// Bursts: for so many tokens in a row, so many cycles per token.
type Pace = Vec<(usize, u64)>;

fn pace() -> impl Strategy<Value = Pace> {
    vec((1_usize..300, 1_u64..6), 1..4)
}

fn occupancy(pace: &Pace) -> Vec<u64> {
    pace.iter().flat_map(|&(tokens, cycles)| std::iter::repeat_n(cycles, tokens)).collect()
}

/// Returns a chain with two FIFOs of these depths around a unit that reads a memory.
fn chain(depths: [usize; 2], tokens: u64, paces: &[Pace; 3]) -> Plan {
    let [source, reader, sink] = paces.each_ref().map(occupancy);
    let request = PlanRequest { port: "port".into(), write: false, bytes: 4, stride: 32, offset: 0, span: 512 };
    let mut draw = PlanBuilder::default();
    draw.fifo("before", depths[0], 1)
        .fifo("behind", depths[1], 2)
        .memory(small_memory(), &[("port", 4)])
        .unit("source", UnitKind::Source { tokens }, ["", "before"], &source, &[3])
        .unit("reader", UnitKind::Access { requests: vec![request] }, ["before", "behind"], &reader, &[1])
        .unit("sink", UnitKind::Sink, ["behind", ""], &sink, &[0]);
    draw.0
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn deep_fifos_keep_the_times_they_need(
        depths in prop::array::uniform2(60_usize..300), tokens in 300_u64..1000, paces in [pace(), pace(), pace()],
    ) {
        // `run_both` compares the engines and resimulation.
        run_both(&chain(depths, tokens, &paces), u64::MAX);
    }
}
