//! Wiring: how a machine shows its block diagram to the visitors that run, account for and describe it.

use crate::{Cycle, Demand, Fifo, Link, MemorySystem, Place};

/// Most inputs or outputs of one unit.
pub const MAX_LINKS: usize = 8;
/// Most memory clients of one unit.
pub const MAX_CLIENTS: usize = 4;

/// A bundle of FIFOs at one end of a unit: `()`, `&mut Fifo<T>`, a tuple of two to six, or a vector.
pub trait Wires {
    /// Number of FIFOs.
    fn count(&self) -> usize;
    /// Times of FIFO `i`.
    fn link(&self, i: usize) -> &Link;
    /// Mutable times of FIFO `i`.
    fn link_mut(&mut self, i: usize) -> &mut Link;
}

/// What a unit pops from.
pub trait Inputs: Wires {
    /// What a step is given.
    type Item;
    /// Pops what `demand` declares, at `at`.
    fn pop(&mut self, demand: Demand, at: Cycle) -> Self::Item;
    /// Pops what `demand` declares, without time.
    fn take(&mut self, demand: Demand) -> Self::Item;
}

/// What a unit pushes to.
pub trait Outputs: Wires {
    /// What a step emits.
    type Item;
    /// Reserves slots for what is emitted; bit i of the answer: FIFO i got a token.
    fn reserve(&mut self, start: Cycle, item: Self::Item) -> u32;
    /// Puts what is emitted, without time.
    fn put(&mut self, item: Self::Item);
}

impl Wires for () {
    fn count(&self) -> usize {
        0
    }
    fn link(&self, _: usize) -> &Link {
        unreachable!("no FIFO here")
    }
    fn link_mut(&mut self, _: usize) -> &mut Link {
        unreachable!("no FIFO here")
    }
}

impl Inputs for () {
    type Item = ();
    fn pop(&mut self, _: Demand, _: Cycle) {}
    fn take(&mut self, _: Demand) {}
}

impl Outputs for () {
    type Item = ();
    fn reserve(&mut self, _: Cycle, (): ()) -> u32 {
        0
    }
    fn put(&mut self, (): ()) {}
}

impl<T> Wires for &mut Fifo<T> {
    #[inline]
    fn count(&self) -> usize {
        1
    }
    #[inline]
    fn link(&self, _: usize) -> &Link {
        &self.link
    }
    #[inline]
    fn link_mut(&mut self, _: usize) -> &mut Link {
        &mut self.link
    }
}

impl<T> Inputs for &mut Fifo<T> {
    type Item = Option<T>;
    #[inline(always)]
    fn pop(&mut self, demand: Demand, at: Cycle) -> Option<T> {
        self.pop_if(demand.takes(0), at)
    }
    #[inline]
    fn take(&mut self, demand: Demand) -> Option<T> {
        self.take_if(demand.takes(0))
    }
}

impl<T> Outputs for &mut Fifo<T> {
    type Item = Option<T>;
    #[inline(always)]
    fn reserve(&mut self, start: Cycle, item: Option<T>) -> u32 {
        Fifo::reserve(self, start, item)
    }
    #[inline]
    fn put(&mut self, item: Option<T>) {
        Fifo::put(self, item);
    }
}

/// A bundle of several FIFOs, each of its own type.
macro_rules! tuple_of_fifos {
    ($count:literal: $($token:ident $i:tt),*) => {
        impl<$($token),*> Wires for ($(&mut Fifo<$token>,)*) {
            #[inline]
            fn count(&self) -> usize {
                $count
            }
            #[inline]
            fn link(&self, i: usize) -> &Link {
                match i {
                    $($i => &self.$i.link,)*
                    _ => unreachable!("no FIFO here"),
                }
            }
            #[inline]
            fn link_mut(&mut self, i: usize) -> &mut Link {
                match i {
                    $($i => &mut self.$i.link,)*
                    _ => unreachable!("no FIFO here"),
                }
            }
        }

        impl<$($token),*> Inputs for ($(&mut Fifo<$token>,)*) {
            type Item = ($(Option<$token>,)*);
            #[inline(always)]
            fn pop(&mut self, demand: Demand, at: Cycle) -> Self::Item {
                ($(self.$i.pop_if(demand.takes($i), at),)*)
            }
            #[inline]
            fn take(&mut self, demand: Demand) -> Self::Item {
                ($(self.$i.take_if(demand.takes($i)),)*)
            }
        }

        impl<$($token),*> Outputs for ($(&mut Fifo<$token>,)*) {
            type Item = ($(Option<$token>,)*);
            #[inline(always)]
            fn reserve(&mut self, start: Cycle, item: Self::Item) -> u32 {
                0 $(| Fifo::reserve(self.$i, start, item.$i) << $i)*
            }
            #[inline]
            fn put(&mut self, item: Self::Item) {
                $(Fifo::put(self.$i, item.$i);)*
            }
        }
    };
}

tuple_of_fifos!(2: A 0, B 1);
tuple_of_fifos!(3: A 0, B 1, C 2);
tuple_of_fifos!(4: A 0, B 1, C 2, D 3);
tuple_of_fifos!(5: A 0, B 1, C 2, D 3, E 4);
tuple_of_fifos!(6: A 0, B 1, C 2, D 3, E 4, F 5);

/// Any number of FIFOs of one type, for machines that are built from a plan.
impl<T> Wires for Vec<&mut Fifo<T>> {
    fn count(&self) -> usize {
        self.len()
    }
    fn link(&self, i: usize) -> &Link {
        &self[i].link
    }
    fn link_mut(&mut self, i: usize) -> &mut Link {
        &mut self[i].link
    }
}

impl<T> Inputs for Vec<&mut Fifo<T>> {
    type Item = Vec<Option<T>>;
    fn pop(&mut self, demand: Demand, at: Cycle) -> Self::Item {
        self.iter_mut().enumerate().map(|(i, f)| f.pop_if(demand.takes(i), at)).collect()
    }
    fn take(&mut self, demand: Demand) -> Self::Item {
        self.iter_mut().enumerate().map(|(i, f)| f.take_if(demand.takes(i))).collect()
    }
}

impl<T> Outputs for Vec<&mut Fifo<T>> {
    type Item = Vec<Option<T>>;
    fn reserve(&mut self, start: Cycle, item: Self::Item) -> u32 {
        self.iter_mut().zip(item).enumerate().fold(0, |mask, (i, (f, x))| mask | Fifo::reserve(f, start, x) << i)
    }
    fn put(&mut self, item: Self::Item) {
        self.iter_mut().zip(item).for_each(|(f, x)| Fifo::put(f, x));
    }
}

/// Who walks a machine's wiring: engines, accounting, reports.
pub trait Visitor {
    /// One stage in its place.
    fn stage<P: Place>(&mut self, place: P);
}

/// A machine: its `wire` function is its block diagram, and the only place where the topology stands.
pub trait Machine {
    /// Shows every stage to `v`, always in the same order.
    fn wire<V: Visitor>(&mut self, v: &mut V);
    /// The memories that its stages share.
    fn memories(&mut self) -> &mut MemorySystem;
}
