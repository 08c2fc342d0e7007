//! Units of three inputs or outputs with two of them on one wire, because the unit contract supports at most two.

use basrelief_deferred_renderer::tokens::{ExpandedTile, MarkFlow, PassFlow, PassRound, StoreOrder, TileRequest, TileResponse};
use basrelief_deferred_renderer::{LightingMode, PathConfig, Rasterization, Server, TextureMemory, TileEncoding, TileLists};
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_signals::Control;

/// The lists with orders and rounds on one wire.
#[derive(Clone)]
pub struct TwoOutputs(pub TileLists);

/// Tokens to the texture-data memory (130), and to the reference buffer (126).
pub type Orders = (Option<StoreOrder>, Option<PassRound>);

impl Unit for TwoOutputs {
    type In = (Option<MarkFlow>, Option<MarkFlow>);
    type Out = (Option<TileRequest>, Option<Orders>);

    fn demand(&self) -> Demand {
        self.0.demand()
    }

    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        self.0.step(input, traffic).map(|(request, order, round)| {
            let orders = (order.is_some() || round.is_some()).then_some((order, round));
            (request, orders)
        })
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The second and the third input of a unit on one wire. The unit never takes both.
#[derive(Clone, Debug, PartialEq)]
pub enum Either<A, B> {
    Second(A),
    Third(B),
}

impl<A, B> Either<A, B> {
    fn apart(either: Option<Self>) -> (Option<A>, Option<B>) {
        match either {
            Some(Self::Second(a)) => (Some(a), None),
            Some(Self::Third(b)) => (None, Some(b)),
            None => (None, None),
        }
    }
}

fn of_two(demand: Demand) -> Demand {
    if demand == Demand::Only(2) { Demand::Only(1) } else { demand }
}

/// The final rasterization with orders and tiles on one wire.
#[derive(Clone)]
pub struct TwoInputs(pub Rasterization);

impl Unit for TwoInputs {
    type In = (Option<PassFlow>, Option<Either<StoreOrder, ExpandedTile>>);
    type Out = <Rasterization as Unit>::Out;

    fn demand(&self) -> Demand {
        of_two(self.0.demand())
    }

    fn step(&mut self, (pass, other): Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let (order, tile) = Either::apart(other);
        self.0.step((pass, order, tile), traffic)
    }

    fn largest_step(&self, client: usize) -> u32 {
        self.0.largest_step(client)
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The server with requests and the news of a picture on one wire. Each server has a tile source of its own.
pub struct Requested(pub Server);

impl Requested {
    pub fn new() -> Self {
        Self(Server::new(PathConfig::default(), LightingMode::None, Box::new(TextureMemory::new(TileEncoding::Raw, 85))))
    }
}

impl Clone for Requested {
    fn clone(&self) -> Self {
        let mut copy = Self::new();
        copy.0.state = self.0.state.clone();
        copy
    }
}

impl Unit for Requested {
    type In = (Option<Control>, Option<Either<TileRequest, ()>>);
    type Out = Option<TileResponse>;

    fn demand(&self) -> Demand {
        of_two(self.0.demand())
    }

    fn step(&mut self, (control, other): Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let (request, shown) = Either::apart(other);
        self.0.step((control, request, shown), traffic)
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
