//! Distributor: "polygons that are no bump target go straight to the graphics processor".

use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_signals::{Control, Flow, Fragment};
use serde::{Deserialize, Serialize};

/// Everything the distributor remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DistributorState {
    /// The polygon that is passing is a bump target.
    pub bump: bool,
}

/// Sends fragments of bump targets to output 0 (the bump-mapping processor (106)), others to output 1 (the graphics
/// processor (104)). Control goes to both: each twin marks the same place in the order, by which the graphics processor
/// merges them again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Distributor {
    /// Everything it remembers.
    pub state: DistributorState,
}

impl Unit for Distributor {
    type In = Option<Flow<Fragment>>;
    type Out = (Option<Flow<Fragment>>, Option<Flow<Fragment>>);

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut Traffic) -> Step<Self::Out> {
        let out = match input {
            Some(Flow::Control(control)) => {
                if let Control::Polygon(polygon) = &control {
                    self.state.bump = polygon.bump;
                }
                (Some(Flow::Control(control.clone())), Some(Flow::Control(control)))
            }
            Some(item) if self.state.bump => (Some(item), None),
            other => (None, other),
        };
        Step::after(0, out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::Polygon;
    use std::sync::Arc;

    fn polygon(bump: bool) -> Flow<Fragment> {
        let material = Arc::default();
        let polygon = Polygon { vertices: Vec::new(), material, object: 0, lod: 0, bump, arrival: 0 };
        Flow::Control(Control::Polygon(Arc::new(polygon)))
    }

    #[test]
    fn control_goes_both_ways_fragments_one() {
        let mut unit = Distributor::default();
        let mut step = |token: &Flow<Fragment>| unit.step(Some(token.clone()), &mut Traffic::default()).out;
        let fragment = Flow::Item(Fragment { x: 3, ..Fragment::default() });
        for bump in [true, false, true] {
            let control = polygon(bump);
            assert_eq!(step(&control), (Some(control.clone()), Some(control)));
            let expected = if bump { (Some(fragment.clone()), None) } else { (None, Some(fragment.clone())) };
            assert_eq!(step(&fragment), expected);
        }
    }
}
