//! Signals of the wave file, and their values.

use crate::layout::TimelineLayout;
use crate::levels::{CounterInfo, CounterList, CounterValue};
use basrelief_kernel::ClientTopology;
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
#[derive(Clone, Debug)]
enum ValueWires {
    /// It is not shown.
    None,
    /// The number itself.
    Number(NumberSignal),
    /// A number with a fraction.
    Real(FstSignalId),
    /// A wire per state of a unit.
    State([NumberSignal; 5]),
    /// Signals of a bus: busy and write, and a wire per client of the memory, with its number.
    Bus([NumberSignal; 2], Vec<(u64, NumberSignal)>),
    /// Open flag and row of a bank.
    Bank([NumberSignal; 2]),
    /// Occupied slots of a FIFO, the flag of a free slot, and the depth.
    Fill([NumberSignal; 2], u64),
}

/// All signals, by the numbers of the values that they show.
pub(crate) struct SignalTable {
    wires: Vec<ValueWires>,
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
            let of_level = &mut wires[numbers.first_level..];
            for fifo in (0..board.diagram.fifos.len()).filter(|&fifo| levels.all[fifo].is_shown) {
                [of_level[fifo], of_level[levels.valid(fifo)]] = declare_fifo(header, &levels.all[fifo])?;
            }
            for number in (levels.credits(0)..levels.valid(0)).filter(|&number| levels.all[number].is_shown) {
                let level = &levels.all[number];
                within(header, &level.of, |header| {
                    of_level[number] = declare_level(header, level)?;
                    Ok(())
                })?;
            }
            declare_channels(header, board, &levels, numbers, &mut wires)
        })?;
        Ok(Self { wires })
    }

    /// A value changes.
    pub(crate) fn change<W: Write + Seek>(&self, body: &mut FstBody<W>, number: usize, new: u64) -> FstResult {
        match &self.wires[number] {
            ValueWires::None => Ok(()),
            ValueWires::Number(wire) => wire.set(body, new),
            ValueWires::Real(id) => body.signal_change(*id, &f64::from_bits(new).to_le_bytes()),
            ValueWires::State(wires) => {
                let one = wire_of(new);
                wires.iter().enumerate().try_for_each(|(wire, signal)| signal.set(body, u64::from(one == Some(wire))))
            }
            ValueWires::Bus([bus, write], clients) => {
                let transfer = new.checked_sub(1);
                bus.set(body, u64::from(transfer.is_some()))?;
                write.set(body, transfer.map_or(0, |transfer| transfer % 2))?;
                let moves = |client: u64| transfer.is_some_and(|transfer| transfer / 2 == client);
                clients.iter().try_for_each(|(client, wire)| wire.set(body, u64::from(moves(*client))))
            }
            ValueWires::Bank([open, row]) => {
                open.set(body, u64::from(new > 0))?;
                row.set(body, new.saturating_sub(1))
            }
            ValueWires::Fill([fill, ready], depth) => {
                fill.set(body, new)?;
                ready.set(body, u64::from(new < *depth))
            }
        }
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

/// Declares the signals of a FIFO. Returns those of its fill level and of its visible tokens.
fn declare_fifo<W: Write + Seek>(header: &mut FstHeader<W>, level: &CounterInfo) -> FstResult<[ValueWires; 2]> {
    let mut wires = [ValueWires::None, ValueWires::None];
    within(header, &level.of, |header| {
        let [fill, valid, ready] = all(header, [("fill", level.most), ("valid", 1), ("ready", 1)])?;
        wires = [ValueWires::Fill([fill, ready], level.most), ValueWires::Number(valid)];
        Ok(())
    })?;
    Ok(wires)
}

fn declare_level<W: Write + Seek>(header: &mut FstHeader<W>, level: &CounterInfo) -> FstResult<ValueWires> {
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
    for (number, channel) in levels.channels.iter().enumerate().filter(|(_, channel)| channel.is_shown) {
        within(header, &channel.name, |header| {
            for level in levels.queue(number)..levels.queue(number) + 3 {
                wires[numbers.first_level + level] = declare_level(header, &levels.all[level])?;
            }
            wires[numbers.first_bus + number] = declare_bus(header, board, channel.memory)?;
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

/// Declares the signals of a bus.
fn declare_bus<W: Write + Seek>(header: &mut FstHeader<W>, board: &TimelineLayout, memory: usize) -> FstResult<ValueWires> {
    let of_bus = all(header, [("bus", 1), ("write", 1)])?;
    let clients = (0..).zip(&board.diagram.clients).filter(|(_, client)| client.memory == memory);
    let declare = |(number, client): (u64, &ClientTopology)| {
        let name = format!("client_{}", client.name.replace(' ', "_"));
        Ok((number, NumberSignal::declare(header, &name, 1)?))
    };
    Ok(ValueWires::Bus(of_bus, clients.map(declare).collect::<FstResult<_>>()?))
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
