//! A machine around one unit: a source per input, a sink per output, and a memory with the unit's clients.

use super::client_kind::ClientKind;
use super::ends::{Back, Emitted, Front, Popped};
use super::environment::TestEnvironment;
use super::subject::{AfterStep, ObservedUnit};
use basrelief_kernel::{Machine, MemorySystem, Stage, Unit, Visitor};

/// Sources, the unit under test, sinks, and one memory. The memory has a port, or a port and a cache, per client of the unit.
///
/// ```text
///   source_0 --input_0--> +------+ --output_0--> sink_0
///   source_1 --input_1--> | unit | --output_1--> sink_1
///                         +------+
///              client_0, client_1 .. | memory
/// ```
pub struct Bench<U: Unit<In: Popped, Out: Emitted>> {
    front: <U::In as Popped>::Front,
    unit: Stage<ObservedUnit<U>>,
    back: <U::Out as Emitted>::Back,
    memories: MemorySystem,
    clients: Vec<usize>,
}

impl<U: Unit<In: Popped, Out: Emitted>> Bench<U> {
    /// Makes a bench that feeds `tokens` to `unit`. The sinks compare their tokens with `expected`, if given.
    pub fn new(
        unit: U,
        tokens: <U::In as Popped>::Tokens,
        expected: Option<<U::Out as Emitted>::Tokens>,
        clients: &[ClientKind],
        setting: &TestEnvironment,
    ) -> Self {
        Self::with_hook(unit, None, tokens, expected, clients, setting)
    }

    /// Makes a bench with a hook that runs after each step of the unit.
    pub(super) fn with_hook(
        unit: U,
        after_step: Option<AfterStep<U>>,
        tokens: <U::In as Popped>::Tokens,
        expected: Option<<U::Out as Emitted>::Tokens>,
        clients: &[ClientKind],
        setting: &TestEnvironment,
    ) -> Self {
        let mut memories = MemorySystem::default();
        let memory = memories.add_memory("memory", &setting.memory());
        let mut add = |(n, client): (usize, &ClientKind)| {
            let credits = unit.largest_step(n).max(1) + if setting.slow_memory { 0 } else { 8 };
            let name = format!("client_{n}");
            match client {
                ClientKind::Port => memories.add_client(&name, memory, credits),
                ClientKind::Cache { line_bytes } => {
                    let cache = setting.cache(*line_bytes);
                    memories.add_cached_client(&name, memory, credits, &format!("cache_{n}"), &cache)
                }
            }
        };
        let clients: Vec<usize> = clients.iter().enumerate().map(&mut add).collect();
        if setting.slow_memory {
            for &client in &clients {
                memories.set_issue_rate(client, 1);
                memories.spread_look_ups(client);
            }
        }
        let front = U::In::front(tokens, setting);
        let back = U::Out::back(expected, setting);
        let unit = Stage::new("unit", ObservedUnit { unit, after_step });
        Self { front, unit, back, memories, clients }
    }

    /// Returns the unit.
    pub fn unit(&self) -> &U {
        &self.unit.unit.unit
    }

    /// Returns the tokens that the sinks collected.
    pub fn tokens(&self) -> <U::Out as Emitted>::Tokens {
        self.back.tokens()
    }
}

impl<U: Unit<In: Popped, Out: Emitted>> Machine for Bench<U> {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        self.front.wire(v);
        v.stage(self.unit.between(self.front.ends(), self.back.ends()).using(&mut self.memories, &self.clients));
        self.back.wire(v);
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
