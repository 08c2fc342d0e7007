//! The drawings of the machines, as they are.

use super::*;
use std::collections::BTreeSet;

const DIAGRAMS: [&str; 4] = [
    include_str!("../../../../machines/src/bump/diagram.txt"),
    include_str!("../../../../machines/src/shade/diagram.txt"),
    include_str!("../../../../machines/src/texel/diagram.txt"),
    include_str!("../../../../machines/src/defer/diagram.txt"),
];

/// Cells of a text.
fn cells(placed: &PlacedText) -> impl Iterator<Item = (usize, usize)> {
    (placed.column..placed.column + placed.width).map(|column| (placed.row, column))
}

#[test]
fn every_sign_of_a_drawing_is_drawn_once() {
    for text in DIAGRAMS {
        let sheet = BlockDiagram::read(text);
        let mut drawn = BTreeSet::new();
        let texts = [&sheet.units, &sheet.memories, &sheet.clients, &sheet.fifos, &sheet.notes].into_iter().flatten();
        let wires = sheet.wires.iter().map(|wire| (wire.row, wire.column));
        for cell in texts.flat_map(cells).chain(wires) {
            assert!(drawn.insert(cell), "{cell:?} is drawn twice");
        }
        for (row, line) in text.lines().enumerate() {
            for (column, c) in line.chars().enumerate().filter(|(_, c)| *c != ' ') {
                assert!(drawn.contains(&(row, column)), "`{c}` in row {row}, column {column} is not drawn");
            }
        }
    }
}

#[test]
fn wires_and_texts_are_distinguished() {
    for text in DIAGRAMS {
        let sheet = BlockDiagram::read(text);
        let is_name = |c: char| c == '_' || c.is_ascii_lowercase();
        assert!(sheet.fifos.iter().all(|name| name.text.chars().all(is_name)), "{:?}", sheet.fifos);
        assert!(!sheet.notes.iter().any(|note| note.text.contains(['|', '+'])), "{:?}", sheet.notes);
        let names: BTreeSet<&str> = sheet.fifos.iter().map(PlacedText::name).collect();
        // Every FIFO has an arrow of its own at the unit that takes from it.
        let heads = sheet.wires.iter().filter(|wire| wire.arrow.is_some()).count();
        assert_eq!(heads, sheet.fifos.len(), "{names:?}");
        // A line goes on in the next cell, or ends at a box or beside a name.
        assert!(sheet.wires.iter().all(|wire| wire.sides.len() >= 2 || wire.arrow.is_some()));
    }
}

#[test]
fn unit_drawn_twice_is_filled_once() {
    let report = crate::samples::balanced();
    let page = draw(" [geometry] --polygons--> [rasterizer]\n [geometry] --polygons--> [x]\n", &report).into_text();
    assert_eq!(page.matches("geometry: busy 3.0\u{a0}%").count(), 1, "{page}");
    assert_eq!((page.matches("class=\"gauge\"").count(), page.matches("class=\"unit absent\"").count()), (1, 1));
}

#[test]
fn wires_reach_their_boxes() {
    let sheet = BlockDiagram::read(" [a] --x--> [b]");
    let ends: Vec<f64> = sheet.wires.iter().map(|wire| wire_end(&sheet, wire, CellSide::Right).0).collect();
    let box_b = column_x(sheet.units[1].column);
    assert_eq!(ends.last(), Some(&box_b));
    let first = sheet.wires.first().unwrap();
    assert_eq!(wire_end(&sheet, first, CellSide::Left).0, column_x(sheet.units[0].column + sheet.units[0].width));
}
