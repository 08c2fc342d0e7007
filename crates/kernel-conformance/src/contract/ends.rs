//! The two sides of a bench: sources for each type of input, and sinks for each type of output.

use super::environment::TestEnvironment;
use basrelief_kernel::{Fifo, Inputs, Outputs, Sink, Source, Stage, Visitor};
use std::fmt::Debug;

/// The inputs of a unit with their sources. Implemented for `()`, `Option<A>` and `(Option<A>, Option<B>)`.
pub trait Popped: Sized {
    /// The tokens of each input: `()`, `Vec<A>` or `(Vec<A>, Vec<B>)`.
    type Tokens: Clone;
    /// The sources with their FIFOs.
    type Front: Front<Item = Self>;
    /// Makes sources of `tokens`.
    fn front(tokens: Self::Tokens, setting: &TestEnvironment) -> Self::Front;
}

/// Sources with their FIFOs.
pub trait Front {
    /// The tokens popped by the unit.
    type Item;
    /// The FIFO ends that the unit pops from.
    type Wires<'a>: Inputs<Item = Self::Item>
    where
        Self: 'a;
    /// Passes every source to the visitor.
    fn wire<V: Visitor>(&mut self, v: &mut V);
    /// Returns the FIFO ends that the unit pops from.
    fn ends(&mut self) -> Self::Wires<'_>;
}

/// The outputs of a unit with their sinks. Implemented for `()`, `Option<A>` and `(Option<A>, Option<B>)`.
pub trait Emitted: Sized {
    /// The tokens of each output: `()`, `Vec<A>` or `(Vec<A>, Vec<B>)`.
    type Tokens: Clone + Debug + PartialEq;
    /// The sinks with their FIFOs.
    type Back: Back<Item = Self, Tokens = Self::Tokens>;
    /// Makes sinks. They compare their tokens with `tokens`, if given.
    fn back(tokens: Option<Self::Tokens>, setting: &TestEnvironment) -> Self::Back;
}

/// Sinks with their FIFOs.
pub trait Back {
    /// The tokens emitted by the unit.
    type Item;
    /// The tokens of each output.
    type Tokens;
    /// The FIFO ends that the unit pushes to.
    type Wires<'a>: Outputs<Item = Self::Item>
    where
        Self: 'a;
    /// Passes every sink to the visitor.
    fn wire<V: Visitor>(&mut self, v: &mut V);
    /// Returns the FIFO ends that the unit pushes to.
    fn ends(&mut self) -> Self::Wires<'_>;
    /// Returns the collected tokens.
    fn tokens(&self) -> Self::Tokens;
}

/// A source and its FIFO.
#[derive(Clone, Debug)]
pub struct SourceEnd<T> {
    stage: Stage<Source<std::vec::IntoIter<T>>>,
    fifo: Fifo<T>,
}

impl<T> SourceEnd<T> {
    fn new(n: usize, tokens: Vec<T>, setting: &TestEnvironment) -> Self {
        let source = Source::new(tokens).with_gaps(&setting.source_gaps);
        let fifo = Fifo::new(&format!("input_{n}"), setting.depth, setting.latency);
        Self { stage: Stage::new(&format!("source_{n}"), source), fifo }
    }
}

/// A sink and its FIFO.
#[derive(Clone, Debug)]
pub struct SinkEnd<T> {
    stage: Stage<Sink<T>>,
    fifo: Fifo<T>,
}

impl<T: Debug + PartialEq> SinkEnd<T> {
    fn new(n: usize, tokens: Option<Vec<T>>, setting: &TestEnvironment) -> Self {
        let sink = tokens.map_or_else(Sink::new, Sink::expect).with_occupancy(&setting.sink_occupancy);
        let fifo = Fifo::new(&format!("output_{n}"), setting.depth, setting.latency);
        Self { stage: Stage::new(&format!("sink_{n}"), sink), fifo }
    }
}

impl Popped for () {
    type Tokens = ();
    type Front = ();
    fn front((): (), _: &TestEnvironment) {}
}

impl Front for () {
    type Item = ();
    type Wires<'a> = ();
    fn wire<V: Visitor>(&mut self, _: &mut V) {}
    fn ends(&mut self) {}
}

