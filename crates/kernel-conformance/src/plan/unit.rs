//! The units of a plan.

use super::format::{PlannedUnit, UnitKind};
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};

/// A token of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// Token number.
    pub id: u64,
    /// True for the final token.
    pub last: bool,
}

/// A unit built from its plan.
#[derive(Clone, Debug)]
pub struct PlanUnit {
    plan: PlannedUnit,
    /// Client of each request, in order.
    clients: Vec<u32>,
    steps: u64,
    /// Token being expanded, and the number of its next child.
    expanding: Option<(Token, u64)>,
    /// Tokens that ended here, for a unit without outputs.
    consumed: Vec<Token>,
}

impl PlanUnit {
    /// Makes the unit. `clients` holds the client number of each request.
    pub fn new(plan: &PlannedUnit, clients: Vec<u32>) -> Self {
        Self { plan: plan.clone(), clients, steps: 0, expanding: None, consumed: Vec::new() }
    }

    /// Returns the tokens that ended here. The list is empty for a unit with outputs.
    pub(super) fn consumed_tokens(&self) -> &[Token] {
        &self.consumed
    }

    /// Returns whether a source or merge has passed all its tokens; `None` for other kinds.
    fn exhausted(&self) -> Option<bool> {
        match self.plan.kind {
            UnitKind::Source { tokens } | UnitKind::Merge { tokens } => Some(self.steps >= tokens),
            _ => None,
        }
    }

    fn to_every_output(&self, token: Token) -> Vec<Option<Token>> {
        vec![Some(token); self.plan.outputs.len()]
    }

    /// Returns the emitted tokens, and the id that determines the times of the step.
    fn emit(&mut self, taken: &[Option<Token>]) -> (Vec<Option<Token>>, u64) {
        let none = || vec![None; self.plan.outputs.len()];
        let first = taken.iter().flatten().next().copied().unwrap_or(Token { id: 0, last: false });
        match self.plan.kind {
            UnitKind::Source { tokens } | UnitKind::Merge { tokens } => {
                let token = Token { id: self.steps, last: self.steps + 1 == tokens };
                (self.to_every_output(token), token.id)
            }
            UnitKind::Work | UnitKind::Fork | UnitKind::Access { .. } | UnitKind::Cached { .. } | UnitKind::Mixed { .. } => {
                (self.to_every_output(first), first.id)
            }
            UnitKind::Gate { size } => (if self.is_at_feedback(size) { none() } else { self.to_every_output(first) }, first.id),
            UnitKind::Tap { size } => (vec![Some(first), (self.steps + 1).is_multiple_of(size).then_some(first)], first.id),
            UnitKind::Join => {
                let token = Token { last: taken.iter().flatten().any(|t| t.last), ..first };
                (self.to_every_output(token), token.id)
            }
            UnitKind::Route => {
                let mut out = none();
                let to = first.id as usize % out.len();
                out[to] = Some(first);
                (out, first.id)
            }
            UnitKind::Expand { factor } => {
                let (token, child) = self.expanding.unwrap_or((first, 0));
                self.expanding = (child + 1 < factor).then_some((token, child + 1));
                let token = Token { id: token.id * factor + child, last: token.last && child + 1 == factor };
                (self.to_every_output(token), token.id)
            }
            UnitKind::Gather { size } => {
                let full = first.id % size == size - 1 || first.last;
                let token = Token { id: first.id / size, ..first };
                (if full { self.to_every_output(token) } else { none() }, first.id)
            }
            UnitKind::Sink => (none(), first.id),
        }
    }

    /// Returns true if the next step of a gate consumes the token of its second input.
    fn is_at_feedback(&self, size: u64) -> bool {
        self.steps % (size + 1) == size
    }

    /// Returns true if a step has request `i`.
    fn has_request(&self, id: u64, i: usize) -> bool {
        match &self.plan.kind {
            UnitKind::Mixed { every, .. } => id.is_multiple_of(every[i % every.len()]),
            _ => true,
        }
    }

    /// Returns true if a step looks up lines.
    fn has_look_ups(&self, id: u64) -> bool {
        match &self.plan.kind {
            UnitKind::Mixed { look_up_every, .. } => id.is_multiple_of(*look_up_every),
            _ => true,
        }
    }

    /// Returns true if a step blocks.
    fn blocks(&self, id: u64) -> bool {
        match &self.plan.kind {
            UnitKind::Mixed { blocks, .. } => pick(blocks, id),
            _ => self.plan.blocking,
        }
    }

    fn issue(&self, id: u64, traffic: &mut MemoryPorts) {
        let requests = self.plan.kind.requests().iter().zip(&self.clients).enumerate();
        for (_, (r, &client)) in requests.filter(|(i, _)| self.has_request(id, *i)) {
            let address = address(id, r.stride, r.offset, r.span);
            if r.write {
                traffic.write(client, address, r.bytes);
            } else {
                traffic.read(client, address, r.bytes);
            }
        }
        for l in self.plan.kind.look_ups().iter().filter(|_| self.has_look_ups(id)) {
            traffic.look_up(self.cached_client(), address(id, l.stride, l.offset, l.span), 1);
        }
    }

    /// Returns the client with the cache: the one after those of the requests.
    fn cached_client(&self) -> u32 {
        self.clients.iter().max().map_or(0, |last| last + 1)
    }
}

/// Returns (id * stride + offset) mod span. Computes in 128 bits, because none of the operands is bounded.
fn address(id: u64, stride: u64, offset: u64, span: u64) -> u64 {
    let address = u128::from(id) * u128::from(stride) + u128::from(offset);
    u64::try_from(address % u128::from(span.max(1))).unwrap_or_default()
}

/// Picks a time by id modulo the length of the list.
fn pick<T: Copy>(list: &[T], id: u64) -> T {
    list[id as usize % list.len()]
}

impl Unit for PlanUnit {
    type In = Vec<Option<Token>>;
    type Out = Vec<Option<Token>>;

    fn demand(&self) -> Demand {
        match (&self.plan.kind, self.exhausted()) {
            (_, Some(true)) => Demand::Finished,
            (UnitKind::Source { .. }, _) => Demand::Nothing,
            (UnitKind::Merge { .. }, _) => Demand::Only(self.steps as usize % self.plan.inputs.len()),
            (UnitKind::Gate { size }, _) => Demand::Only(self.is_at_feedback(*size).into()),
            _ if self.expanding.is_some() => Demand::Nothing,
            _ => Demand::All,
        }
    }

    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let (out, id) = self.emit(&input);
        self.issue(id, traffic);
        if self.plan.outputs.is_empty() {
            self.consumed.extend(input.first().copied().flatten());
        }
        self.steps += 1;
        let after_data = if self.plan.after.is_empty() { 0 } else { pick(&self.plan.after, id) };
        let (latency, occupancy) = (pick(&self.plan.latency, id), pick(&self.plan.occupancy, id));
        Step { blocking: self.blocks(id), ..Step::after(latency, out).busy(occupancy).after_data(after_data) }
    }

    fn largest_step(&self, client: usize) -> u32 {
        let requests = self.clients.iter().filter(|&&c| c as usize == client).count();
        let look_ups = if client == self.cached_client() as usize { self.plan.kind.look_ups().len() } else { 0 };
        (requests + look_ups) as u32
    }

    fn is_empty(&self) -> bool {
        self.expanding.is_none() && self.exhausted() != Some(false)
    }
}
