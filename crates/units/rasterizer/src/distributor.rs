//! Distributor: "polygons that are no bump target go straight to the graphics processor".

use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_signals::{Control, Flow, Fragment, Stamp};
use serde::{Deserialize, Serialize};

/// State of the distributor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DistributorState {
    /// True if the current polygon is not a bump target.
    pub plain: bool,
}

/// Distributor that sends fragments of bump targets to output 0 (the bump-mapping processor (106)) and others to output 1 (the
/// graphics processor (104)).
///
/// All control goes to output 0, which therefore defines the order. Output 1 gets duplicates of two control tokens per polygon
/// that is not a bump target: the token of the polygon, and the token that ends it. The graphics processor merges the two paths
/// by these duplicates. Output 1 stays empty while bump targets are gathered in (106), however many. (Duplicates of all control
/// tokens were rejected in analysis: a code book per object would deadlock on objects of more polygons than FIFO
/// `plain_fragments` has slots.)
#[derive(Clone, Copy, Debug, Default)]
pub struct Distributor {
    /// State between steps.
    pub state: DistributorState,
}

impl Unit for Distributor {
    basrelief_kernel::unit_info!("sends fragments without bump mapping directly to (104)");
    type In = Option<Flow<Stamp<Fragment>>>;
    type Out = (Option<Flow<Stamp<Fragment>>>, Option<Flow<Stamp<Fragment>>>);

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let out = match input {
            Some(Flow::Control(control)) => {
                let ends_plain = self.state.plain;
                self.state.plain = matches!(&control, Control::Polygon(polygon) if !polygon.bump);
                let twin = (ends_plain || self.state.plain).then(|| Flow::Control(control.clone()));
                (Some(Flow::Control(control)), twin)
            }
            Some(item) if self.state.plain => (None, Some(item)),
            other => (other, None),
        };
        Step::after(0, out)
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        (0..2).for_each(|output| stats.rate(output, 0_u64, 1_u64));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::Polygon;
    use std::sync::Arc;

    fn polygon(bump: bool) -> Flow<Stamp<Fragment>> {
        let material = Arc::default();
        let polygon = Polygon { vertices: Vec::new(), material, object: 0, lod: 0, bump, arrival: 0 };
        Flow::Control(Control::Polygon(Arc::new(polygon)))
    }

    #[test]
    fn distributor_brackets_plain_polygons_with_control() {
        let mut unit = Distributor::default();
        let mut step = |token: &Flow<Stamp<Fragment>>| unit.step(Some(token.clone()), &mut MemoryPorts::default()).out;
        let fragment = Flow::Item(Stamp::from_iter([Fragment { x: 3, ..Fragment::default() }; 2]));
        let mut plain_before = false;
        for bump in [true, false, false, true, true] {
            let control = polygon(bump);
            let twin = (plain_before || !bump).then(|| control.clone());
            assert_eq!(step(&control), (Some(control.clone()), twin));
            let expected = if bump { (Some(fragment.clone()), None) } else { (None, Some(fragment.clone())) };
            assert_eq!(step(&fragment), expected);
            plain_before = !bump;
        }
    }
}
