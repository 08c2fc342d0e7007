//! Time lines of a run: which files, of which units, from which cycle to which.

use crate::args::SimulationArgs;
use crate::error::{Done, Failure};
use crate::outputs::PartialFile;
use basrelief_input::{Budget, OverBudget};
use basrelief_kernel::Probe;
use basrelief_parameters::nearest;
use basrelief_report::{Board, Chart, Timeline, Watcher, Waves};
use basrelief_session::{self as session, Run, RunInput, RunOptions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// The files that show when each unit did what.
pub struct TimelineFiles {
    board: Board,
    timeline: Option<(PartialFile, PathBuf)>,
    waves: Option<(PartialFile, PathBuf)>,
    budget: Budget,
}

impl TimelineFiles {
    /// Begins those that are asked for, if any is.
    pub fn open(simulation: &SimulationArgs, source: &RunInput, settings: &RunOptions) -> Done<Option<Self>> {
        let SimulationArgs { timeline, waves, .. } = simulation;
        if timeline.is_none() && waves.is_none() {
            return Ok(None);
        }
        let board = session::board(source, settings).map_err(Failure::bad)?;
        let board = cut(board, simulation)?;
        let [timeline, waves] = [timeline, waves].map(|path| path.clone().map(create).transpose());
        Ok(Some(Self { board, timeline: timeline?, waves: waves?, budget: settings.budget.clone() }))
    }

    /// Writes them during a run.
    pub fn watch(&mut self, run: impl FnOnce(&mut dyn Probe) -> Done<Run>) -> Done<Run> {
        let mut charts: Vec<Box<dyn Chart + '_>> = vec![];
        let mut paths = vec![];
        if let Some((file, path)) = &mut self.timeline {
            charts.push(Box::new(Timeline::new(BufWriter::new(file), &self.board)));
            paths.push(&*path);
        }
        if let Some((file, path)) = &mut self.waves {
            charts.push(Box::new(Waves::new(BufWriter::new(file), &self.board, &self.budget)));
            paths.push(&*path);
        }
        let mut watcher = Watcher::new(self.board.clone(), charts);
        let run = run(&mut watcher)?;
        if let Some(timing) = &run.timing {
            for (finished, path) in watcher.finish(timing).into_iter().zip(paths) {
                finished.map_err(|error| unwritten(path, error))?;
            }
        }
        Ok(run)
    }

    /// Puts them in their places.
    pub fn publish(self) -> Done {
        for (file, path) in self.timeline.into_iter().chain(self.waves) {
            file.publish().map_err(Failure::file(&path, "be written"))?;
        }
        Ok(())
    }
}

/// Waves are kept until the run is over; what to do where they are too many.
fn unwritten(path: &Path, error: io::Error) -> Failure {
    match OverBudget::within(&error) {
        Some(over) => Failure::Bad(format!("{}: {over}; or show less, with --from-cycle, --to-cycle or --units", path.display())),
        None => Failure::file(path, "be written")(error),
    }
}

fn create(path: PathBuf) -> Done<(PartialFile, PathBuf)> {
    let file = PartialFile::create(&path).map_err(Failure::file(&path, "be written"))?;
    Ok((file, path))
}

/// What is to be shown, by `--units`, `--from-cycle` and `--to-cycle`.
fn cut(mut board: Board, simulation: &SimulationArgs) -> Done<Board> {
    board.from = simulation.from_cycle.unwrap_or(0);
    board.to = simulation.to_cycle.unwrap_or(u64::MAX);
    if board.from >= board.to {
        let (from, to) = (board.from, board.to);
        return Err(Failure::Usage(format!(
            "--from-cycle {from} is not before --to-cycle {to}: the time line would show nothing"
        )));
    }
    if !simulation.units.is_empty()
        && let Err(unknown) = board.show_only(&simulation.units)
    {
        return Err(Failure::Usage(no_unit(unknown, &board)));
    }
    Ok(board)
}

fn no_unit(unknown: &str, board: &Board) -> String {
    let names: Vec<&str> = board.diagram.stages.iter().map(|stage| stage.name.as_str()).collect();
    let hint = nearest(unknown, names.iter().copied()).map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
    format!("--units: no unit of {} is called `{unknown}`{hint} (there are {})", board.machine, names.join(", "))
}
