//! Rounds of the limit and of the machine, and their medians.

mod block;
mod columns;
mod drawing;
mod lanes;
mod raster;
mod search;
mod shade;
mod triangle;

use basrelief_bench::machines;
use basrelief_bench::ratios::{median, prepared};
use basrelief_bench::workload::{PreparedRun, RunSample, WorkloadSize, measured};
use drawing::Drawing;
use pulp::x86::V3;
use raster::Drawer;

const ROUNDS: usize = 7;
/// Runs that are compared with the limit: the name of the output, and the workload.
const OTHERS: [(&str, &str); 3] =
    [("timed", "machine/w1/timed"), ("functional", "machine/w1/functional"), ("resimulated", "machine/w1/retimed")];

/// Runs the rounds and prints the medians.
///
/// # Errors
/// Returns an error on a processor without AVX2, or if the picture of the limit differs from that of the machine.
pub(crate) fn run() -> Result<(), String> {
    let simd = V3::try_new().ok_or("the limit needs AVX2, which this processor does not have")?;
    let drawing = Drawing::w1();
    let (picture, _) = simd.vectorize(Drawer::new(simd, &drawing));
    let differ = picture.iter().zip(&drawing.picture).filter(|(ours, machines)| ours != machines).count();
    if differ > 0 {
        return Err(format!("{differ} of {} pixels differ from the machine's picture", picture.len()));
    }
    let mut runs: Vec<PreparedRun> = vec![Box::new(move || limit(simd, &drawing))];
    let workloads = machines::workloads(WorkloadSize::Full);
    runs.extend(OTHERS.map(|(_, name)| prepared(&workloads, name)));
    let mut times = vec![vec![]; runs.len()];
    for _ in 0..ROUNDS {
        runs.iter_mut().zip(&mut times).for_each(|(run, times)| times.push(run().nanoseconds()));
    }
    let medians = times.into_iter().map(|times| median(times.into_iter()));
    let names = ["limit"].into_iter().chain(OTHERS.map(|(name, _)| name));
    let text: Vec<String> = names.zip(medians).map(|(name, ns)| format!("{name} {ns:.1} ns")).collect();
    println!("{} per fragment", text.join(", "));
    Ok(())
}

fn limit(simd: V3, drawing: &Drawing) -> RunSample {
    let ((_, count), time) = measured(|| simd.vectorize(Drawer::new(simd, drawing)));
    RunSample { time, count }
}
