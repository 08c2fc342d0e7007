//! Parser of block diagrams.

use basrelief_machines::CellSide::{self, Down, Left, Up};
use basrelief_machines::{BlockDiagram, PlacedText, drawn_units};

fn texts(list: &[PlacedText]) -> Vec<&str> {
    list.iter().map(|placed| placed.text.trim()).collect()
}

#[test]
fn texts_have_kinds_and_places() {
    let diagram = BlockDiagram::read(" [a (1)] --one--> [  b  ] ==x, y== {m (2)}   a-b side\n     | two\n     v");
    assert_eq!(texts(&diagram.units), ["a (1)", "b"]);
    let b = &diagram.units[1];
    assert_eq!((b.name(), b.column, b.width), ("b", 18, 7));
    assert_eq!((texts(&diagram.memories), texts(&diagram.clients)), (vec!["m (2)"], vec!["x, y"]));
    assert_eq!((texts(&diagram.fifos), texts(&diagram.notes)), (vec!["one", "two"], vec!["a-b", "side"]));
    assert_eq!((diagram.columns, diagram.rows), (53, 3));
}

#[test]
fn wires_turn_cross_and_end_in_arrowheads() {
    let diagram = BlockDiagram::read("--+  |\n  | -|-\n  v  |");
    let at = |row, column| diagram.wires.iter().find(|w| (w.row, w.column) == (row, column)).unwrap();
    assert_eq!(at(0, 2).sides, [Left, Down]);
    assert_eq!(at(1, 5).sides, CellSide::ALL);
    assert_eq!((at(2, 2).sides.as_slice(), at(2, 2).arrow), ([Up].as_slice(), Some(Down)));
}

#[test]
fn broken_marks_are_notes() {
    let diagram = BlockDiagram::read("[open = {x v + ");
    assert_eq!(texts(&diagram.notes), ["open", "x", "v", "+"]);
    assert_eq!(BlockDiagram::read(""), BlockDiagram::default());
}

#[test]
fn units_have_names_and_numerals() {
    assert_eq!(drawn_units(" [a (1)] --x--> [ b  ]  (2) [ c (3b) ]"), [("a", "1"), ("b", ""), ("c", "3b")]);
}
