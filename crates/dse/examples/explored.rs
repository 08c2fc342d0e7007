//! Share of the hypervolume that `explore` finds on grids that were swept as a whole, by number of runs.
//!
//! ```text
//! cargo run --release -p basrelief-dse --example explored -- crates/dse/tests/grids/*.csv
//! ```
//!
//! Each line is a grid, its points, and the share [%] with 5, 8, 12, 20, 30 and 50 % of the points. `studies/exploration.py` prints the
//! same for random and Sobol samples and for the sampler TPE of Optuna.

#[path = "../tests/grids/grid.rs"]
mod grid;

use grid::Grid;
use std::error::Error;

const PERCENT: [usize; 6] = [5, 8, 12, 20, 30, 50];

fn main() -> Result<(), Box<dyn Error>> {
    println!("grid,points,5 %,8 %,12 %,20 %,30 %,50 %");
    for path in std::env::args().skip(1) {
        let grid = Grid::read(&path)?;
        let points = grid.places.len();
        let budget = |percent: usize| ((points * percent + 50) / 100).max(4);
        let order = grid.order(budget(PERCENT[PERCENT.len() - 1]));
        let share =
            |percent: usize| grid.share(&order[..budget(percent)]).map_or("-".into(), |share| format!("{:.2}", 100.0 * share));
        println!("{path},{points},{}", PERCENT.map(share).join(","));
    }
    Ok(())
}
