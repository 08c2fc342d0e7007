//! Bundles of FIFOs: the connections of one unit.

use crate::{Demand, Fifo, FifoInfo, Label, TokenBits, TokenField};

/// Panics: the caller named a FIFO that the bundle does not have.
#[cold]
fn no_fifo() -> ! {
    unreachable!("no FIFO here")
}

/// A bundle of FIFOs at one end of a unit: `()`, `&mut Fifo<T>`, a tuple of two to six, or a vector.
pub trait Wires {
    /// Number of FIFOs.
    fn count(&self) -> usize;
    /// Returns FIFO `i` without its tokens.
    fn link(&self, i: usize) -> &FifoInfo;
    /// As `link`, but mutable.
    fn link_mut(&mut self, i: usize) -> &mut FifoInfo;
}

/// The FIFOs from which a unit pops.
pub trait Inputs: Wires {
    /// The tokens that a step receives.
    type Item;
    /// Number of FIFOs, if the type determines it.
    const COUNT: Option<usize>;
    /// Pops the tokens that `demand` declares.
    fn pop(&mut self, demand: Demand) -> Self::Item;
}

/// The FIFOs to which a unit pushes.
pub trait Outputs: Wires {
    /// The tokens that a step emits.
    type Item;
    /// Number of FIFOs, if the type determines it.
    const COUNT: Option<usize>;
    /// Pushes the emitted tokens. Bit i of the result: FIFO i got a token.
    fn push(&mut self, item: Self::Item) -> u32;
    /// Returns the label of the token that was pushed last to FIFO `i`.
    fn last_label(&self, i: usize) -> Label;
    /// Returns the bits of the token that was pushed last to FIFO `i`.
    fn last_bits(&self, i: usize) -> TokenBits;
    /// Returns the fields of the tokens of FIFO `i`.
    fn token_fields(&self, i: usize) -> Vec<TokenField>;
}

impl Wires for () {
    fn count(&self) -> usize {
        0
    }
    fn link(&self, _: usize) -> &FifoInfo {
        no_fifo()
    }
    fn link_mut(&mut self, _: usize) -> &mut FifoInfo {
        no_fifo()
    }
}

impl Inputs for () {
    type Item = ();
    const COUNT: Option<usize> = Some(0);
    fn pop(&mut self, _: Demand) {}
}

impl Outputs for () {
    type Item = ();
    const COUNT: Option<usize> = Some(0);
    fn push(&mut self, (): ()) -> u32 {
        0
    }
    fn last_label(&self, _: usize) -> Label {
        no_fifo()
    }
    fn last_bits(&self, _: usize) -> TokenBits {
        no_fifo()
    }
    fn token_fields(&self, _: usize) -> Vec<TokenField> {
        no_fifo()
    }
}

impl<T> Wires for &mut Fifo<T> {
    #[inline]
    fn count(&self) -> usize {
        1
    }
    #[inline]
    fn link(&self, _: usize) -> &FifoInfo {
        &self.link
    }
    #[inline]
    fn link_mut(&mut self, _: usize) -> &mut FifoInfo {
        &mut self.link
    }
}

impl<T> Inputs for &mut Fifo<T> {
    type Item = Option<T>;
    const COUNT: Option<usize> = Some(1);
    #[inline(always)]
    fn pop(&mut self, demand: Demand) -> Option<T> {
        self.take_if(demand.takes(0))
    }
}

impl<T> Outputs for &mut Fifo<T> {
    type Item = Option<T>;
    const COUNT: Option<usize> = Some(1);
    #[inline(always)]
    fn push(&mut self, item: Option<T>) -> u32 {
        self.put(item)
    }
    fn last_label(&self, _: usize) -> Label {
        self.newest_label()
    }
    fn last_bits(&self, _: usize) -> TokenBits {
        self.newest_bits()
    }
    fn token_fields(&self, _: usize) -> Vec<TokenField> {
        self.fields()
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
            fn link(&self, i: usize) -> &FifoInfo {
                match i {
                    $($i => &self.$i.link,)*
                    _ => no_fifo(),
                }
            }
            #[inline]
            fn link_mut(&mut self, i: usize) -> &mut FifoInfo {
                match i {
                    $($i => &mut self.$i.link,)*
                    _ => no_fifo(),
                }
            }
        }

        impl<$($token),*> Inputs for ($(&mut Fifo<$token>,)*) {
            type Item = ($(Option<$token>,)*);
            const COUNT: Option<usize> = Some($count);
            #[inline(always)]
            fn pop(&mut self, demand: Demand) -> Self::Item {
                ($(self.$i.take_if(demand.takes($i)),)*)
            }
        }

        impl<$($token),*> Outputs for ($(&mut Fifo<$token>,)*) {
            type Item = ($(Option<$token>,)*);
            const COUNT: Option<usize> = Some($count);
            #[inline(always)]
            fn push(&mut self, item: Self::Item) -> u32 {
                0 $(| self.$i.put(item.$i) << $i)*
            }
            fn last_label(&self, i: usize) -> Label {
                match i {
                    $($i => self.$i.newest_label(),)*
                    _ => no_fifo(),
                }
            }
            fn last_bits(&self, i: usize) -> TokenBits {
                match i {
                    $($i => self.$i.newest_bits(),)*
                    _ => no_fifo(),
                }
            }
            fn token_fields(&self, i: usize) -> Vec<TokenField> {
                match i {
                    $($i => self.$i.fields(),)*
                    _ => no_fifo(),
                }
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
    fn link(&self, i: usize) -> &FifoInfo {
        &self[i].link
    }
    fn link_mut(&mut self, i: usize) -> &mut FifoInfo {
        &mut self[i].link
    }
}

impl<T> Inputs for Vec<&mut Fifo<T>> {
    type Item = Vec<Option<T>>;
    const COUNT: Option<usize> = None;
    fn pop(&mut self, demand: Demand) -> Self::Item {
        self.iter_mut().enumerate().map(|(i, f)| f.take_if(demand.takes(i))).collect()
    }
}

impl<T> Outputs for Vec<&mut Fifo<T>> {
    type Item = Vec<Option<T>>;
    const COUNT: Option<usize> = None;
    fn push(&mut self, item: Self::Item) -> u32 {
        self.iter_mut().zip(item).enumerate().fold(0, |mask, (i, (f, x))| mask | f.put(x) << i)
    }
    fn last_label(&self, i: usize) -> Label {
        self[i].newest_label()
    }
    fn last_bits(&self, i: usize) -> TokenBits {
        self[i].newest_bits()
    }
    fn token_fields(&self, i: usize) -> Vec<TokenField> {
        self[i].fields()
    }
}
