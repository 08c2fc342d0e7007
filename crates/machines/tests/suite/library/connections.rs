//! Follows the wires of a block diagram, so that a test can compare the diagram with the machine edge by edge.

use basrelief_machines::CellSide::{self, Left, Right};
use basrelief_machines::{BlockDiagram, PlacedText, WireCell, drawn_units};
use std::collections::BTreeSet;

/// Units and edges of a block diagram.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct DiagramConnections {
    /// Units and their numerals.
    pub units: BTreeSet<(String, String)>,
    /// Producer, FIFO, consumer.
    pub fifos: BTreeSet<[String; 3]>,
    /// Unit, client, memory. A periodic client has no unit.
    pub clients: BTreeSet<[String; 3]>,
}

impl DiagramConnections {
    /// Reads a diagram.
    ///
    /// # Errors
    /// A wire or a list of clients that ends at no unit or memory, with its row and column, from 0.
    pub fn read(text: &str) -> Result<Self, String> {
        let diagram = BlockDiagram::read(text);
        let units = drawn_units(text).into_iter().map(|(name, numeral)| (name.to_owned(), numeral.to_owned()));
        let mut connections = Self { units: units.collect(), ..Self::default() };
        for clients in &diagram.clients {
            connections
                .add_clients(&diagram, clients)
                .ok_or_else(|| format!("row {}: expected `[unit] =={}== {{memory}}`", clients.row, clients.text))?;
        }
        for head in &diagram.wires {
            let Some(arrow) = head.arrow else { continue };
            let consumer = wire_end(&diagram, (head.row, head.column), arrow);
            let consumer = consumer.ok_or_else(|| format!("the arrowhead at {:?} points at no unit", (head.row, head.column)))?;
            let (fifo, producer) = follow(&diagram, head, arrow.opposite())?;
            connections.fifos.insert([producer, fifo, consumer.name()].map(str::to_owned));
        }
        Ok(connections)
    }

    fn add_clients(&mut self, diagram: &BlockDiagram, clients: &PlacedText) -> Option<()> {
        let PlacedText { row, column, width, .. } = *clients;
        let behind = diagram.memories.iter().find(|memory| (memory.row, memory.column + memory.width + 1) == (row, column));
        if let Some(memory) = behind {
            self.clients.extend(clients.text.split(", ").map(|client| ["", client, memory.name()].map(str::to_owned)));
            return Some(());
        }
        let unit = diagram.units.iter().find(|unit| (unit.row, unit.column + unit.width + 1) == (row, column))?.name();
        let memory = diagram.memories.iter().find(|memory| (memory.row, memory.column) == (row, column + width + 1))?.name();
        self.clients.extend(clients.text.split(", ").map(|client| [unit, client, memory].map(str::to_owned)));
        Some(())
    }
}

/// Row and column.
type DiagramCell = (usize, usize);

fn next((row, column): DiagramCell, side: CellSide) -> DiagramCell {
    let (down, right) = side.step();
    (row.wrapping_add_signed(down), column.wrapping_add_signed(right))
}

fn covering(list: &[PlacedText], (row, column): DiagramCell) -> Option<&PlacedText> {
    list.iter().find(|placed| placed.row == row && (placed.column..placed.column + placed.width).contains(&column))
}

fn is_horizontal(side: CellSide) -> bool {
    matches!(side, Left | Right)
}

fn wire(diagram: &BlockDiagram, (row, column): DiagramCell) -> Option<&WireCell> {
    diagram.wires.iter().find(|wire| (wire.row, wire.column) == (row, column))
}

/// The unit at which a wire ends that leaves `cell` on this side. A blank separates a horizontal wire from its unit.
fn wire_end(diagram: &BlockDiagram, cell: DiagramCell, side: CellSide) -> Option<&PlacedText> {
    let near = next(cell, side);
    let is_blank = covering(&diagram.fifos, near).is_none() && wire(diagram, near).is_none();
    let beyond = if is_horizontal(side) && is_blank { next(near, side) } else { near };
    covering(&diagram.units, beyond)
}

/// Follows a wire from its arrowhead against its direction, to its name and its producer.
fn follow<'a>(diagram: &'a BlockDiagram, head: &WireCell, mut side: CellSide) -> Result<(&'a str, &'a str), String> {
    let (mut cell, mut fifo) = ((head.row, head.column), "");
    loop {
        cell = next(cell, side);
        let beside = (!is_horizontal(side)).then_some((cell.0, cell.1 + 2));
        if let Some(wire) = wire(diagram, cell) {
            side = continuation(wire, side).ok_or_else(|| format!("the wire turns at {cell:?} in no direction, or in two"))?;
            fifo = beside.and_then(|beside| diagram.fifos.iter().find(|f| (f.row, f.column) == beside)).map_or(fifo, |f| &f.text);
        } else if let Some(name) = covering(&diagram.fifos, cell).filter(|_| is_horizontal(side)) {
            fifo = &name.text;
        } else {
            return Err(format!("the wire to {:?} breaks at {cell:?}", (head.row, head.column)));
        }
        if let Some(producer) = wire_end(diagram, cell, side) {
            return Ok((fifo, producer.name()));
        }
    }
}

/// The side at which a wire leaves this cell that was entered in this direction.
fn continuation(wire: &WireCell, direction: CellSide) -> Option<CellSide> {
    let ahead: Vec<CellSide> = wire.sides.iter().copied().filter(|side| *side != direction.opposite()).collect();
    match (wire.sides.contains(&direction.opposite()), ahead.as_slice()) {
        (true, [only]) => Some(*only),
        (true, [_, _, _]) => Some(direction),
        _ => None,
    }
}

fn edges(text: &str) -> Vec<String> {
    DiagramConnections::read(text).unwrap().fifos.into_iter().map(|edge| edge.join(" ")).collect()
}

#[test]
fn wires_turn_cross_and_have_names() {
    let text = "
 [a (1)] --one--+      [ b ] <--five--+
     |          v        | two        |
     |         [c] ------|--three--+  |
     | four              v         |  |
     +----------------> [d] <------+  |
                         |  aside     |
                         +------------+";
    assert_eq!(edges(text), ["a four d", "a one c", "b two d", "c three d", "d five b"]);
}

#[test]
fn clients_connect_units_and_memories() {
    let connections = DiagramConnections::read(" [a (1)] ==x, y== {m (2)} ==v==   [b] ==z== {m (2)}").unwrap();
    let clients: Vec<String> = connections.clients.iter().map(|c| c.join(" ")).collect();
    assert_eq!(clients, [" v m", "a x m", "a y m", "b z m"]);
    let units = [("a", "1"), ("b", "")].map(|(name, numeral)| (name.to_owned(), numeral.to_owned()));
    assert_eq!(connections.units, units.into());
}

#[test]
fn broken_wires_and_clients_are_rejected() {
    assert!(DiagramConnections::read(" [a] --x--> b").is_err_and(|e| e.contains("points at no unit")));
    assert!(DiagramConnections::read(" [a]  -x--> [b]").is_err_and(|e| e.contains("breaks")));
    assert!(
        DiagramConnections::read(" [a] --x--+\n\n       [b] <--+").is_err_and(|e| e.contains("breaks at") || e.contains("turns"))
    );
    assert!(DiagramConnections::read(" [a] ==x== m").is_err_and(|e| e.contains("expected")));
}
