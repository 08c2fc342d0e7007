//! A place in the block diagram: a stage, the FIFOs on its two sides, and the memories that it uses.

use crate::stage::{Clock, Needs, Start, Wait};
use crate::wiring::{Inputs, Outputs};
use crate::{Cause, Cycle, Demand, MemorySystem, Stage, Unit};

/// What a visitor is shown: one stage in its place. Made by [`Stage::between`].
pub trait Place {
    /// The unit.
    type Unit: Unit;
    /// The FIFOs that it pops from.
    type Inputs: Inputs<Item = <Self::Unit as Unit>::In>;
    /// The FIFOs that it pushes to.
    type Outputs: Outputs<Item = <Self::Unit as Unit>::Out>;
    /// Its memory clients; `()` where it has none.
    type Clients: Clients;

    /// The stage, and what it is connected to.
    fn open(&mut self) -> (&mut Stage<Self::Unit>, &mut ConnectionsOf<Self>);
}

/// What the stage of a place is connected to.
pub type ConnectionsOf<P> = Connections<<P as Place>::Inputs, <P as Place>::Outputs, <P as Place>::Clients>;

/// What a stage is connected to.
#[derive(Debug)]
pub struct Connections<I, O, C> {
    /// The FIFOs that it pops from, in order.
    pub inputs: I,
    /// The FIFOs that it pushes to, in order.
    pub outputs: O,
    /// Its memory clients.
    pub clients: C,
}

/// A stage between FIFOs: the one [`Place`] there is.
#[derive(Debug)]
pub struct Between<'m, U, I, O, C> {
    stage: &'m mut Stage<U>,
    connections: Connections<I, O, C>,
}

impl<U: Unit> Stage<U> {
    /// This stage between the FIFOs that it pops from and those that it pushes to: `()`, `&mut fifo`, a tuple of several,
    /// or a vector.
    #[inline]
    pub fn between<I, O>(&mut self, inputs: I, outputs: O) -> Between<'_, U, I, O, ()>
    where
        I: Inputs<Item = U::In>,
        O: Outputs<Item = U::Out>,
    {
        Between { stage: self, connections: Connections { inputs, outputs, clients: () } }
    }
}

impl<'m, U, I, O> Between<'m, U, I, O, ()> {
    /// With clients `ids` of the machine's memories, in the order in which the unit numbers them.
    #[inline]
    pub fn using(self, memories: &'m mut MemorySystem, ids: &'m [usize]) -> Between<'m, U, I, O, MemoryClients<'m>> {
        let Connections { inputs, outputs, clients: () } = self.connections;
        let clients = MemoryClients { memories, ids };
        Between { stage: self.stage, connections: Connections { inputs, outputs, clients } }
    }
}

impl<U, I, O, C> Place for Between<'_, U, I, O, C>
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

/// The memory clients of one stage, in the order in which its unit numbers them. The type tells at compile time whether
/// there are any: stages without memory pay nothing for those that have it.
pub trait Clients {
    /// Whether there can be any.
    const HAS_MEMORY: bool;
    /// Their numbers among the machine's memories.
    fn ids(&self) -> &[usize];
    /// The machine's memories.
    fn memories(&self) -> Option<&MemorySystem>;
    /// Both at once.
    fn open(&mut self) -> Option<(&[usize], &mut MemorySystem)>;
}

/// None.
impl Clients for () {
    const HAS_MEMORY: bool = false;
    #[inline(always)]
    fn ids(&self) -> &[usize] {
        &[]
    }
    #[inline(always)]
    fn memories(&self) -> Option<&MemorySystem> {
        None
    }
    #[inline(always)]
    fn open(&mut self) -> Option<(&[usize], &mut MemorySystem)> {
        None
    }
}

/// Clients of the machine's memories, by number.
#[derive(Debug)]
pub struct MemoryClients<'m> {
    memories: &'m mut MemorySystem,
    ids: &'m [usize],
}

