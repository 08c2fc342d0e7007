//! The search of `explore` against `tests/oracles/exploration.py`, on grids that were swept as a whole.
//!
//! `orders.csv` has the choices of the oracle for a fifth of each grid:
//! `tests/oracles/exploration.py orders 0.2 crates/dse/tests/grids/{bump-cache,defer-mix,fifo-depths,quantization,texel-fifo}.csv`.

#[path = "grids/grid.rs"]
mod grid;

use grid::Grid;

#[test]
fn search_makes_the_choices_of_the_oracle() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests");
    let mut orders = csv::Reader::from_path(format!("{folder}/orders.csv")).unwrap();
    let mut grids = 0;
    for row in orders.records() {
        let row = row.unwrap();
        let expected: Vec<usize> = row[1].split(' ').map(|point| point.parse().unwrap()).collect();
        let grid = Grid::read(&format!("{folder}/grids/{}.csv", &row[0])).unwrap();
        assert_eq!(grid.order(expected.len()), expected, "{}", &row[0]);
        grids += 1;
    }
    assert_eq!(grids, 5);
}
