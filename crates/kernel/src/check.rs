//! Conditions on a wiring that the laws and the proof of the timed engine assume. They are checked before the first step.

use crate::bound_stage::BoundStage;
use crate::capacity::{MAX_CLIENTS, MAX_LINKS};
use crate::connections::{Clients, Connections};
use crate::machine::{Machine, Visitor};
use crate::wires::Wires;
use crate::{FifoInfo, Unit};
use std::fmt;

/// An error in a machine's wiring.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WiringError {
    /// Two units fill one FIFO.
    TwoProducers {
        /// The FIFO.
        fifo: String,
        /// The producer shown first.
        first: String,
        /// The other one.
        second: String,
    },
    /// Two units empty one FIFO.
    TwoConsumers {
        /// The FIFO.
        fifo: String,
        /// The consumer shown first.
        first: String,
        /// The other one.
        second: String,
    },
    /// A unit waits for tokens that no unit emits.
    NoProducer {
        /// The FIFO.
        fifo: String,
        /// Its consumer.
        unit: String,
    },
    /// A unit emits tokens that no unit takes.
    NoConsumer {
        /// The FIFO.
        fifo: String,
        /// Its producer.
        unit: String,
    },
    /// A unit has more FIFOs or clients than the kernel supports.
    TooMany {
        /// The unit.
        unit: String,
        /// `inputs`, `outputs` or `memory clients`.
        what: &'static str,
        /// The number of connections.
        count: usize,
        /// The maximum.
        most: usize,
    },
    /// A unit uses a client that was never added.
    NoSuchClient {
        /// The unit.
        unit: String,
        /// The number.
        client: usize,
        /// Clients of the machine.
        count: usize,
    },
    /// Two units use one client, or a unit uses it twice.
    SharedClient {
        /// The client's port.
        port: String,
        /// The unit shown first.
        first: String,
        /// The other one.
        second: String,
    },
    /// A unit needs a client that is not wired.
    MissingClient {
        /// The unit.
        unit: String,
        /// The unit's number of the client.
        client: usize,
        /// Clients wired.
        wired: usize,
    },
    /// The largest step needs more credits than the port has, so the unit could never start (law 3).
    TooFewCredits {
        /// The unit.
        unit: String,
        /// The memory.
        memory: String,
        /// The client's port.
        port: String,
        /// Credits that the largest step needs.
        needed: u32,
        /// Credits that there are.
        outstanding: u64,
    },
}

impl fmt::Display for WiringError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TwoProducers { fifo, first, second } => {
                write!(f, "FIFO `{fifo}` is filled by `{first}` and by `{second}`; give each a FIFO of its own")
            }
            Self::TwoConsumers { fifo, first, second } => {
                write!(f, "FIFO `{fifo}` is emptied by `{first}` and by `{second}`; give each a FIFO of its own")
            }
            Self::NoProducer { fifo, unit } => write!(f, "no unit fills FIFO `{fifo}`, from which `{unit}` pops"),
            Self::NoConsumer { fifo, unit } => write!(f, "no unit pops from FIFO `{fifo}`, which `{unit}` fills"),
            Self::TooMany { unit, what, count, most } => write!(f, "`{unit}` has {count} {what}, expected {most} or fewer"),
            Self::NoSuchClient { unit, client, count } => {
                write!(f, "`{unit}` is wired to memory client number {client}, but the machine's memories have {count}")
            }
            Self::SharedClient { port, first, second } => {
                write!(f, "memory port `{port}` is used by `{first}` and by `{second}`; add a client for each")
            }
            Self::MissingClient { unit, client, wired } => {
                write!(f, "`{unit}` declares a largest step for its memory client {client}, but {wired} are wired")
            }
            Self::TooFewCredits { unit, memory, port, needed, outstanding } => write!(
                f,
                "memory `{memory}` has {outstanding} requests outstanding per port, but a step of `{unit}` needs {needed} on port `{port}`"
            ),
        }
    }
}

impl std::error::Error for WiringError {}

/// Checks that every FIFO has one producer and one consumer, that every memory client belongs to one stage, that the clients a
/// unit uses are wired, and that they have the credits of its largest step.
///
/// Engines run this check before the first step and end the run with a fault if it fails. A machine whose configuration
/// determines credits should check itself at construction, to name the parameter.
///
/// # Errors
/// Returns the first error in the order of the wiring.
pub fn check_wiring(machine: &mut impl Machine) -> Result<(), WiringError> {
    let mut stages = ConnectionSurvey::default();
    machine.wire(&mut ForgetEnds);
    machine.wire(&mut stages);
    let mut loose = LooseEnds(None);
    machine.wire(&mut loose);
    let found = stages.error.take().or(loose.0).or_else(|| stages.clients_error(machine));
    found.map_or(Ok(()), Err)
}

// These visitors, and those of netlist and topology, see the FIFOs of a stage through a pointer. Compiled for every kind of stage, they
// took 0.5 instead of 0.2 MB of the program.