impl Clients for MemoryClients<'_> {
    const HAS_MEMORY: bool = true;
    #[inline(always)]
    fn ids(&self) -> &[usize] {
        self.ids
    }
    #[inline(always)]
    fn memories(&self) -> Option<&MemorySystem> {
        Some(self.memories)
    }
    #[inline(always)]
    fn open(&mut self) -> Option<(&[usize], &mut MemorySystem)> {
        Some((self.ids, self.memories))
    }
}

impl<I: Inputs, O: Outputs, C: Clients> Connections<I, O, C> {
    /// The earliest start of the unit's next step (law 3); `None` if it will make no further step.
    ///
    /// What runs in every step is marked to be inlined always: a step is a dozen comparisons, and left to itself the compiler
    /// inlines them or not as it happens to divide the crates into units of code.
    #[inline(always)]
    pub(crate) fn next_start(&self, unit: &impl Unit, clock: &Clock) -> Option<Start> {
        let Self { inputs, outputs, clients } = self;
        let demand = unit.demand();
        if demand == Demand::Finished {
            return None;
        }
        let mut at = clock.free;
        for i in (0..inputs.count()).filter(|&i| demand.takes(i)) {
            at = at.max(inputs.link(i).front_visible());
        }
        // Most visits end here: what else is unknown makes no difference.
        if !at.is_known() {
            return Some(Start { at, demand });
        }
        for i in 0..outputs.count() {
            at = at.max(outputs.link(i).room_at());
        }
        if let Some(memories) = clients.memories() {
            for (&client, &credits) in clients.ids().iter().zip(&clock.needs.credits) {
                at = at.max(memories.credits_at(client, credits));
            }
        }
        Some(Start { at, demand })
    }

    /// Promises that the unit makes no step before it can at the earliest: with what its neighbours have promised, where they
    /// have not come so far yet. Its neighbours build on that in turn, and its memories serve what others asked for until
    /// then.
    #[inline(always)]
    pub(crate) fn promise(&mut self, demand: Demand, free: Cycle) {
        let Self { inputs, outputs, clients } = self;
        let mut start = if demand == Demand::Finished { Cycle::UNKNOWN } else { free };
        for i in (0..inputs.count()).filter(|&i| demand.takes(i)) {
            start = start.max(inputs.link(i).no_front_before());
        }
        for i in 0..outputs.count() {
            start = start.max(outputs.link(i).no_room_before());
        }
        for i in 0..inputs.count() {
            inputs.link_mut(i).promise_pop(start);
        }
        for i in 0..outputs.count() {
            outputs.link_mut(i).promise_push(start);
        }
        if let Some((ids, memories)) = clients.open() {
            ids.iter().for_each(|&client| memories.promise(client, start));
        }
    }

    /// Splits the wait from `from` to `to` into its causes (law 9), in order, and hands each to `charge`.
    ///
    /// In each cycle the first cause that applies counts; every condition, once met, stays met until the step starts. So
    /// the causes follow each other in the order in which they are tried, and a running maximum splits the interval.
    pub(crate) fn split_wait(&self, needs: &Needs, demand: Demand, (from, to): (Cycle, Cycle), mut charge: impl FnMut(Wait)) {
        let Self { inputs, outputs, clients } = self;
        let mut at = from;
        // Tells whether nothing of the interval is left.
        let mut until = |cause: Cause, end: Cycle| {
            let end = end.min(to);
            if end > at {
                charge((cause, at, end));
                at = end;
            }
            at >= to
        };
        for i in (0..inputs.count()).filter(|&i| demand.takes(i)) {
            if until(Cause::Starved(i), inputs.link(i).front_visible()) {
                return;
            }
        }
        if let Some(memories) = clients.memories() {
            for (i, (&client, &credits)) in clients.ids().iter().zip(&needs.credits).enumerate() {
                if until(Cause::Memory(i), memories.credits_at(client, credits)) {
                    return;
                }
            }
        }
        for i in 0..outputs.count() {
            let link = outputs.link(i);
            let room = link.room_at();
            for &client in needs.served_in_order.iter().take(clients.ids().len()) {
                until(Cause::Memory(client), link.oldest_awaits(client).min(room));
            }
            until(Cause::Blocked(i), room);
        }
    }
}
