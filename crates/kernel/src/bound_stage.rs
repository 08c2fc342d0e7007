//! Bound stages: a stage with the FIFOs on its two sides and the memories that it uses.

use crate::connections::{Clients, Connections, MemoryClients};
use crate::wires::{Inputs, Outputs};
use crate::{MemorySystem, Stage, Unit};

/// One stage with its connections, as a visitor sees it. Made by [`Stage::between`].
pub trait BoundStage {
    /// The unit.
    type Unit: Unit;
    /// The FIFOs that it pops from.
    type Inputs: Inputs<Item = <Self::Unit as Unit>::In>;
    /// The FIFOs that it pushes to.
    type Outputs: Outputs<Item = <Self::Unit as Unit>::Out>;
    /// Its memory clients; `()` if it has none.
    type Clients: Clients;

    /// Returns the stage and its connections.
    fn open(&mut self) -> (&mut Stage<Self::Unit>, &mut ConnectionsOf<Self>);
}

/// Connections of a bound stage.
pub type ConnectionsOf<P> = Connections<<P as BoundStage>::Inputs, <P as BoundStage>::Outputs, <P as BoundStage>::Clients>;

/// A stage with its connections: the only [`BoundStage`].
#[derive(Debug)]
pub struct ConnectedStage<'m, U, I, O, C> {
    stage: &'m mut Stage<U>,
    connections: Connections<I, O, C>,
}

impl<U: Unit> Stage<U> {
    /// Binds this stage to its input FIFOs and its output FIFOs: `()`, `&mut fifo`, a tuple of FIFOs, or a vector.
    #[inline]
    pub fn between<I, O>(&mut self, inputs: I, outputs: O) -> ConnectedStage<'_, U, I, O, ()>
    where
        I: Inputs<Item = U::In>,
        O: Outputs<Item = U::Out>,
    {
        ConnectedStage { stage: self, connections: Connections { inputs, outputs, clients: () } }
    }
}

impl<'m, U, I, O> ConnectedStage<'m, U, I, O, ()> {
    /// Adds clients `ids` of the machine's memories, in the order in which the unit numbers them.
    #[inline]
    pub fn using(self, memories: &'m mut MemorySystem, ids: &'m [usize]) -> ConnectedStage<'m, U, I, O, MemoryClients<'m>> {
        let Connections { inputs, outputs, clients: () } = self.connections;
        let clients = MemoryClients { memories, ids };
        ConnectedStage { stage: self.stage, connections: Connections { inputs, outputs, clients } }
    }
}

impl<U, I, O, C> BoundStage for ConnectedStage<'_, U, I, O, C>
where
    U: Unit,
    I: Inputs<Item = U::In>,
    O: Outputs<Item = U::Out>,
    C: Clients,
{
    type Unit = U;
    type Inputs = I;
    type Outputs = O;
    type Clients = C;

    #[inline(always)]
    fn open(&mut self) -> (&mut Stage<U>, &mut Connections<I, O, C>) {
        (self.stage, &mut self.connections)
    }
}
