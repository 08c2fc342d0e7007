//! Signals of the wave file, and their values.

use crate::layout::TimelineLayout;
use crate::levels::{CounterList, CounterValue};
use fst_writer::{
    FstBodyWriter, FstHeaderWriter, FstScopeType, FstSignalId, FstSignalType, FstVarDirection, FstVarType, FstWriteError,
};
use std::io::{Seek, Write};

/// Number of the value that is the frame.
pub(crate) const FRAME: usize = 0;

/// States of a unit; 0 stands for no state. A stall state contains the number of its FIFO or client.
pub(crate) const BUSY: u64 = 1;
pub(crate) const DONE: u64 = 2;
pub(crate) const FIRST_WAIT: u64 = 3;

/// Numbers of the values that change: the frame, then those of each kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignalNumbers {
    pub(crate) first_stage: usize,
    pub(crate) first_level: usize,
    pub(crate) first_bus: usize,
    pub(crate) first_bank: usize,
    pub(crate) count: usize,
}

impl SignalNumbers {
    pub(crate) fn new(board: &TimelineLayout) -> Self {
        let levels = CounterList::new(board);
        let first_stage = FRAME + 1;
        let first_level = first_stage + board.diagram.stages.len();
        let first_bus = first_level + levels.all.len();
        let first_bank = first_bus + levels.channels.len();
        Self { first_stage, first_level, first_bus, first_bank, count: first_bank + levels.banks }
    }

    /// Returns the wires whose values end at a cycle. Levels last until the next value.
    pub(crate) fn that_end(self) -> impl Iterator<Item = usize> {
        (0..self.first_level).chain(self.first_bus..self.count)
    }
}

type FstHeader<W> = FstHeaderWriter<W>;
type FstBody<W> = FstBodyWriter<W>;
type FstResult<T = ()> = Result<T, FstWriteError>;

/// A number as a vector of bits.
#[derive(Clone, Copy, Debug)]
struct NumberSignal {
    id: FstSignalId,
    bits: u32,
}

impl NumberSignal {
    fn declare<W: Write + Seek>(header: &mut FstHeader<W>, name: &str, most: u64) -> FstResult<Self> {
        let bits = u64::BITS - most.max(1).leading_zeros();
        let kind = if bits == 1 { FstVarType::Wire } else { FstVarType::Reg };
        let id = header.var(name, FstSignalType::bit_vec(bits), kind, FstVarDirection::Implicit, None)?;
        Ok(Self { id, bits })
    }

    fn set<W: Write + Seek>(self, body: &mut FstBody<W>, value: u64) -> FstResult {
        let digits: [u8; 64] = std::array::from_fn(|bit| b'0' + (value >> (63 - bit) & 1) as u8);
        body.signal_change(self.id, &digits[64 - self.bits as usize..])
    }
}

/// The wires of a unit, by state.
const STATES: [&str; 5] = ["busy", "starved", "blocked", "memory", "done"];

/// Returns the wire of a unit that is 1 in a state.
fn wire_of(state: u64) -> Option<usize> {
    match state {
        0 => None,
        BUSY => Some(0),
        DONE => Some(4),
        wait => Some(1 + (wait - FIRST_WAIT) as usize % 3),
    }
}

/// The signals that show a value.
#[derive(Clone, Copy, Debug)]
enum ValueWires {
    /// It is not shown.
    None,
    /// The number itself.
    Number(NumberSignal),
    /// A number with a fraction.
    Real(FstSignalId),
    /// A wire per state of a unit.
    State([NumberSignal; 5]),
    /// Signals of a bus: busy, client, and write.
    Bus([NumberSignal; 3]),
    /// Open flag and row of a bank.
    Bank([NumberSignal; 2]),
    /// Wires of a FIFO.
    Fifo(FifoWires),
}

/// Signals of a FIFO, and the values that they derive from.
#[derive(Clone, Copy, Debug)]
struct FifoWires {
    fill: NumberSignal,
    valid: NumberSignal,
    ready: NumberSignal,
    depth: u64,
    held: u64,
    /// The unit that takes from it waits for it.
    starves: bool,
    changed: bool,
}