impl<A: Clone> Popped for Option<A> {
    type Tokens = Vec<A>;
    type Front = SourceEnd<A>;
    fn front(tokens: Vec<A>, setting: &TestEnvironment) -> SourceEnd<A> {
        SourceEnd::new(0, tokens, setting)
    }
}

impl<A> Front for SourceEnd<A> {
    type Item = Option<A>;
    type Wires<'a>
        = &'a mut Fifo<A>
    where
        A: 'a;
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(self.stage.between((), &mut self.fifo));
    }
    fn ends(&mut self) -> &mut Fifo<A> {
        &mut self.fifo
    }
}

impl<A: Clone, B: Clone> Popped for (Option<A>, Option<B>) {
    type Tokens = (Vec<A>, Vec<B>);
    type Front = (SourceEnd<A>, SourceEnd<B>);
    fn front((a, b): (Vec<A>, Vec<B>), setting: &TestEnvironment) -> Self::Front {
        (SourceEnd::new(0, a, setting), SourceEnd::new(1, b, setting))
    }
}

impl<A, B> Front for (SourceEnd<A>, SourceEnd<B>) {
    type Item = (Option<A>, Option<B>);
    type Wires<'a>
        = (&'a mut Fifo<A>, &'a mut Fifo<B>)
    where
        A: 'a,
        B: 'a;
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        self.0.wire(v);
        self.1.wire(v);
    }
    fn ends(&mut self) -> Self::Wires<'_> {
        (&mut self.0.fifo, &mut self.1.fifo)
    }
}

impl Emitted for () {
    type Tokens = ();
    type Back = ();
    fn back(_: Option<()>, _: &TestEnvironment) {}
}

impl Back for () {
    type Item = ();
    type Tokens = ();
    type Wires<'a> = ();
    fn wire<V: Visitor>(&mut self, _: &mut V) {}
    fn ends(&mut self) {}
    fn tokens(&self) {}
}

impl<A: Clone + Debug + PartialEq> Emitted for Option<A> {
    type Tokens = Vec<A>;
    type Back = SinkEnd<A>;
    fn back(tokens: Option<Vec<A>>, setting: &TestEnvironment) -> SinkEnd<A> {
        SinkEnd::new(0, tokens, setting)
    }
}

impl<A: Clone + Debug + PartialEq> Back for SinkEnd<A> {
    type Item = Option<A>;
    type Tokens = Vec<A>;
    type Wires<'a>
        = &'a mut Fifo<A>
    where
        A: 'a;
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(self.stage.between(&mut self.fifo, ()));
    }
    fn ends(&mut self) -> &mut Fifo<A> {
        &mut self.fifo
    }
    fn tokens(&self) -> Vec<A> {
        self.stage.unit.tokens().to_vec()
    }
}

impl<A: Clone + Debug + PartialEq, B: Clone + Debug + PartialEq> Emitted for (Option<A>, Option<B>) {
    type Tokens = (Vec<A>, Vec<B>);
    type Back = (SinkEnd<A>, SinkEnd<B>);
    fn back(tokens: Option<(Vec<A>, Vec<B>)>, setting: &TestEnvironment) -> Self::Back {
        let (a, b) = tokens.unzip();
        (SinkEnd::new(0, a, setting), SinkEnd::new(1, b, setting))
    }
}

impl<A: Clone + Debug + PartialEq, B: Clone + Debug + PartialEq> Back for (SinkEnd<A>, SinkEnd<B>) {
    type Item = (Option<A>, Option<B>);
    type Tokens = (Vec<A>, Vec<B>);
    type Wires<'a>
        = (&'a mut Fifo<A>, &'a mut Fifo<B>)
    where
        A: 'a,
        B: 'a;
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        self.0.wire(v);
        self.1.wire(v);
    }
    fn ends(&mut self) -> Self::Wires<'_> {
        (&mut self.0.fifo, &mut self.1.fifo)
    }
    fn tokens(&self) -> Self::Tokens {
        (self.0.tokens(), self.1.tokens())
    }
}