/// Clears the producer and consumer of each FIFO.
struct ForgetEnds;
impl Visitor for ForgetEnds {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (_, Connections { inputs, outputs, .. }) = place.open();
        [inputs as &mut dyn Wires, outputs].into_iter().for_each(forget_ends);
    }
}

fn forget_ends(wires: &mut dyn Wires) {
    (0..wires.count()).for_each(|i| wires.link_mut(i).forget_ends());
}

/// Records the producer and consumer of each FIFO, and the users of each client.
#[derive(Default)]
struct ConnectionSurvey {
    names: Vec<String>,
    /// Per stage: its clients, and the credits that its largest step needs of each possible client.
    clients: Vec<(Vec<usize>, [u32; MAX_CLIENTS])>,
    error: Option<WiringError>,
}

impl Visitor for ConnectionSurvey {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, Connections { inputs, outputs, clients }) = place.open();
        let credits = std::array::from_fn(|client| stage.unit.largest_step(client));
        self.clients.push((clients.ids().to_vec(), credits));
        self.record(stage.name(), inputs, outputs, clients.ids().len());
    }
}

impl ConnectionSurvey {
    /// Records the FIFOs of the next stage, which has this number of clients.
    fn record(&mut self, unit: &str, inputs: &mut dyn Wires, outputs: &mut dyn Wires, clients: usize) {
        let number = self.names.len();
        self.names.push(unit.into());
        let counts = [
            ("inputs", inputs.count(), MAX_LINKS),
            ("outputs", outputs.count(), MAX_LINKS),
            ("memory clients", clients, MAX_CLIENTS),
        ];
        for (what, count, most) in counts.into_iter().filter(|&(_, count, most)| count > most) {
            self.note(WiringError::TooMany { unit: unit.into(), what, count, most });
        }
        for i in 0..inputs.count() {
            let link = inputs.link_mut(i);
            if let Some(first) = link.consumer() {
                let (fifo, first, second) = self.names_at(link, first, number);
                self.note(WiringError::TwoConsumers { fifo, first, second });
            }
            link.set_consumer(number);
        }
        for i in 0..outputs.count() {
            let link = outputs.link_mut(i);
            if let Some(first) = link.producer() {
                let (fifo, first, second) = self.names_at(link, first, number);
                self.note(WiringError::TwoProducers { fifo, first, second });
            }
            link.set_producer(number);
        }
    }

    fn note(&mut self, error: WiringError) {
        self.error.get_or_insert(error);
    }

    fn names_at(&self, link: &FifoInfo, first: usize, second: usize) -> (String, String, String) {
        (link.name().into(), self.names[first].clone(), self.names[second].clone())
    }

    fn clients_error(&self, machine: &mut impl Machine) -> Option<WiringError> {
        let memories = machine.memories();
        let count = memories.clients().len();
        let mut users: Vec<Option<&String>> = vec![None; count];
        for (unit, (ids, needs)) in self.names.iter().zip(&self.clients) {
            for &client in ids {
                let Some(user) = users.get_mut(client) else {
                    return Some(WiringError::NoSuchClient { unit: unit.clone(), client, count });
                };
                if let Some(first) = user.replace(unit) {
                    let port = memories.client_name(client).into();
                    return Some(WiringError::SharedClient { port, first: first.clone(), second: unit.clone() });
                }
            }
            if let Some(client) = (ids.len()..MAX_CLIENTS).find(|&client| needs[client] > 0) {
                return Some(WiringError::MissingClient { unit: unit.clone(), client, wired: ids.len() });
            }
            let needs = ids.iter().zip(needs).map(|(&client, &needed)| (client, needed, memories.outstanding(client)));
            for (client, needed, outstanding) in needs {
                if u64::from(needed) > outstanding {
                    let (memory, port) = (memories.memory_name(client).into(), memories.client_name(client).into());
                    return Some(WiringError::TooFewCredits { unit: unit.clone(), memory, port, needed, outstanding });
                }
            }
        }
        None
    }
}

/// Finds the first FIFO without a producer or consumer.
struct LooseEnds(Option<WiringError>);
impl Visitor for LooseEnds {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, Connections { inputs, outputs, .. }) = place.open();
        self.0 = self.0.take().or_else(|| loose_end(stage.name(), inputs, outputs));
    }
}

/// Finds the first FIFO of a stage without a producer or consumer.
fn loose_end(unit: &str, inputs: &dyn Wires, outputs: &dyn Wires) -> Option<WiringError> {
    let name = |link: &FifoInfo| (link.name().to_owned(), unit.to_owned());
    let unfilled = (0..inputs.count()).map(|i| inputs.link(i)).find(|link| link.producer().is_none());
    if let Some((fifo, unit)) = unfilled.map(name) {
        return Some(WiringError::NoProducer { fifo, unit });
    }
    let unused = (0..outputs.count()).map(|i| outputs.link(i)).find(|link| link.consumer().is_none());
    unused.map(name).map(|(fifo, unit)| WiringError::NoConsumer { fifo, unit })
}