/// All signals, by the numbers of the values that they show.
pub(crate) struct SignalTable {
    wires: Vec<ValueWires>,
    numbers: SignalNumbers,
    /// The state of each stage.
    states: Vec<u64>,
    /// Numbers of each stage's input FIFOs.
    inputs: Vec<Vec<usize>>,
    /// FIFOs that have changed in this cycle.
    changed: Vec<usize>,
}

impl SignalTable {
    pub(crate) fn declare<W: Write + Seek>(
        header: &mut FstHeader<W>,
        board: &TimelineLayout,
        numbers: &SignalNumbers,
    ) -> FstResult<Self> {
        let (levels, mut wires) = (CounterList::new(board), vec![ValueWires::None; numbers.count]);
        within(header, &board.machine, |header| {
            wires[FRAME] = ValueWires::Number(NumberSignal::declare(header, "frame", u32::MAX.into())?);
            for stage in (0..board.diagram.stages.len()).filter(|&stage| board.shows(stage)) {
                wires[numbers.first_stage + stage] = declare_states(header, &board.name(stage))?;
            }
            let of_channels = levels.queue(0)..levels.credits(0);
            for (number, level) in
                levels.all.iter().enumerate().filter(|(number, level)| level.is_shown && !of_channels.contains(number))
            {
                let wires = &mut wires[numbers.first_level + number];
                within(header, &level.of, |header| {
                    *wires = if level.what == "fill" { declare_fifo(header, level.most)? } else { declare_level(header, level)? };
                    Ok(())
                })?;
            }
            declare_channels(header, board, &levels, numbers, &mut wires)
        })?;
        let diagram = &board.diagram;
        let number = |name: &String| diagram.fifos.iter().position(|fifo| fifo.name == *name).unwrap_or(usize::MAX);
        let inputs = diagram.stages.iter().map(|stage| stage.inputs.iter().map(number).collect()).collect();
        Ok(Self { wires, numbers: *numbers, states: vec![0; diagram.stages.len()], inputs, changed: vec![] })
    }

    /// A value changes.
    pub(crate) fn change<W: Write + Seek>(&mut self, body: &mut FstBody<W>, number: usize, new: u64) -> FstResult {
        match self.wires[number] {
            ValueWires::None => Ok(()),
            ValueWires::Number(wire) => wire.set(body, new),
            ValueWires::Real(id) => body.signal_change(id, &f64::from_bits(new).to_le_bytes()),
            ValueWires::State(wires) => self.change_state(body, number - self.numbers.first_stage, &wires, new),
            ValueWires::Bus([bus, client, write]) => {
                let transfer = new.saturating_sub(1);
                bus.set(body, u64::from(new > 0))?;
                client.set(body, transfer / 2)?;
                write.set(body, transfer % 2)
            }
            ValueWires::Bank([open, row]) => {
                open.set(body, u64::from(new > 0))?;
                row.set(body, new.saturating_sub(1))
            }
            ValueWires::Fifo(_) => {
                self.change_fifo(number - self.numbers.first_level, |wires| wires.held = new);
                Ok(())
            }
        }
    }

    fn change_state<W: Write + Seek>(
        &mut self,
        body: &mut FstBody<W>,
        stage: usize,
        wires: &[NumberSignal],
        new: u64,
    ) -> FstResult {
        let one = wire_of(new);
        for (number, wire) in wires.iter().enumerate() {
            wire.set(body, u64::from(one == Some(number)))?;
        }
        let old = std::mem::replace(&mut self.states[stage], new);
        for (state, starves) in [(old, false), (new, true)] {
            if wire_of(state) == Some(1) {
                let input = self.inputs[stage][(state - FIRST_WAIT) as usize / 3];
                self.change_fifo(input, |wires| wires.starves = starves);
            }
        }
        Ok(())
    }

    fn change_fifo(&mut self, fifo: usize, change: impl FnOnce(&mut FifoWires)) {
        let number = self.numbers.first_level + fifo;
        let Some(ValueWires::Fifo(wires)) = self.wires.get_mut(number) else { return };
        change(wires);
        if !std::mem::replace(&mut wires.changed, true) {
            self.changed.push(number);
        }
    }

