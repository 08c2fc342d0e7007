//! Utilization of units over time in about a thousand columns.

use basrelief_kernel::{Cycle, Probe, StallCause};

/// Maximum number of columns. A long run has at least half as many.
const COLUMNS: usize = 2048;

/// Number of states of a unit, in the order of the counts of a column.
const STATES: usize = 4;

/// A probe that counts, for each unit and column of the time line, the cycles that the unit was busy, waited for memory, was starved
/// and was blocked. The columns grow with the run.
#[derive(Clone, Debug)]
pub struct UtilizationTimeline {
    units: Vec<Vec<[u64; STATES]>>,
    /// Cycles of a column.
    width: u64,
}

impl Default for UtilizationTimeline {
    fn default() -> Self {
        Self { units: Vec::new(), width: 1 }
    }
}

impl UtilizationTimeline {
    /// Cycles of a column, a power of two.
    pub fn width(&self) -> u64 {
        self.width
    }

    /// Returns the columns of each unit, in the order of the netlist: cycles busy, stalled on memory, starved, blocked. In the rest of the
    /// width of a column the unit is done, or the run is over. Units may have different numbers of columns.
    pub fn units(&self) -> &[Vec<[u64; STATES]>] {
        &self.units
    }

    fn add(&mut self, unit: usize, state: usize, from: Cycle, to: Cycle) {
        while to.0 > self.width.saturating_mul(COLUMNS as u64) {
            self.halve();
        }
        if self.units.len() <= unit {
            self.units.resize(unit + 1, Vec::new());
        }
        let columns = &mut self.units[unit];
        let mut at = from.0;
        while at < to.0 {
            let column = (at / self.width) as usize;
            let end = to.0.min((column as u64 + 1).saturating_mul(self.width));
            columns.resize(columns.len().max(column + 1), [0; STATES]);
            columns[column][state] += end - at;
            at = end;
        }
    }

    /// Two columns become one.
    fn halve(&mut self) {
        for columns in &mut self.units {
            let pair = |pair: &[[u64; STATES]]| std::array::from_fn(|state| pair.iter().map(|column| column[state]).sum());
            *columns = columns.chunks(2).map(pair).collect();
        }
        self.width = self.width.saturating_mul(2);
    }
}

impl Probe for UtilizationTimeline {
    fn reads_levels(&self) -> bool {
        false
    }

    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle) {
        self.add(stage, 0, from, to);
    }

    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle) {
        let state = match cause {
            StallCause::Memory(_) => 1,
            StallCause::Starved(_) => 2,
            StallCause::Blocked(_) => 3,
        };
        self.add(stage, state, from, to);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cycle_is_in_one_column_however_long_the_run() {
        let mut strips = UtilizationTimeline::default();
        let (mut at, mut sums) = (0, [0; STATES]);
        for n in 0..4000_u64 {
            let (state, end) = ((n % 4) as usize, at + 1 + n * 7 % 13);
            strips.add(1, state, Cycle(at), Cycle(end));
            sums[state] += end - at;
            at = end;
        }
        let columns = &strips.units()[1];
        assert!(strips.units()[0].is_empty() && (COLUMNS / 2..=COLUMNS).contains(&columns.len()), "{}", columns.len());
        assert_eq!(std::array::from_fn(|state| columns.iter().map(|column| column[state]).sum::<u64>()), sums);
        let (last, full) = columns.split_last().unwrap();
        assert!(full.iter().all(|column| column.iter().sum::<u64>() == strips.width()));
        assert_eq!(last.iter().sum::<u64>(), at - full.len() as u64 * strips.width());
    }

    #[test]
    fn cycles_beyond_all_bounds_are_counted_too() {
        let mut strips = UtilizationTimeline::default();
        strips.on_busy(0, Cycle(1 << 40), Cycle((1 << 40) + 5));
        assert_eq!(strips.units()[0].iter().map(|column| column[0]).sum::<u64>(), 5);
    }
}