    /// Writes the signals that derive from all changes of a cycle.
    pub(crate) fn settle<W: Write + Seek>(&mut self, body: &mut FstBody<W>) -> FstResult {
        for number in self.changed.drain(..) {
            let ValueWires::Fifo(wires) = &mut self.wires[number] else { continue };
            wires.changed = false;
            wires.fill.set(body, wires.held)?;
            wires.valid.set(body, u64::from(wires.held > 0 && !wires.starves))?;
            wires.ready.set(body, u64::from(wires.held < wires.depth))?;
        }
        Ok(())
    }
}

/// Declares signals in a scope. Names have no spaces, because viewers end a name at a space.
fn within<W: Write + Seek>(
    header: &mut FstHeader<W>,
    name: &str,
    declare: impl FnOnce(&mut FstHeader<W>) -> FstResult,
) -> FstResult {
    header.scope(name.replace(' ', "_"), "", FstScopeType::Module)?;
    declare(header)?;
    header.up_scope()
}

fn declare_states<W: Write + Seek>(header: &mut FstHeader<W>, name: &str) -> FstResult<ValueWires> {
    let mut wires = ValueWires::None;
    within(header, name, |header| {
        wires = ValueWires::State(all(header, STATES.map(|state| (state, 1)))?);
        Ok(())
    })?;
    Ok(wires)
}

fn declare_fifo<W: Write + Seek>(header: &mut FstHeader<W>, depth: u64) -> FstResult<ValueWires> {
    let [fill, valid, ready] = all(header, [("fill", depth), ("valid", 1), ("ready", 1)])?;
    Ok(ValueWires::Fifo(FifoWires { fill, valid, ready, depth, held: 0, starves: false, changed: false }))
}

fn declare_level<W: Write + Seek>(header: &mut FstHeader<W>, level: &crate::levels::CounterInfo) -> FstResult<ValueWires> {
    let name = level.what.replace(' ', "_");
    Ok(match level.start {
        CounterValue::Count(_) => ValueWires::Number(NumberSignal::declare(header, &name, level.most)?),
        CounterValue::Real(_) => {
            ValueWires::Real(header.var(name, FstSignalType::real(), FstVarType::Real, FstVarDirection::Implicit, None)?)
        }
    })
}

/// Declares a scope per channel, and one in it per bank.
fn declare_channels<W: Write + Seek>(
    header: &mut FstHeader<W>,
    board: &TimelineLayout,
    levels: &CounterList,
    numbers: &SignalNumbers,
    wires: &mut [ValueWires],
) -> FstResult {
    let clients = board.diagram.clients.len() as u64;
    for (number, channel) in levels.channels.iter().enumerate().filter(|(_, channel)| channel.is_shown) {
        within(header, &channel.name, |header| {
            for level in levels.queue(number)..levels.queue(number) + 3 {
                wires[numbers.first_level + level] = declare_level(header, &levels.all[level])?;
            }
            wires[numbers.first_bus + number] = ValueWires::Bus(all(header, [("bus", 1), ("client", clients), ("write", 1)])?);
            for bank in 0..board.diagram.memories[channel.memory].banks {
                let wires = &mut wires[numbers.first_bank + channel.first_bank + bank];
                within(header, &format!("bank {bank}"), |header| {
                    *wires = ValueWires::Bank(all(header, [("open", 1), ("row", u32::MAX.into())])?);
                    Ok(())
                })?;
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// Declares numbers of these names, each with the most that it can be.
fn all<W: Write + Seek, const N: usize>(header: &mut FstHeader<W>, names: [(&str, u64); N]) -> FstResult<[NumberSignal; N]> {
    let mut declared = [None; N];
    for (declared, (name, most)) in declared.iter_mut().zip(names) {
        *declared = Some(NumberSignal::declare(header, name, most)?);
    }
    // Each is there by now.
    Ok(declared.map(|number| number.expect("declared above")))
}
